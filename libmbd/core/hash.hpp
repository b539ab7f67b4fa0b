// FNV-1a (Fowler, Noll, Vo), 64 bits: by which what was changed or damaged is known, no guard against what was made to deceive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace mbd {

class Hash {
 public:
  void add(const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      value_ = (value_ ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ULL;
  }
  // Texts and rows with their lengths, so that what follows one is not taken for its end.
  void add(std::string_view text) {
    add(text.size());
    add(text.data(), text.size());
  }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T x) { add(&x, sizeof x); }
  void add(std::span<const double> row) {
    add(row.size());
    add(row.data(), row.size_bytes());
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ULL;
};

}  // namespace mbd
