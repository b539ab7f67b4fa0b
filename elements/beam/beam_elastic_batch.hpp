// The elastic term of all beam elements of one order, metric, rule and form, or of one order and rule of the
// classical beam, behind one interface: what compile needs to fill it, and what output needs to read
// sectional forces from it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elements/beam/held_strains.hpp"
#include "elements/beam/mesh_error.hpp"
#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"
#include "libmbd/core/choices.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd {

namespace beam {

// What an element whose strains are held adds to mesh_error_of(), beside its own compliance and forces.
struct HeldForces {
  StrainSet held{};               // at zero
  Mat6 stiffness = Mat6::Zero();  // beside the section's own
  std::vector<Vec6> S;            // by point
  Vec6 first = Vec6::Zero(), last = Vec6::Zero();
};

}  // namespace beam

class BeamElasticBatch : public Batch {
 public:
  // Adds a sectional stiffness D ([N; M] vs [gamma; kappa]) and returns its index.
  virtual int add_stiffness(const Mat6& D) = 0;

  // Adds an element: ds/dxi and the reference pose at each node [m], its node indices, and the stiffness
  // of its first quadrature point (the same at all for stride 0; one index a point for stride 1).
  // Returns its index. `name` is for messages.
  virtual Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                            std::span<const int> nodes, int stiffness, int stride,
                            std::string name) = 0;

  // Nodes of the element that are fixed in those named, at H_node^-1 H_own (ElementBatch::set_frames); `reference` of
  // add_element is of its own.
  virtual void set_frames_of(Index element, std::span<const Pose<double>> frames) = 0;

  // Strains of that element have forces of another batch, of which it is `number`, added to those of its stiffness (which does
  // not matter where they are held at zero). Of Gauss's rule.
  void set_held(Index element, const HeldStrains& strains, Index number) {
    held_[element].push_back({&strains, number});
  }

  // Sectional forces [N1 Q2 Q3 M1 M2 M3] of an element at its quadrature points (S: one each), section frame [N, N.m].
  void resultants(const State& state, Index element, std::span<Vec6> S) const {
    elastic_resultants(state, element, S);
    for (const Held& held : held_of(element)) held.strains->add_forces(state, held.number, S);
  }

  virtual const SpectralTable& table() const = 0;

  // What the mesh leaves out of an element's deformation (mesh_error.hpp); `rule` is of table().
  virtual beam::MeshError mesh_error(const State& state, Index element,
                                     const beam::MeshErrorRule& rule) const = 0;
  virtual const std::string& name_of(Index element) const = 0;

  // The section of an element along which it varies, for mesh_error(); the function is called there.
  using SectionSamples = std::function<std::vector<beam::SectionSample>()>;
  void set_varying(Index element, SectionSamples samples) {
    varying_[element] = std::move(samples);
  }

 protected:
  virtual void elastic_resultants(const State& state, Index element, std::span<Vec6> S) const = 0;

  // An element of a batch that holds strains.
  struct Held {
    const HeldStrains* strains;
    Index number;
  };
  std::span<const Held> held_of(Index element) const {
    const auto found = held_.find(element);
    return found == held_.end() ? std::span<const Held>() : found->second;
  }

  beam::HeldForces held_forces(const State& state, Index element) const;

  // Empty where it does not vary.
  std::vector<beam::SectionSample> section_samples(Index element) const {
    const auto found = varying_.find(element);
    return found == varying_.end() ? std::vector<beam::SectionSample>() : found->second();
  }

 private:
  std::map<Index, SectionSamples> varying_;
  std::map<Index, std::vector<Held>> held_;
};

namespace beam {

// BeamElasticBatch::mesh_error of an element of a kernel: its states, as ElementBatch gathers them.
template <class Kernel, class Shared, class Data>
MeshError mesh_error_of(const Shared& shared, const Data& data, const NodeState<double>* x,
                        const SpectralTable& table, const MeshErrorRule& rule,
                        std::span<const SectionSample> samples, const HeldForces& held) {
  typename Kernel::template Output<double> out;
  Kernel::template evaluate<Want::residual>(shared, data, x, Environment{}, RateWeights{}, out);
  const std::vector<Vec6> still(table.nodes.points.size(), Vec6::Zero());
  const std::size_t points = table.rule.points.size();
  std::vector<Vec6> S(points);
  std::vector<Mat6> compliance(points);
  Kernel::linearized_resultants(shared, data, x, still.data(), S.data());
  double length = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    compliance[i] =
        compliance_of(Kernel::D_at(shared, data, static_cast<int>(i)) + held.stiffness, held.held);
    if (!held.S.empty()) S[i] += held.S[i];
    length += data.wJ[i];
  }
  const Vec6 begin = -out.r.template head<6>() - held.first,
             end = out.r.template segment<6>(6 * table.order) + held.last;
  return rule(length, S, compliance, begin, end, samples, held.held);
}

}  // namespace beam

// Order 1 … 8; throws Error for others. Kernels of fixed size up to order 5, and one of run-time size above: at order 6 it
// takes 0.8 to 1.1 times as long as a fixed one would, but keeps 3 kB an element where that would keep half. For all orders where the library was built with MBD_RUNTIME_ORDER_ONLY (or
// run_time_order is asked for).
std::unique_ptr<BeamElasticBatch> make_beam_elastic(Metric metric, Form form, Rule rule, int order,
                                                    bool run_time_order = false);

// The same for the classical beam (beam_classical.hpp): displacement and rotation interpolated apart.
std::unique_ptr<BeamElasticBatch> make_beam_classical(Rule rule, int order,
                                                      bool run_time_order = false);

}  // namespace mbd
