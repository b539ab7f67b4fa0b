// Models written in tests as strings: what they say, or why they are refused.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/check_scene.hpp"
#include "libmbd/language/reader.hpp"

namespace mbd::test {

// The contents of a model, which begin on line 2 of "test.xml".
inline Scene read(const std::string& inside, const Overrides& overrides = {}) {
  return read_model_text("<mbd name=\"test\">\n" + inside + "\n</mbd>\n", "test.xml", overrides);
}

// Why it is refused, or "no error".
inline std::string refusal(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// What is said of it by the reader and by the check of the scene, or "no error".
inline std::string message(const std::string& inside, const Overrides& overrides = {}) {
  return refusal([&] { check_scene(read(inside, overrides)); });
}

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

}  // namespace mbd::test
