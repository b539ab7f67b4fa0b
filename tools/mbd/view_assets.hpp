// What pages are made of, embedded in the program when it is built (tools/cmake/view_assets.cpp.in).
#pragma once

#include "libmbd/view/page_parts.hpp"

namespace mbd {

// Empty in a program that was built without three.js.
PageParts view_assets();

}  // namespace mbd
