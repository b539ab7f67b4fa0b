// Arithmetic expressions of a model file: `5*deg`, `t<6 ? 0.3*(1-cos(pi*t/6)) : 0.6`.
//
// Grammar, loosest binding first:
//
//   choice      = condition '?' choice ':' choice | disjunction       right associative
//   disjunction = conjunction { '||' conjunction }
//   conjunction = negation { '&&' negation }
//   negation    = '!' negation | comparison                           so !t<1 is !(t<1)
//   comparison  = sum [ ('<' '<=' '>' '>=' '==' '!=') sum ]           one, not a chain
//   sum         = product { ('+' '-') product }
//   product     = sign { ('*' '/') sign }
//   sign        = ('-' '+') sign | power                              so -2^2 is -(2^2)
//   power       = primary [ '^' sign ]                                right associative
//   primary     = number | name | function '(' choice {',' choice} ')' | '(' choice ')'
//
// Names: the parameters given; the constants pi and deg (= pi/180: 5*deg is an angle in rad);
// the variable t (time, s) where the caller allows it, and there the inputs of the model (input.hpp), or in its place x or v (law.hpp), for which all that
// is said of t here holds as well; sensors of the motion where t is, `elbow.angle`, `arm.end.velocity.2`, which are names with a
// point or an @ in them, and mean what the caller makes of them; functions of time of the model, f(a*t+b). Functions: sin cos tan asin acos atan
// atan2(y,x) sinh cosh tanh exp log ln (both natural) log10 sqrt pow(x,p) abs min(x,y) max(x,y),
// and, of constants only, floor ceil round. Numbers and conditions are different types.
//
// Derivatives. The value comes with its exact first and second time derivative (taylor.hpp). They
// exist between the switching times of the conditions, the *breakpoints*; at a breakpoint they are
// one-sided limits, and the caller says which side. A condition in t therefore compares terms
// affine in t, a t + b, so that its switching time is known; < and <= (> and >=) mean the same, and
// == and != in t, true at an instant only, are refused. The same holds for the kinks of abs, min
// and max: their arguments must be constant or affine in t, and without inputs. Other functions are taken to be smooth:
// the cut of atan2 and kinks such as that of sqrt(sin(t)^2) are not detected.
//
// Not used: comparisons of general functions of t with root finding (a root can be missed, and its
// position depends on a tolerance); truth values as 0 and 1 (t*(t<1) hides a jump from the reader).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/input.hpp"
#include "libmbd/core/taylor.hpp"

namespace mbd {

// An input of a model, as expressions of time know it: its place among State::inputs, and what makes SI of its values.
struct NamedInput {
  int index = 0;
  double factor = 1.0;
};

class Parameters;

// A function of time that expressions of time call by its name: `factor` times an expression of t, read with the parameters that
// there were where it stands.
struct NamedFunction {
  std::shared_ptr<const std::string> text;
  std::shared_ptr<const Parameters> parameters;
  double factor = 1.0;
};

// Named constants of a model, its inputs and its functions of time.
class Parameters : public std::map<std::string, double, std::less<>> {
 public:
  using map::map;
  std::map<std::string, NamedInput, std::less<>> inputs;
  std::map<std::string, NamedFunction, std::less<>> functions;
  std::set<std::string, std::less<>>
      own;  // names without a point that are read as sensors are: states of a controller
};

// What an expression may depend on besides parameters: t, or in laws (law.hpp) a displacement x or a rate v.
// `sampled`: t and all that depends on time, at an instant: nothing is differentiated, so conditions may compare anything, and
// abs, min, max, floor, ceil and round may be of anything. `place`: s along a beam at an instant, which is the parameter t.
enum class Variables { none, time, x, v, sampled, place };

// The limit taken at a breakpoint: from earlier or from later times.
enum class Side { left, right };

enum class Opcode : std::uint8_t;  // opcode.hpp

// The numbers from `lo` to `hi`, infinities included.
struct Interval {
  double lo = 0.0, hi = 0.0;
};

// An expression, checked and compiled to a postfix program. Immutable; evaluation is const, thread
// safe and allocates nothing.
class Expression {
 public:
  // Compiles `text`. Constant parts are folded; a branch that a constant condition excludes is
  // checked for grammar and names only, so `k>0 ? 1/k : 0` is valid for k = 0.
  //
  // Throws Error (without source; the caller adds it) naming the text, the column (in characters,
  // from 1), what was found, what was expected and the remedy: for bad grammar, unknown names, a
  // condition where a number is needed or the reverse, conditions whose switching times are not
  // known, t where it is not allowed, a constant part that is not finite (1/0, sqrt(-1)), more than
  // 200 levels of nesting, 100 000 bytes, or 10 000 calls of functions of the model, those within functions counted.
  //
  // Switching times within 4 rounding units of each other (0.3 and 0.1+0.2) are one breakpoint.
  static Expression parse(std::string_view text, const Parameters& parameters, Variables allowed);

  // sum_k factor_k e_k(t / stretch): laws in other axes, or in other units of what they give and of time.
  // Breakpoints move with the time; the text says how it was made and cannot be parsed. Throws Error for a
  // stretch that is not positive, and if the sum nests too deeply.
  struct Term {
    double factor;
    const Expression* of;
  };
  static Expression sum(std::span<const Term> terms, double stretch = 1.0);

  // The same where the k-th sensor reads sensors (1 + 0.37 k), and the k-th input is inputs (0.77 + 0.29 k): of time alone.
  // What a law does in time whose sensors are not known; they differ, so that what depends on a difference is seen.
  Expression held_at(double sensors, double inputs) const;

  // The same of its k-th sensor alone, the others reading `sensors`, at t; nothing where it has inputs or switches in time.
  std::optional<Expression> of_sensor(std::size_t k, std::span<const double> sensors,
                                      double t) const;

  // Whether `name` is t, a constant or a function, and so cannot name a parameter. (x and v can, but not where
  // they are the variable of a law.)
  static bool is_reserved(std::string_view name);

  bool is_constant() const;
  bool has_inputs() const;  // it depends on inputs of the model
  bool has_sensors() const { return !sensors_.empty(); }

  // The names of the sensors that it depends on, each once.
  const std::vector<std::string>& sensors() const { return sensors_; }

  // The value of a constant expression, always finite. Throws Error if it depends on t.
  double value() const;

  // Value and time derivatives at t [s]. At a breakpoint, the limit from `side`. Outside the domain
  // of a function (sqrt(t) at t < 0) or at a pole the result is not finite and returned as it is; so is that of
  // inputs and sensors that are not given. `inputs`: those of the model, in its order; `sensors`: the values of sensors(), taken
  // as constant by the derivatives.
  Taylor2 operator()(double t, Side side = Side::right, std::span<const InputValue> inputs = {},
                     std::span<const double> sensors = {}) const {
    return evaluate(t, side, inputs, sensors);
  }

  // The same for S = double and long double.
  template <class S>
  Taylor<S> evaluate(S t, Side side = Side::right, std::span<const InputValue> inputs = {},
                     std::span<const double> sensors = {}) const;

  // The derivative by the sensor of that place in sensors(), at fixed time and inputs.
  double derivative(std::size_t sensor, double t, Side side, std::span<const InputValue> inputs,
                    std::span<const double> sensors) const;

  // Taylor coefficients at all t in [a, b]: c[k] holds f^(k)(t)/k! [1/s^k], round-off included; infinite where a
  // pole, or the end of a domain, cannot be excluded. No breakpoint may lie between a and b; at one that is a or b,
  // the limit from inside; of inputs, nothing is known. At most most_coefficients of them. The recurrences of Griewank and Walther (2008, 13.2),
  // on intervals (Moore 1966).
  static constexpr std::size_t most_coefficients = 9;
  void enclose(double a, double b, std::span<Interval> c) const;

  // Times at which a condition or a kink switches [s], ascending. What can be reached only where
  // another condition excludes it may be listed too.
  std::span<const double> breakpoints() const { return breakpoints_; }

  const std::string& text() const { return text_; }

  // Of the compiled program, with the values of parameters: equal for expressions that do the same in the same way.
  std::uint64_t signature() const;

  static constexpr std::size_t most_pending =
      256;  // numbers of an evaluation: 6 KiB on the machine's stack

 private:
  class Parser;

  struct Instruction {
    Opcode op;
    std::int32_t target;  // where a jump goes; for constants, used by the parser
    double value;         // constant, exponent or switching time
  };

  Expression() = default;

  // With the derivatives of the time, and of one sensor.
  struct Seed {
    double time = 1.0;
    std::size_t sensor = static_cast<std::size_t>(-1);
  };
  template <class S>
  Taylor<S> run(S t, Side side, std::span<const InputValue> inputs, std::span<const double> sensors,
                const Seed& seed) const;

  std::string text_;                  // as given
  std::vector<Instruction> program_;  // postfix, with forward jumps
  std::vector<double> breakpoints_;   // [s], ascending, distinct
  std::vector<std::string> sensors_;  // by the targets of instructions
};

extern template Taylor<double> Expression::evaluate(double, Side, std::span<const InputValue>,
                                                    std::span<const double>) const;
extern template Taylor<long double> Expression::evaluate(long double, Side,
                                                         std::span<const InputValue>,
                                                         std::span<const double>) const;

}  // namespace mbd
