// A force of a program (elements/node/force.hpp) in the equations. With f_a on place a of frame F_a in its node, and
// A_a = Ad(F_a^-1), which takes increments and velocities of the node to those of the place:
//   r_a = -l A_a^T f_a,   dr_a/dU_b = -l A_a^T (df_a/du_b) A_b,   dr_a/dV_b = -l A_a^T (df_a/dv_b) A_b,   l the load factor.
#pragma once

#include <memory>

#include "elements/node/force.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

class ForceBatch final : public Batch {
 public:
  struct At {
    int node;
    Pose<double> frame;  // of the place, in the node
  };
  // `length` [m]: of the scene, for differences.
  ForceBatch(std::shared_ptr<const Force> force, std::vector<At> places, double length);

  std::string_view type() const override { return type_; }
  Index size() const override { return static_cast<Index>(places_.size()); }
  std::size_t bytes() const override { return sizeof(*this) + places_.size() * sizeof(Place); }
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

 private:
  struct Place {
    int node;
    Pose<double> frame;
    Mat6 A;
  };
  struct Motion {
    std::vector<Pose<double>> poses;
    std::vector<Vec6> velocities;
    PlacesMotion at(double t) const { return {t, poses, velocities}; }
  };
  Motion motion_of(const State& state) const;
  bool evaluate(const State& state, std::vector<Vec6>& wrenches) const;
  bool add_wrenches(const State& state, double factor, VecX& r) const;
  void derive(const State& state, Eigen::MatrixXd& by_motion, Eigen::MatrixXd& by_velocity) const;
  // Calls f(K, C, node of the column, number of the slot) for each pair of places, K = dr/dU and C = dr/dV.
  template <class F>
  void each_block(const State& state, const F& f) const;

  std::shared_ptr<const Force> force_;
  std::vector<Place> places_;
  std::string type_;
  double length_;
  std::size_t first_slot_ = 0;
};

}  // namespace mbd
