// The instructions of an Expression's postfix program.
#pragma once

#include <cstdint>

namespace mbd {

// One instruction of the postfix program. Truth values lie on the stack as the numbers 1 and 0.
enum class Opcode : std::uint8_t {
  constant,  // push value
  time,      // push t
  input,     // push `value` times the input at the place `target`
  sensor,    // push the sensor at the place `target`
  // of two numbers
  add,
  subtract,
  multiply,
  divide,
  power,
  atan2,
  // of one number
  negate,
  power_constant,  // to the exponent `value`
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  exp,
  log,
  log10,
  sqrt,
  // kinks at the time `value`
  negate_before,
  negate_after,
  first_before,  // of two numbers the first before `value`, the second after it
  first_after,
  // conditions
  before,  // push t < value
  after,   // push t > value
  both,
  either,
  opposite,
  less,  // of numbers, where nothing is differentiated
  less_equal,
  equal,
  // control
  jump,
  jump_if_false,  // pops the condition
  // of constants, and where nothing is differentiated
  abs,
  min,
  max,
  floor,
  ceil,
  round,
};

}  // namespace mbd
