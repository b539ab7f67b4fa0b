#include "elements/beam/beam_damping_batch.hpp"

#include "elements/beam/beam_damping.hpp"
#include "libmbd/core/error.hpp"

namespace mbd {
namespace beam {

template <class MetricType>
std::unique_ptr<BeamDampingBatch> make_damping(const SpectralTable& table);

extern template std::unique_ptr<BeamDampingBatch> make_damping<MatrixMetric>(const SpectralTable&);
extern template std::unique_ptr<BeamDampingBatch> make_damping<QuaternionMetric>(
    const SpectralTable&);
extern template std::unique_ptr<BeamDampingBatch> make_damping<GeodesicMetric>(
    const SpectralTable&);

}  // namespace beam

std::unique_ptr<BeamDampingBatch> make_beam_damping(Metric metric, Rule rule, int order) {
  using namespace beam;
  if (order < 1 || order > max_order)
    throw Error("the order of a beam element must lie in 1 … " + std::to_string(max_order) +
                ", not " + std::to_string(order));
  const SpectralTable table = spectral_table(order, rule);
  switch (metric) {
    case Metric::matrix:
      return make_damping<MatrixMetric>(table);
    case Metric::quaternion:
      return make_damping<QuaternionMetric>(table);
    case Metric::geodesic:
      break;
  }
  return make_damping<GeodesicMetric>(table);
}

}  // namespace mbd
