#include "elements/beam_damping_batch.hpp"

#include "elements/beam_damping.hpp"
#include "libmbd/core/error.hpp"

namespace mbd {
namespace beam {

template <class MetricType>
std::unique_ptr<BeamDampingBatch> make_damping(const SpectralTable& table, bool run_time_order);

extern template std::unique_ptr<BeamDampingBatch> make_damping<MatrixMetric>(const SpectralTable&,
                                                                             bool);
extern template std::unique_ptr<BeamDampingBatch> make_damping<QuaternionMetric>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamDampingBatch> make_damping<GeodesicMetric>(const SpectralTable&,
                                                                               bool);

}  // namespace beam

std::unique_ptr<BeamDampingBatch> make_beam_damping(Metric metric, Rule rule, int order,
                                                    bool run_time_order) {
  using namespace beam;
  if (order < 1 || order > max_order)
    throw Error("the order of a beam element must lie in 1 … " + std::to_string(max_order) +
                ", not " + std::to_string(order));
  const SpectralTable table = spectral_table(order, rule);
  switch (metric) {
    case Metric::matrix:
      return make_damping<MatrixMetric>(table, run_time_order);
    case Metric::quaternion:
      return make_damping<QuaternionMetric>(table, run_time_order);
    case Metric::geodesic:
      break;
  }
  return make_damping<GeodesicMetric>(table, run_time_order);
}

}  // namespace mbd
