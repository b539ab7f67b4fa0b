// Errors a user can mend: thrown before the first step, never from inside one (numbers
// that go wrong inside a step are returned in a report).
#pragma once

#include <stdexcept>
#include <string>

#include "libmbd/core/choices.hpp"

namespace mbd {

// Where a thing was said: the file and line of a model, or an empty file for one built in C++.
struct Source {
  std::string file;
  int line = 0;
};

// What is wrong, where, and what to do about it.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, Failure kind = Failure::request)
      : std::runtime_error(message), kind_(kind) {}
  Error(const Source& source, const std::string& message, Failure kind = Failure::model)
      : std::runtime_error(place(source) + message), kind_(kind) {}

  Failure kind() const noexcept { return kind_; }

 private:
  Failure kind_;
  static std::string place(const Source& source) {
    if (source.file.empty()) return {};
    return source.line > 0 ? source.file + ":" + std::to_string(source.line) + ": "
                           : source.file + ": ";
  }
};

}  // namespace mbd
