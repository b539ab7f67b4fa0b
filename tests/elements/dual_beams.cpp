// Each kernel of a beam on dual numbers, compiled once.
#include "elements/beam/beam_classical.hpp"
#include "elements/beam/beam_elastic.hpp"
#include "tests/elements/dual_tangent.hpp"

namespace mbd::laws {
namespace {

struct Classical {};

template <class MetricType, class FormType>
struct KernelOf {
  using Type = beam::Elastic<MetricType, FormType, 0>;
  static typename Type::Data data(const Beam& b, const SpectralTable& t) {
    return beam::make_data<MetricType, 0>(t, b.J, b.reference, 0, b.D.size() > 1 ? 1 : 0);
  }
};
template <class FormType>
struct KernelOf<Classical, FormType> {
  using Type = beam::Classical<0>;
  static typename Type::Data data(const Beam& b, const SpectralTable& t) {
    return Type::make_data(beam::make_table<0>(t), b.J, b.reference, 0, b.D.size() > 1 ? 1 : 0);
  }
};

// The kernel for an order known at run time, on dual numbers.
template <class MetricType, class FormType>
struct DualBeam {
  using Kernel = typename KernelOf<MetricType, FormType>::Type;
  typename Kernel::Shared shared;
  typename Kernel::Data data;

  explicit DualBeam(const Beam& b) : DualBeam(b, spectral_table(b.order, b.rule)) {}
  DualBeam(const Beam& b, const SpectralTable& t)
      : shared{beam::make_table<0>(t), b.D}, data(KernelOf<MetricType, FormType>::data(b, t)) {}

  MatrixXd tangent(const std::vector<Pose<double>>& pose) const {
    return dual_tangent<Kernel>(shared, data, node_states(pose), {}, false);
  }
  VecX energy_gradient(const std::vector<Pose<double>>& pose) const {
    const Index n = 6 * static_cast<Index>(pose.size());
    std::vector<NodeState<D1>> y(pose.size());
    VecX gradient(n);
    for (Index c = 0; c < n; ++c) {
      for (std::size_t a = 0; a < pose.size(); ++a)
        y[a].H = seeded(
            pose[a], static_cast<Index>(a) == c / 6 ? Vec6(Vec6::Unit(c % 6)) : Vec6(Vec6::Zero()));
      gradient(c) = Kernel::template energy<D1>(shared, data, y.data()).d;
    }
    return gradient;
  }
};

template <class F>
auto with_kernel(const Beam& b, const F& f) {
  if (b.kinematics == Kinematics::classical) return f(DualBeam<Classical, beam::EnergyForm>(b));
  const auto with_metric = [&]<class MetricType>() {
    return b.form == Form::energy ? f(DualBeam<MetricType, beam::EnergyForm>(b))
                                  : f(DualBeam<MetricType, beam::PaperForm>(b));
  };
  switch (b.metric) {
    case Metric::matrix:
      return with_metric.template operator()<MatrixMetric>();
    case Metric::quaternion:
      return with_metric.template operator()<QuaternionMetric>();
    case Metric::geodesic:
      break;
  }
  return with_metric.template operator()<GeodesicMetric>();
}

}  // namespace

MatrixXd dual_tangent(const Beam& b) {
  return with_kernel(b, [&](const auto& kernel) { return kernel.tangent(b.pose); });
}
VecX dual_energy_gradient(const Beam& b) {
  return with_kernel(b, [&](const auto& kernel) { return kernel.energy_gradient(b.pose); });
}

}  // namespace mbd::laws
