// The wrong models of tests/bad_models: what the message on each must say, and how to make the same mistake
// in a Scene filled in C++.
#pragma once

#include <concepts>
#include <functional>
#include <string_view>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd::test {

// The same mistake made in a Scene, or why a Scene cannot hold it.
struct Twin {
  std::function<void(Scene&)> spoil;  // applied to the Scene of the sound model
  std::string_view reason;            // when there is none

  template <std::invocable<Scene&> Spoil>
  Twin(Spoil f) : spoil(f) {}
  Twin(std::string_view why) : reason(why) {}
};

// A wrong model: tests/bad_models/FILE.xml. What people must read is said in parts, not in full: the words
// around them are free. A part "a|b" is met by either.
struct BadModel {
  std::string_view file;
  std::string_view base;   // sound model it was made from: good/BASE.xml; empty: none
  std::vector<int> lines;  // the message names one of these
  std::string_view label;  // the item it begins with, "a|b" as above; empty: not told
  std::vector<std::string_view> parts;
  Twin twin;
  std::string_view where = {};  // file that the message names, if it is another
  int edited = 4;               // lines in which the model may differ from its base, at most
};

const std::vector<BadModel>& bad_models();

}  // namespace mbd::test
