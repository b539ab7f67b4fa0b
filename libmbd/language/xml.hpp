// An XML file as a tree of elements: all that the reader sees of XML.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/error.hpp"

namespace mbd::xml {

struct Attribute {
  std::string name, value;
  int line = 0;
};

struct Element {
  std::string name;
  int line = 0;
  std::vector<Attribute> attributes;  // names are distinct
  std::vector<Element> children;
  std::string text;   // its own, without that of its children
  int text_line = 0;  // of the first text that is not blank; 0: there is none
};

// The one root element. `file` is what messages call the text. Throws Error with file and line for what
// is not well-formed, and for what models have no use for: a second root, <!…> and <?…> inside the root,
// a document type (entities), zero bytes.
Element parse(std::string_view text, const std::string& file);

// The same of a file of at most 64 MB.
Element parse_file(const std::filesystem::path& file);

}  // namespace mbd::xml
