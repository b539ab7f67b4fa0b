#include "elements/beam/beam_damping_instances.hpp"

namespace mbd::beam {
template std::unique_ptr<BeamDampingBatch> make_damping<GeodesicMetric>(const SpectralTable&);
}
