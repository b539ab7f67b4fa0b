// A page as a template that words and data are put into: what is said twice elsewhere is said here once.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace mbd {

// JSON as it may stand inside of <script>: nothing in it ends the element or begins a comment.
std::string in_script(std::string_view json);

// `html` with each word, as "@TITLE@", replaced by what belongs to it; words within that stay as they are.
std::string filled(std::string_view html,
                   std::span<const std::pair<std::string_view, std::string_view>> words);

}  // namespace mbd
