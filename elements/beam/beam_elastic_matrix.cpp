#include "elements/beam/beam_elastic_instances.hpp"

namespace mbd::beam {
template std::unique_ptr<BeamElasticBatch> make_elastic<MatrixMetric, EnergyForm>(
    const SpectralTable&, bool);
template std::unique_ptr<BeamElasticBatch> make_elastic<MatrixMetric, PaperForm>(
    const SpectralTable&, bool);
}  // namespace mbd::beam
