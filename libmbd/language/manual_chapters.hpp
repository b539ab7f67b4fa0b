// What the manual says beyond the schema: how numbers, units, names and files work, and an example for each
// group of elements. What a single element is stands with its item in libmbd/scene, or in schema.cpp.
#pragma once

#include <span>
#include <string_view>

namespace mbd::manual {

// A word that expressions know.
struct Word {
  std::string_view name;
  std::string_view arguments;  // as one writes them: "x", "y, x"; empty for a constant
  std::string_view doc;
};
std::span<const Word> functions();
std::span<const Word> constants();

// A chapter before the elements; the list of words stands at the end of that with `words`.
struct Chapter {
  std::string_view title;
  std::string_view text;  // Markdown
  bool words = false;
};
std::string_view opening();
std::span<const Chapter> chapters();

// Elements that are described together. Each element of the schema is in one group; joints are not listed
// but known by their kind, nor are items that say their group themselves.
struct Group {
  std::string_view title;
  std::string_view elements;  // separated by blanks; empty: the joints
  std::string_view text;      // Markdown
  std::string_view example;   // a whole model
};
std::span<const Group> groups();

}  // namespace mbd::manual
