// Where the argument of a law comes to the other side of a kink.
#pragma once

#include <optional>

#include "libmbd/core/batch.hpp"

namespace mbd {

// The kink that lies between the arguments of one law at two times, of those that are nearest to it then; nothing: none does.
inline std::optional<double> crossed_kink(const NearKink& from, const NearKink& to) {
  for (const double kink : {from.kink.at, to.kink.at})
    if ((from.x < kink) != (to.x < kink)) return kink;
  return std::nullopt;
}

}  // namespace mbd
