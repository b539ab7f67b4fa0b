// The viscous term of all beam elements of one order, metric and rule, behind one interface: what compile
// needs to fill it, and what output needs to read sectional forces from it. See beam_elastic_batch.hpp.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/choices.hpp"

namespace mbd {

class BeamDampingBatch : public Batch {
 public:
  // Adds a viscous stiffness C ([N; M] vs rates of [gamma; kappa]) and returns its index.
  virtual int add_viscosity(const Mat6& C) = 0;

  // As BeamElasticBatch::add_element, with a viscous stiffness in place of the elastic one.
  virtual Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                            std::span<const int> nodes, int viscosity, int stride,
                            std::string name) = 0;

  // Nodes of the element that are fixed in those named, at H_node^-1 H_own (ElementBatch::set_frames); `reference` of
  // add_element is of its own.
  virtual void set_frames_of(Index element, std::span<const Pose<double>> frames) = 0;

  // Viscous part of the sectional forces [N1 Q2 Q3 M1 M2 M3] of an element at its quadrature points (S: one each), section
  // frame [N, N.m]; zero for a state without rates.
  virtual void resultants(const State& state, Index element, std::span<Vec6> S) const = 0;
};

// Order 1 … 8; throws Error for others. One kernel of run-time size for all of them.
std::unique_ptr<BeamDampingBatch> make_beam_damping(Metric metric, Rule rule, int order);

}  // namespace mbd
