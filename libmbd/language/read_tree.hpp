// From a tree of elements that a program has built to a Scene, as reader.hpp does from a file.
#pragma once

#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/language/xml.hpp"

namespace mbd {

// `file` is what messages call it, with the lines that the tree gives elements and attributes. Throws Error as read_model().
Scene read_model_tree(const xml::Element& root, const std::string& file,
                      const Overrides& overrides = {});

}  // namespace mbd
