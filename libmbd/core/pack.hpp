// Numbers of a few elements, joints or nodes side by side: a scalar type for kernels, which are written once for it, for double
// and for dual numbers. And the registers of the processor that is compiled for, which dense matrices are worked on in.
//
// What a lane holds does not depend on the others: of a function with branches (by_size) each lane gets the branch of its
// own number. So an element gives the same to the last bit wherever it stands among others, and the last of a list, fewer
// than a pack, are filled up by repeating one. A pack is as wide as a register, but no wider than four: with eight, lanes
// are empty in most scenes, and gathering takes longer than the arithmetic saves (3 to 11 % of whole runs).
// Everything here has the width in its name: of objects that are compiled for different processors and go into one program
// (MBD_PORTABLE), what is handed to one of another width would be a name that is not there, when the program is linked.
// Not used: std::experimental::simd, which Eigen cannot hold without an interface as long as this one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "libmbd/core/types.hpp"

namespace mbd {
#if defined(__AVX512F__)
inline namespace lanes_8 {
inline constexpr int lane_count = 8, lane_registers = 24;
#elif defined(__AVX__)
inline namespace lanes_4 {
inline constexpr int lane_count = 4, lane_registers = 12;
#else
inline namespace lanes_2 {
inline constexpr int lane_count = 2, lane_registers = 12;
#endif
// Of a register.
using Lane [[gnu::vector_size(lane_count * sizeof(double))]] = double;
using LaneMask [[gnu::vector_size(lane_count * sizeof(double))]] = long long;

// Of a pack.
inline constexpr int pack_count = std::min(lane_count, 4);
using PackLane [[gnu::vector_size(pack_count * sizeof(double))]] = double;
using PackMask [[gnu::vector_size(pack_count * sizeof(double))]] = long long;

struct Pack {
  PackLane v;

  Pack() = default;
  MBD_INLINE Pack(double x) : v(PackLane{} + x) {}  // NOLINT: constants are the same in all lanes
  MBD_INLINE explicit Pack(const PackLane& x) : v(x) {}

  MBD_INLINE double operator[](int k) const { return v[k]; }
  MBD_INLINE void set(int k, double x) { v[k] = x; }

  MBD_INLINE Pack& operator+=(const Pack& o) {
    v += o.v;
    return *this;
  }
  MBD_INLINE Pack& operator-=(const Pack& o) {
    v -= o.v;
    return *this;
  }
  MBD_INLINE Pack& operator*=(const Pack& o) {
    v *= o.v;
    return *this;
  }
  MBD_INLINE Pack& operator/=(const Pack& o) {
    v /= o.v;
    return *this;
  }
};
MBD_INLINE Pack operator-(const Pack& a) { return Pack(-a.v); }
MBD_INLINE Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
MBD_INLINE Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
MBD_INLINE Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
MBD_INLINE Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }

template <class S>
inline constexpr bool is_pack = false;
template <>
inline constexpr bool is_pack<Pack> = true;

// The sign of x with sign(0) = 1, and the smaller of two, as numbers: without branches.
template <class S>
MBD_INLINE S sign_of(const S& x) {
  return x < S(0) ? S(-1) : S(1);
}
template <>
MBD_INLINE Pack sign_of(const Pack& x) {
  return Pack(x.v < PackLane{} ? PackLane{} - 1.0 : PackLane{} + 1.0);
}
template <class S>
MBD_INLINE S smaller_of(const S& a, const S& b) {
  return b < a ? b : a;
}
template <>
MBD_INLINE Pack smaller_of(const Pack& a, const Pack& b) {
  return Pack(b.v < a.v ? b.v : a.v);
}
// The smallest number of all lanes; NaN if any is.
MBD_INLINE double smallest_of(const Pack& x) {
  double smallest = x[0];
  for (int k = 1; k < pack_count; ++k) smallest = !(smallest <= x[k]) ? x[k] : smallest;
  return smallest;
}
MBD_INLINE double smallest_of(double x) { return x; }

// Some functions of x, by ranges of x: f(x) below f_end, g(x) from there below g_end (nowhere if that is no larger), and
// h(x, more) from there on, which is asked for single lanes.
template <std::size_t n, class S, class F, class G, class H, class... More>
MBD_INLINE std::array<S, n> by_size(const S& x, double f_end, const F& f, double g_end, const G& g,
                                    const H& h, const More&... more) {
  if constexpr (is_pack<S>) {
    const auto put = [](const PackMask& where, const std::array<S, n>& from, std::array<S, n>& to) {
      for (std::size_t i = 0; i < n; ++i) to[i].v = where ? from[i].v : to[i].v;
    };
    const auto any = [](const PackMask& mask) {
      long long all = 0;
      for (int k = 0; k < pack_count; ++k) all |= mask[k];
      return all != 0;
    };
    std::array<S, n> result = f(x);
    const PackMask beyond_f = ~(x.v < PackLane{} + f_end);
    if (__builtin_expect(!any(beyond_f), 1)) return result;
    if (g_end > f_end) put(beyond_f, g(x), result);
    const PackMask beyond = beyond_f & ~(x.v < PackLane{} + g_end);
    if (!any(beyond)) return result;
    for (int k = 0; k < pack_count; ++k) {
      if (beyond[k] == 0) continue;
      const std::array<double, n> one = h(x[k], more[k]...);
      for (std::size_t i = 0; i < n; ++i) result[i].set(k, one[i]);
    }
    return result;
  } else {
    if (x < S(f_end)) return f(x);
    if (x < S(g_end)) return g(x);
    return h(x, more...);
  }
}

// --- lists of `count` things, a pack at a time ---

// Which things of a list lanes hold: those from `first`, the last one again and again behind the end.
struct PackOf {
  std::size_t first, end;
  std::size_t operator[](int k) const {
    const std::size_t i = first + static_cast<std::size_t>(k);
    return i < end ? i : end - 1;
  }
  int count() const {
    const std::size_t left = end - first;
    return left < pack_count ? static_cast<int>(left) : pack_count;
  }
};

// Calls f for all packs of the things from `begin` to `end`.
template <class F>
MBD_INLINE void each_pack(std::size_t begin, std::size_t end, const F& f) {
  for (std::size_t i = begin; i < end; i += pack_count) f(PackOf{i, end});
}

// of(k): the number of lane k.
template <class Of>
MBD_INLINE Pack pack_of(const Of& of) {
#if defined(__AVX__)
  return Pack(PackLane{of(0), of(1), of(2), of(3)});
#else
  return Pack(PackLane{of(0), of(1)});
#endif
}
// of(k): a pointer to the numbers of lane k, as many as the matrix or array m has.
template <class M, class Of>
MBD_INLINE void pack_into(M& m, const Of& of) {
  const auto size = static_cast<std::ptrdiff_t>(m.size());
  for (std::ptrdiff_t i = 0; i < size; ++i) m.data()[i] = pack_of([&](int k) { return of(k)[i]; });
}

}  // namespace lanes_*
}  // namespace mbd

template <>
struct Eigen::NumTraits<mbd::Pack> : Eigen::NumTraits<double> {
  using Real = mbd::Pack;
  using NonInteger = mbd::Pack;
  using Nested = mbd::Pack;
  using Literal = mbd::Pack;
};
