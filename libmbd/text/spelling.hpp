// Words a user mistyped: the nearest one that exists, and the list of those that do.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mbd {

// The known word nearest to `word` (at most a third of its letters wrong), or "" when none is near.
std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

// "a, b, c", or "a, b, …, and 17 more".
std::string list(std::span<const std::string_view> words);

// `; did you mean "beam"? The elements here are: arc, beam, body`, with what = "elements here".
std::string suggest(std::string_view word, std::span<const std::string_view> known,
                    std::string_view what);

}  // namespace mbd
