// Units that a model may write after its numbers: `12 mm`, `5 deg`, `3 kN`, `60 rpm`. Names, prefixes and
// products are those of UDUNITS-2 ("N.m2", "kg/m", "lbf", "inch"), but an angle is a quantity of its own,
// in rad: `deg`, `rev`, `rpm`, `arcmin` are angles or rates of turning, and `50 Hz` is not 50 rad/s.
#pragma once

#include <string>
#include <string_view>

#include "libmbd/scene/field.hpp"

namespace mbd {

// What the unit of an attribute may be besides an SI unit: a pure number, or any unit at all.
using field::any_unit;
using field::pure_number;

// What a number in `unit` must be multiplied by to be in `wanted`, an SI unit such as "N.m2", or any_unit.
// Throws Error (without source) for names that are not known, units of another quantity, units with a zero
// of their own (celsius), and if the data of UDUNITS-2 are not found. Thread-safe.
double unit_factor(std::string_view unit, std::string_view wanted);

// A number's text and its unit: the last word, if it reads like one and does not belong to the expression
// ("2*L mm": "2*L", "mm"), or what follows a literal number at once ("12mm": "12", "mm"). The unit is empty
// if there is none.
struct NumberAndUnit {
  std::string_view number, unit;
};
NumberAndUnit split_unit(std::string_view text);

// Whether a word may be a unit by its letters: "mm", "N.m2", "kg/m^3", "°", "%".
bool reads_like_unit(std::string_view word);

}  // namespace mbd
