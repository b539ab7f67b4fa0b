// An expression of the place along a beam, s, and of time t: `q0*(1-s)*sin(2*pi*t)`; and sums of such.
//
// At a given place s is a number like any parameter, so the expression becomes an Expression of time there:
// conditions and kinks in s are settled place by place, and only those in t make breakpoints.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/expression.hpp"

namespace mbd {

class FieldExpression {
 public:
  FieldExpression() = default;  // of no text, which is no expression
  // `factor` times the text. `parameters` are those of the model; `s` stands for the place and cannot be one of them.
  FieldExpression(std::string text, Parameters parameters, double factor = 1.0);

  // sum_k factor_k f_k(s, t / stretch): fields in other axes, or in other units of what they give and of time.
  struct Term {
    double factor;
    const FieldExpression* of;
  };
  static FieldExpression sum(std::span<const Term> terms, double stretch = 1.0);

  // At s, a fraction of the reference length of the beam [-]. Throws Error as Expression::parse and Expression::sum do, and
  // if a parameter named s makes the text ambiguous.
  Expression at(double s) const;

  // Whether it mentions s.
  bool varies() const;

  // The field along the beam at an instant.
  class Profile {
   public:
    double operator()(double s) const;
    // Places between 0 and 1, rising, between which nothing of it hides (law_cells.hpp).
    const std::vector<double>& ends() const { return ends_; }

   private:
    friend FieldExpression;
    struct Part {
      Expression of_place;
      double factor, from, to;
    };
    std::vector<Part> parts_;
    std::vector<double> ends_;
  };
  // Of a field of place and time alone whose conditions are affine in s; nothing otherwise (sensors, inputs, functions of time).
  std::optional<Profile> profile(double t) const;

  // For messages and drawings: how it is made. Factors and texts; not places and times, if they are another's.
  std::string text() const;

  // The same field with the place as a fraction of the part between two fractions of the beam.
  FieldExpression on_part(double from, double to) const;

 private:
  // factor text(from + (to - from) s, t / stretch)
  struct Part {
    std::string text;
    std::shared_ptr<const Parameters> parameters;
    double factor = 1.0, stretch = 1.0, from = 0.0, to = 1.0;

    bool varies() const;
    Expression at(double s) const;
  };
  std::vector<Part> parts_;
};

}  // namespace mbd
