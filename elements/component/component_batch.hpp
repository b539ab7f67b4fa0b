// Components (component.hpp) in the equations, and what is where within them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "elements/component/component.hpp"
#include "elements/node/base_motion.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

class ComponentBatch final : public Batch {
 public:
  static constexpr std::string_view name = "component modes";

  // `gravity`: inertial [m/s2]. What else accelerates all is the base; its signals are the system's.
  ComponentBatch(const Vec3& gravity, const BaseMotion::Shared& base)
      : gravity_(gravity), base_(base) {}

  // Its nodes as in State, none of them the ground; the first is that of the floating frame. `who` is for messages. Returns its
  // index.
  Index add(component::Data data, std::vector<int> nodes, std::string who);

  const std::string& name_of(Index component) const {
    return parts_[static_cast<std::size_t>(component)].who;
  }
  // The largest rotation of one of its nodes against the frame [rad].
  double largest_turn(const State& state, Index component) const;
  // Its geometric stiffness over its elastic one, at a motion: the least and the largest ratio of all deformations, its frame
  // held. Below -1 it is unstable; 0, 0 of one without forces, or of one node.
  std::array<double, 2> geometric_shares(const State& state, Index component) const;
  // About how wrong it is at a motion.
  struct Wrong {
    double error = 0.0;              // relative to deflections; 1: not known
    double turn = 0.0, share = 0.0;  // largest_turn(); of geometric_shares() the one that counts
  };
  Wrong wrong_by(const State& state, Index component) const;

  // Motions of frames within: the k-th has the reference pose in[k] in node 0, and there the deformation T_k u, T_k the
  // k-th six rows of `shapes`. Poses, and with `rates` velocities and accelerations, body axes: exact derivatives of the poses.
  std::vector<NodeState<double>> within(const State& state, Index component,
                                        std::span<const Pose<double>> in,
                                        const Eigen::MatrixXd& shapes, bool rates) const;

  std::string_view type() const override { return name; }
  bool is_structure() const override { return true; }
  Index size() const override { return static_cast<Index>(parts_.size()); }
  std::size_t bytes() const override;
  void connect(BlockGraph& graph) override;
  bool residual(const State& state, VecX& r) const override;
  bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                 std::span<const Slot> slots) const override;
  void add_rate_tangent(const State& state, const TangentWeights& weights,
                        std::span<const Slot> slots) const override;
  bool linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                        const std::array<std::span<const Slot>, 3>& P) const override;
  void load_rate(const State& state, VecX& r) const override;
  std::string out_of_range(const State& state) const override;
  Energies energies(const State& state) const override;
  double load_power(const State& state) const override;
  double damping_power(const State& state) const override;

 private:
  struct Part {
    component::Data data;
    std::vector<int> nodes;
    std::string who;
    std::size_t first_slot = 0;
  };
  Vec3 acceleration(const State& state) const;
  // Adds the residuals; calls take(part, K, D_V) with the tangents of each, but of Want::residual.
  template <Want want, class Take>
  bool run(const State& state, VecX& r, const Take& take) const;

  Vec3 gravity_;
  BaseMotion::Shared base_;
  std::vector<Part> parts_;
};

// Their inertia, by itself as that of nodes is: what acts on the parts of a system is all the other batches.
class ComponentInertia final : public Batch {
 public:
  static constexpr std::string_view name = "inertia of component modes";

  // M of (5), and its nodes as in State, none of them the ground.
  void add(Eigen::MatrixXd M, std::vector<int> nodes);

  std::string_view type() const override { return name; }
  Index size() const override { return static_cast<Index>(parts_.size()); }
  std::size_t bytes() const override;
  void connect(BlockGraph& graph) override;
  bool residual(const State& state, VecX& r) const override;
  bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                 std::span<const Slot> slots) const override;
  void add_rate_tangent(const State& state, const TangentWeights& weights,
                        std::span<const Slot> slots) const override;
  bool linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                        const std::array<std::span<const Slot>, 3>& P) const override;
  Energies energies(const State& state) const override;
  void add_momenta(const State& state, std::span<Vec6> p) const override;

 private:
  struct Part {
    Eigen::MatrixXd M;
    std::vector<int> nodes;
    std::size_t first_slot = 0;
  };
  // Adds the residuals; calls take(part, D_V) with the tangents of each, but of Want::residual.
  template <Want want, class Take>
  void run(const State& state, VecX& r, const Take& take) const;

  std::vector<Part> parts_;
};

}  // namespace mbd
