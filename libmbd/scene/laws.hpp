// Laws of a scene -> laws of the kernels.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/law.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

enum class LawOf { displacement, rate };  // what it is a function of: x or v

// Throws Error in the name of `who`, about `attribute`: a table with fewer than two points, a variable that does
// not rise, numbers that are not finite; an expression that is not finite at 0 or that jumps; a law of a rate that
// is not 0 at 0 (it would act in equilibria, which know no rates).
void check_law(const LawScene& law, LawOf of, const Source& source, const std::string& who,
               std::string_view attribute);

// Of a law that has been checked.
Law make_law(const LawScene& law);

// The points of a checked table, or the breaks of its spline with the slopes there.
std::vector<Law::Knot> knots_of(const TableScene& table);

// An expression of t with the values of a checked table: cubics or lines, chosen by a search that halves, linear beyond the ends
// with the slope there.
std::string function_text(const TableScene& table);

// factor * law(x / stretch): in other units of the force and of its variable.
LawScene scaled_law(const LawScene& law, double factor, double stretch);

}  // namespace mbd
