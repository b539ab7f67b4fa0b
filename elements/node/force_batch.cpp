#include "elements/node/force_batch.hpp"

#include <cmath>

namespace mbd {
namespace {

class FunctionForce final : public Force {
 public:
  using Function = std::function<bool(const PlacesMotion&, std::span<Vec6>)>;
  FunctionForce(std::string name, std::vector<std::string> places, Function evaluate)
      : name_(std::move(name)), places_(std::move(places)), evaluate_(std::move(evaluate)) {}
  std::string name() const override { return name_; }
  std::vector<std::string> places() const override { return places_; }
  bool evaluate(const PlacesMotion& at, std::span<Vec6> wrenches) const override {
    return evaluate_(at, wrenches);
  }

 private:
  std::string name_;
  std::vector<std::string> places_;
  Function evaluate_;
};

bool is_finite(std::span<const Vec6> all) {
  for (const Vec6& f : all)
    if (!f.allFinite()) return false;
  return true;
}

}  // namespace

std::shared_ptr<const Force> make_force(
    std::string name, std::vector<std::string> places,
    std::function<bool(const PlacesMotion&, std::span<Vec6>)> evaluate) {
  return std::make_shared<FunctionForce>(std::move(name), std::move(places), std::move(evaluate));
}

ForceBatch::ForceBatch(std::shared_ptr<const Force> force, std::vector<At> places, double length)
    : force_(std::move(force)), type_("force '" + force_->name() + "'"), length_(length) {
  for (const At& at : places)
    places_.push_back({at.node, at.frame, adjoint_inverse(at.frame).matrix()});
}

void ForceBatch::connect(BlockGraph& graph) {
  first_slot_ = graph.contributions.size();
  for (const Place& b : places_)
    for (const Place& a : places_) graph.contributions.push_back({a.node - 1, b.node - 1});
}

ForceBatch::Motion ForceBatch::motion_of(const State& state) const {
  Motion motion;
  for (const Place& place : places_) {
    const auto n = static_cast<std::size_t>(place.node);
    motion.poses.push_back(state.pose[n] * place.frame);
    motion.velocities.push_back(state.V.empty() ? Vec6(Vec6::Zero()) : Vec6(place.A * state.V[n]));
  }
  return motion;
}

bool ForceBatch::evaluate(const State& state, std::vector<Vec6>& wrenches) const {
  wrenches.assign(places_.size(), Vec6::Zero());
  return force_->evaluate(motion_of(state).at(state.t), wrenches) && is_finite(wrenches);
}

bool ForceBatch::add_wrenches(const State& state, double factor, VecX& r) const {
  std::vector<Vec6> wrenches;
  if (!evaluate(state, wrenches)) return false;
  for (std::size_t i = 0; i < places_.size(); ++i)
    r.segment<6>(6 * places_[i].node) -= factor * (places_[i].A.transpose() * wrenches[i]);
  return true;
}

bool ForceBatch::residual(const State& state, VecX& r) const {
  return add_wrenches(state, state.load_factor, r);
}

void ForceBatch::derive(const State& state, Eigen::MatrixXd& by_motion,
                        Eigen::MatrixXd& by_velocity) const {
  const auto size = 6 * static_cast<Index>(places_.size());
  by_motion = by_velocity = Eigen::MatrixXd::Zero(size, size);
  Motion motion = motion_of(state);
  if (force_->derivatives(motion.at(state.t), by_motion, by_velocity)) return;
  constexpr double part = 6e-6;  // the third root of round-off
  std::vector<Vec6> ahead(places_.size()), behind(places_.size());
  const auto column = [&](Index j, double step, const auto& change, Eigen::MatrixXd& into) {
    for (auto* wrenches : {&ahead, &behind}) {
      wrenches->assign(places_.size(), Vec6::Zero());
      change(wrenches == &ahead ? step : -step);
      // The residual says that the force is out of its range; the tangent stays finite.
      if (!force_->evaluate(motion.at(state.t), *wrenches) || !is_finite(*wrenches)) return;
    }
    for (std::size_t a = 0; a < places_.size(); ++a)
      into.col(j).segment<6>(6 * static_cast<Index>(a)) = (ahead[a] - behind[a]) / (2.0 * step);
  };
  const bool rates = !state.V.empty();
  for (std::size_t b = 0; b < places_.size(); ++b) {
    const Pose<double> H = motion.poses[b];
    const Vec6 V = motion.velocities[b];
    for (Index k = 0; k < 6; ++k) {
      const Index j = 6 * static_cast<Index>(b) + k;
      const double of_length = k < 3 ? length_ : 1.0;
      column(
          j, part * of_length,
          [&](double step) { motion.poses[b] = H * exp_se3<double>(Vec6(step * Vec6::Unit(k))); },
          by_motion);
      motion.poses[b] = H;
      if (!rates) continue;
      column(
          j, part * std::max(of_length, std::abs(V(k))),
          [&](double step) { motion.velocities[b] = V + step * Vec6::Unit(k); }, by_velocity);
      motion.velocities[b] = V;
    }
  }
}

template <class F>
void ForceBatch::each_block(const State& state, const F& f) const {
  Eigen::MatrixXd by_motion, by_velocity;
  derive(state, by_motion, by_velocity);
  std::size_t slot = first_slot_;
  for (std::size_t b = 0; b < places_.size(); ++b)
    for (std::size_t a = 0; a < places_.size(); ++a, ++slot) {
      const Index i = 6 * static_cast<Index>(a), j = 6 * static_cast<Index>(b);
      const auto block = [&](const Eigen::MatrixXd& of) {
        return Mat6(-state.load_factor *
                    (places_[a].A.transpose() * Mat6(of.block<6, 6>(i, j)) * places_[b].A));
      };
      f(block(by_motion), block(by_velocity), static_cast<std::size_t>(places_[b].node), slot);
    }
}

bool ForceBatch::linearize(const State& state, const TangentWeights& weights, VecX& r,
                           std::span<const Slot> slots) const {
  each_block(state, [&](const Mat6& K, const Mat6& C, std::size_t node, std::size_t slot) {
    slots[slot].add(weights.U * K + weights.at_node(weights.V * C, node));
  });
  return residual(state, r);
}

void ForceBatch::add_rate_tangent(const State& state, const TangentWeights& weights,
                                  std::span<const Slot> slots) const {
  each_block(state, [&](const Mat6&, const Mat6& C, std::size_t node, std::size_t slot) {
    slots[slot].add(weights.at_node(weights.V * C, node));
  });
}

bool ForceBatch::linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                                  const std::array<std::span<const Slot>, 3>& P) const {
  each_block(state, [&](const Mat6& K, const Mat6& C, std::size_t node, std::size_t slot) {
    P[0][slot].add(K + C * V_hat[node]);
    P[1][slot].add(C);
  });
  return residual(state, r);
}

void ForceBatch::load_rate(const State& state, VecX& r) const { add_wrenches(state, 1.0, r); }

std::string ForceBatch::out_of_range(const State& state) const {
  std::vector<Vec6> wrenches(places_.size(), Vec6::Zero());
  if (!force_->evaluate(motion_of(state).at(state.t), wrenches)) {
    const std::string fault = force_->fault();
    return fault.empty() ? type_ : type_ + " fails (" + fault + ")";
  }
  return is_finite(wrenches) ? std::string()
                             : type_ + " gives numbers that are none (NaN or infinite)";
}

Energies ForceBatch::energies(const State& state) const {
  Energies e;
  e.strain = state.load_factor * force_->energy(motion_of(state).at(state.t)).value_or(0.0);
  return e;
}

double ForceBatch::load_power(const State& state) const {
  if (state.V.empty()) return 0.0;
  const Motion motion = motion_of(state);
  if (force_->energy(motion.at(state.t))) return 0.0;
  std::vector<Vec6> wrenches;
  evaluate(state, wrenches);
  double power = 0.0;
  for (std::size_t i = 0; i < places_.size(); ++i) power += wrenches[i].dot(motion.velocities[i]);
  return state.load_factor * power;
}

}  // namespace mbd
