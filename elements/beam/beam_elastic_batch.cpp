#include "elements/beam/beam_elastic_batch.hpp"

#include "elements/beam/beam_elastic.hpp"
#include "libmbd/core/error.hpp"

namespace mbd {
namespace beam {

template <class MetricType, class FormType>
std::unique_ptr<BeamElasticBatch> make_elastic(const SpectralTable& table, bool run_time_order);

extern template std::unique_ptr<BeamElasticBatch> make_elastic<MatrixMetric, EnergyForm>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamElasticBatch> make_elastic<MatrixMetric, PaperForm>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamElasticBatch> make_elastic<QuaternionMetric, EnergyForm>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamElasticBatch> make_elastic<QuaternionMetric, PaperForm>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamElasticBatch> make_elastic<GeodesicMetric, EnergyForm>(
    const SpectralTable&, bool);
extern template std::unique_ptr<BeamElasticBatch> make_elastic<GeodesicMetric, PaperForm>(
    const SpectralTable&, bool);

}  // namespace beam

beam::HeldForces BeamElasticBatch::held_forces(const State& state, Index element) const {
  beam::HeldForces all;
  if (held_of(element).empty()) return all;
  all.S.assign(table().rule.points.size(), Vec6::Zero());
  for (const auto& [strains, number] : held_of(element)) {
    const Mat6& D = strains->stiffness(number);
    all.stiffness += D;
    for (std::size_t c = 0; c < 6 && D.isZero(0.0); ++c)
      all.held[c] = all.held[c] || strains->held(number)[c];
    strains->add_forces(state, number, all.S);
    strains->add_end_forces(state, number, all.first, all.last);
  }
  return all;
}

std::unique_ptr<BeamElasticBatch> make_beam_elastic(Metric metric, Form form, Rule rule, int order,
                                                    bool run_time_order) {
  using namespace beam;
  if (order < 1 || order > max_order)
    throw Error("the order of a beam element must lie in 1 … " + std::to_string(max_order) +
                ", not " + std::to_string(order));
  const SpectralTable table = spectral_table(order, rule);
  const bool energy = form == Form::energy;
  switch (metric) {
    case Metric::matrix:
      return energy ? make_elastic<MatrixMetric, EnergyForm>(table, run_time_order)
                    : make_elastic<MatrixMetric, PaperForm>(table, run_time_order);
    case Metric::quaternion:
      return energy ? make_elastic<QuaternionMetric, EnergyForm>(table, run_time_order)
                    : make_elastic<QuaternionMetric, PaperForm>(table, run_time_order);
    case Metric::geodesic:
      break;
  }
  return energy ? make_elastic<GeodesicMetric, EnergyForm>(table, run_time_order)
                : make_elastic<GeodesicMetric, PaperForm>(table, run_time_order);
}

}  // namespace mbd
