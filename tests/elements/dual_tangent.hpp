// The derivative of a kernel's residual by dual numbers: the kernel is compiled on them where this is used, which is slow,
// so in as few places as there are kernels.
#pragma once

#include <vector>

#include "elements/element.hpp"
#include "tests/elements/laws.hpp"

namespace mbd::laws {

// Tangent of a kernel's residual with respect to poses, or to rates with the given weights.
template <Element E>
MatrixXd dual_tangent(const typename E::Shared& shared, const typename E::Data& data,
                      const std::vector<NodeState<double>>& x, const Environment& env,
                      bool of_rates, RateWeights w = {}) {
  const Index n = 6 * static_cast<Index>(x.size());
  std::vector<NodeState<D1>> y(x.size());
  MatrixXd K(n, n);
  for (Index c = 0; c < n; ++c) {
    for (std::size_t a = 0; a < x.size(); ++a) {
      const bool here = static_cast<Index>(a) == c / 6;
      const Vec6 U = here ? Vec6(Vec6::Unit(c % 6)) : Vec6(Vec6::Zero());
      y[a].H = of_rates ? x[a].H.template cast<D1>() : seeded(x[a].H, U);
      y[a].V = seeded(x[a].V, of_rates ? Vec6(w.V * U) : Vec6(Vec6::Zero()));
      y[a].Vdot = seeded(x[a].Vdot, of_rates ? Vec6(w.A * U) : Vec6(Vec6::Zero()));
    }
    typename E::template Output<D1> out;
    E::template evaluate<Want::residual>(shared, data, y.data(), env, RateWeights{}, out);
    for (Index i = 0; i < n; ++i) K(i, c) = out.r(i).d;
  }
  return K;
}

}  // namespace mbd::laws
