// The files that a page is made of, by themselves: what embeds them needs nothing else of pages.
#pragma once

#include <string_view>

namespace mbd {

// What a page is made of. The first three are ours (libmbd/view/page); the program has them all embedded
// (tools/mbd/view_assets.hpp).
struct PageParts {
  std::string_view html;  // with @TITLE@, @STYLE@, … where the others go
  std::string_view style, script;
  std::string_view three, controls;  // three.js and its OrbitControls
  std::string_view licence;          // of three.js
};

}  // namespace mbd
