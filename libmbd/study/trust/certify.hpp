// What a certificate needs other runs of the scene for: it moved rigidly, its parts listed in another order, and with
// half the steps or a tenth of the tolerance.
#pragma once

#include <functional>
#include <string>

#include "libmbd/results/certificate.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

struct CertifyOptions {
  double within = 60.0;  // CPU time [s]; of a long transient as much is run again as fits
  std::function<void(const std::string& what)> progress = {};  // before each run
};

// Adds them to the certificate of `report`, of a run of `scene` that came to its end.
void certify(const Scene& scene, const CertifyOptions& options, RunReport& report);

}  // namespace mbd
