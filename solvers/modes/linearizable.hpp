// What has no small motions: states at which forces have no slope, or constraints no constant rank.
#pragma once

#include <span>
#include <string>

#include "libmbd/core/system.hpp"

namespace mbd {

// Why motions near a state are not linear, in words that name what it is and what to do; empty if they are: a law at its kink
// (to 1e-9 of the scene's size or speed) whose argument free motions change to the first order, or constraints that lose rank
// (rank_loss.hpp). The state has rates and satisfies the constraints.
// Not seen: kinks of forces that a program gives (force.hpp).
std::string why_not_linear(const System& system, const State& state);

// Of the laws' kinks alone. Of states of one motion, next to each other: a law that is at its kink in all of them (a motion that
// goes through one at a moment has small motions).
std::string kink_at(const System& system, std::span<const State> states);

// How far kinks are: in which range small motions are linear; empty if no law has any.
std::string range_of_linearity(const System& system, const State& state);

}  // namespace mbd
