// The free coordinate x of a joint, or its rate, as a sensor (frames and symbols of coordinate.hpp and two_frames.hpp):
//   x:     dx = w.zeta = (B^T w).dU                                                                       (1)
//   xdot:  at fixed V  dxdot = (H^T z - y~^T w).zeta,   by V  B^T w                                        (2)
#pragma once

#include <array>
#include <vector>

#include "joints/coordinate.hpp"
#include "libmbd/core/system.hpp"

namespace mbd::joint {

template <class Coordinate>
class CoordinateSensor final : public Sensor {
 public:
  CoordinateSensor(const Axis& axis, int P, int Q, bool rate)
      : axis_(axis), nodes_{P, Q}, rate_(rate) {}

  double value(const State& state) const override {
    const auto x = states(state);
    const two_frames::Frames<double> frames(axis_.ends, x.data());
    if (rate_) return Coordinate::gradient(frames.g).dot(frames.twist(x.data()));
    const double near = axis_.angle < 0 ? 0.0 : state.angles[static_cast<std::size_t>(axis_.angle)];
    return Coordinate::value(frames.g, near);
  }

  std::vector<int> nodes() const override {
    std::vector<int> all;
    for (const int node : nodes_)
      if (node != 0) all.push_back(node);
    return all;
  }

  void derive(const State& state, std::span<Vec6> by_motion,
              std::span<Vec6> by_velocity) const override {
    const auto x = states(state);
    const two_frames::Frames<double> frames(axis_.ends, x.data());
    const Vec6 w = Coordinate::gradient(frames.g);
    Vec6 by_increment = w;
    if (rate_) {
      const Mat6 H = Coordinate::curvature(frames.g);
      const Vec6 z = frames.twist(x.data()), y = frames.twist_of_a(x.data());
      by_increment = H.transpose() * z - twist_hat<double>(y).transpose() * w;
    }
    std::size_t i = 0;
    for (Index end = 0; end < 2; ++end) {
      if (nodes_[static_cast<std::size_t>(end)] == 0) continue;
      const auto B = frames.B.block<6, 6>(0, 6 * end);
      by_motion[i] = B.transpose() * by_increment;
      by_velocity[i] = rate_ ? Vec6(B.transpose() * w) : Vec6(Vec6::Zero());
      ++i;
    }
  }

 private:
  std::array<NodeState<double>, 2> states(const State& state) const {
    std::array<NodeState<double>, 2> x;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto n = static_cast<std::size_t>(nodes_[i]);
      x[i].H = state.pose[n];
      x[i].V = state.V.empty() ? Vec6(Vec6::Zero()) : state.V[n];
    }
    return x;
  }

  Axis axis_;
  std::array<int, 2> nodes_;
  bool rate_;
};

}  // namespace mbd::joint
