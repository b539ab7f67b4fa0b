#include "solvers/newton/kept_resultants.hpp"

#include <algorithm>
#include <cmath>

namespace mbd {

KeptResultants::KeptResultants(const System& system, double from) : system_(system) {
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    const auto* const beams = dynamic_cast<const IteratedBeams*>(system.batches()[b].get());
    if (beams == nullptr || !(beams->slenderness() >= from)) continue;
    const IteratedBeams::Sizes sizes = beams->sizes();
    parts_.push_back({b, beams, numbers_, sizes.resultants, kept_, sizes.tangent});
    numbers_ += sizes.resultants;
    kept_ += sizes.tangent;
  }
}

void KeptResultants::set(const State& state, std::vector<double>& S) const {
  S.resize(size());
  if (!begun_) return;
  for (const Part& part : parts_) part.beams->keep(state, {}, part.of(S));
}

bool KeptResultants::residual(const State& given, Iterate& at, VecX& r) {
  if (!begun_) return system_.residual(given, r);
  at.DE.resize(numbers_);
  const State& state = system_.fed_back(given);
  bool in_range = is_finite_feedback(given);
  r.setZero(system_.rows());
  std::size_t next = 0;
  for (std::size_t b = 0; b < system_.batches().size(); ++b) {
    if (next == parts_.size() || parts_[next].batch != b) {
      in_range &= system_.batches()[b]->residual(state, r);
      continue;
    }
    const Part& part = parts_[next++];
    in_range &=
        part.beams->residual_kept(state, part.kept_of(tangent_), part.of(at.S), part.of(at.DE), r);
  }
  for (const Index row : state.idle) r(6 * system_.nodes() + row) = 0.0;
  return in_range;
}

// What System::fed_back() leaves out otherwise.
bool KeptResultants::is_finite_feedback(const State& state) {
  if (!system_.feeds_back()) return true;
  system_.signals_at(state.t, state.side, state.inputs, signals_, &state);
  return std::all_of(signals_.begin(), signals_.end(),
                     [](const SignalValue& signal) { return std::isfinite(signal.f); });
}

void KeptResultants::keep_tangent(const State& state, double U, Iterate& at,
                                  std::span<const Slot> slots) {
  if (!begun_) return;
  at.DE.resize(numbers_);
  tangent_.resize(kept_);
  for (const Part& part : parts_) {
    part.beams->keep(state, std::span(tangent_).subspan(part.first_kept, part.kept),
                     part.of(at.DE));
    part.beams->add_geometric_stiffness(state, U, part.of(at.S), part.of(at.DE), slots);
  }
}

void KeptResultants::advance(const VecX& dU, Iterate& at) const {
  if (!begun_) return;
  for (const Part& part : parts_)
    part.beams->advance(part.kept_of(tangent_), {dU.data(), static_cast<std::size_t>(dU.size())},
                        part.of(at.DE), part.of(at.S));
}

}  // namespace mbd
