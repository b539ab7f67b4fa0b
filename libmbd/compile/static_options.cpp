#include "libmbd/compile/static_options.hpp"

#include "libmbd/compile/model.hpp"

namespace mbd {

StaticOptions static_options(const Scene& scene, const StaticScene& statics) {
  StaticOptions options;
  options.steps = statics.steps;
  options.newton.tolerance = statics.tolerance;
  options.newton.line_search = statics.line_search;
  options.solver = statics.solver;
  options.has_potential = has_potential(scene);
  Scene symmetric = scene;
  for (BeamScene& beam : symmetric.beams) beam.form = Form::energy;
  options.conservative = has_potential(symmetric);
  return options;
}

}  // namespace mbd
