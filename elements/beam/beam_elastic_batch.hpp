// The elastic term of all beam elements of one order, metric, rule and form, or of one order and rule of the
// classical beam, behind one interface: what compile needs to fill it, and what output needs to read
// sectional forces from it.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/choices.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd {

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

  // Sectional forces [N1 Q2 Q3 M1 M2 M3] of an element at xi in [-1, 1], section frame [N, N.m].
  virtual Vec6 resultants(const State& state, Index element, double xi) const = 0;

  virtual const SpectralTable& table() const = 0;
};

// Order 1 … 8; throws Error for others. Kernels of fixed size up to order 5, and one of run-time size above: at order 6 it
// takes 0.8 to 1.1 times as long as a fixed one would, but keeps 3 kB an element where that would keep half. For all orders where the library was built with MBD_RUNTIME_ORDER_ONLY (or
// run_time_order is asked for).
std::unique_ptr<BeamElasticBatch> make_beam_elastic(Metric metric, Form form, Rule rule, int order,
                                                    bool run_time_order = false);

// The same for the classical beam (beam_classical.hpp): displacement and rotation interpolated apart.
std::unique_ptr<BeamElasticBatch> make_beam_classical(Rule rule, int order,
                                                      bool run_time_order = false);

}  // namespace mbd
