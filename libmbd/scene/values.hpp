// What fields of a scene hold besides numbers and words.
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/expression.hpp"
#include "libmbd/core/types.hpp"
#include "libmbd/scene/field_expression.hpp"

namespace mbd {

// A place things attach to: "ground", a body's reference frame ("top"), or a parameter of a beam
// ("bar2.start", "bar2.end", "bar2@0.5"; 0 at the start, 1 at the end of the reference line).
struct Place {
  enum class Kind { ground, body, beam };
  Kind kind = Kind::ground;
  std::string name;        // of the body or beam; empty for ground
  double parameter = 0.0;  // beam only, in [0, 1]
};

using LawVector = std::array<Expression, 3>;         // of t
using FieldVector = std::array<FieldExpression, 3>;  // of s and t

// A force or moment as a function of one variable (law.hpp): an expression, or a table.
struct TableScene {
  Source source;
  std::vector<std::array<double, 2>>
      points;  // variable and force; the variable rising; two at least
  // Straight lines, or the interpolating spline of degree 3 (or less, with fewer than 4 points). Beyond the
  // ends: linear, with the slope there.
  Interpolation interpolation = Interpolation::linear;
};
using LawScene = std::variant<Expression, TableScene>;

}  // namespace mbd
