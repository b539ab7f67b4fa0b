// An expression of the place along a beam, s, and of time t: `q0*(1-s)*sin(2*pi*t)`.
//
// At a given place s is a number like any parameter, so the expression becomes an Expression of time there:
// conditions and kinks in s are settled place by place, and only those in t make breakpoints.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "libmbd/core/expression.hpp"

namespace mbd {

struct FieldExpression {
  std::string text;
  Parameters parameters;  // of the model; `s` stands for the place and cannot be one of them

  // At s, a fraction of the reference length of the beam [-]. Throws Error as Expression::parse does, and
  // if a parameter named s makes the text ambiguous.
  Expression at(double s) const;

  // Whether the text mentions s.
  bool varies() const;

  // The same field with the place as a fraction of the part between two fractions of the beam.
  FieldExpression on_part(double from, double to) const;

  // The text with word(name) in place of each of its names and numbers; of a number with a signed exponent, 1e-3, the
  // two words 1e and 3.
  std::string reworded(const std::function<std::string(std::string_view)>& word) const;
};

}  // namespace mbd
