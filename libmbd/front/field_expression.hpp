// An expression of the place along a beam, s, and of time t: `q0*(1-s)*sin(2*pi*t)`.
//
// At a given place s is a number like any parameter, so the expression becomes an Expression of time there:
// conditions and kinks in s are settled place by place, and only those in t make breakpoints.
#pragma once

#include <string>

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
};

}  // namespace mbd
