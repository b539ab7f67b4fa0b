// The variables of a stepper as bytes: what a class writes by archive(…) it reads again by the same call. Numbers are kept to
// the last bit, in the order of bytes of this machine.
#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/core/state.hpp"

namespace mbd {

class Archive {
 public:
  Archive() = default;  // to write
  explicit Archive(std::span<const char> from) : from_(from), reads_(true) {}

  bool reads() const { return reads_; }
  bool at_end() const { return at_ == from_.size(); }
  std::vector<char> take() { return std::move(bytes_); }

  // Throws Error where the bytes end before.
  template <class... T>
  void operator()(T&... values) {
    (item(values), ...);
  }

 private:
  void raw(void* data, std::size_t size) {
    if (!reads_) {
      const char* const first = static_cast<const char*>(data);
      bytes_.insert(bytes_.end(), first, first + size);
      return;
    }
    if (size > from_.size() - at_) throw Error("the checkpoint is cut off");
    if (size > 0) std::memcpy(data, from_.data() + at_, size);
    at_ += size;
  }
  // Of something with elements; never more of them than there are bytes.
  std::size_t length(std::size_t n, std::size_t of_each) {
    item(n);
    if (reads_ && n > (from_.size() - at_) / of_each) throw Error("the checkpoint is cut off");
    return n;
  }

  template <class T>
  void item(T& value) {
    if constexpr (requires { value.archive(*this); }) {
      value.archive(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      raw(&value, sizeof(T));
    }
  }
  template <class T>
  void item(std::vector<T>& all) {
    all.resize(length(all.size(), sizeof(T)));
    if constexpr (std::is_trivially_copyable_v<T>)
      raw(all.data(), all.size() * sizeof(T));
    else
      for (T& each : all) item(each);
  }
  template <class T, std::size_t n>
  void item(std::array<T, n>& all) {
    for (T& each : all) item(each);
  }
  void item(std::string& text) {
    text.resize(length(text.size(), 1));
    raw(text.data(), text.size());
  }
  template <class T>
  void item(std::optional<T>& value) {
    bool is = value.has_value();
    item(is);
    if (reads_) value = is ? std::optional<T>(T{}) : std::nullopt;
    if (is) item(*value);
  }
  // Eigen's, of any fixed size: numbers one after the other; and vectors of numbers.
  template <class S, int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
  void item(Eigen::Matrix<S, Rows, Columns, Options, MaxRows, MaxColumns>& m) {
    if constexpr (Rows == Eigen::Dynamic || Columns == Eigen::Dynamic) {
      static_assert(Columns == 1);
      m.resize(static_cast<Index>(length(static_cast<std::size_t>(m.size()), sizeof(S))));
    }
    raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(S));
  }
  void item(Pose<double>& H) { (*this)(H.p.coeffs(), H.r); }
  void item(State& s) {
    (*this)(s.t, s.side, s.load_factor, s.pose, s.V, s.Vdot, s.lambda, s.idle, s.signals, s.inputs,
            s.control, s.work, s.momentum_rate, s.angles);
  }

  std::vector<char> bytes_;
  std::span<const char> from_;
  std::size_t at_ = 0;
  bool reads_ = false;
};

}  // namespace mbd
