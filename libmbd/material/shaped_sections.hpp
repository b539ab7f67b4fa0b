// Sections that are stated by shape, plies and materials (libmbd/scene/materials.hpp): their D and M, computed over
// finite elements (libmbd/section).
#pragma once

#include <memory>
#include <string>

#include "libmbd/scene/scene.hpp"
#include "libmbd/section/shapes.hpp"
#include "libmbd/section/stress.hpp"

namespace mbd {

// Its stiffness in its axes L T N. Throws Error with its place where constants are missing, too many, or not those of a
// positive definite material.
section::Stiffness stiffness_of(const MaterialScene& material);

// The shape in its place in the section, with the plies and materials that it names. `of`: what messages call it, as
// `section "tube"`. Throws Error with its place where something is missing, unknown or does not fit.
section::Mesher mesher_of(const Scene& scene, const SectionShape& shape, const std::string& of);

// Its analysis to the tolerance that it asks for. Throws Error with its place as mesher_of(), where the curvature is too
// strong, and where the tolerance is not reached. Kept, without the warping: the same shape is analysed once in a program.
section::Converged analysed(const Scene& scene, const SectionShape& shape, const std::string& of);

// Its stresses by resultants, on the mesh of that analysis; one more analysis, which is not kept. Throws as analysed().
std::shared_ptr<const section::StressField> stress_field(const Scene& scene,
                                                         const SectionShape& shape,
                                                         const std::string& of);

// The same, and on the mesh before: coarser by one in order and grading.
struct StressFields {
  std::shared_ptr<const section::StressField> fine, before;
};
StressFields stress_fields(const Scene& scene, const SectionShape& shape, const std::string& of);

// Stiffness and mass of all sections and stations that have a shape; materials and layups that are not used are checked,
// too. The reader does it; a program that makes a scene itself calls it before compile(). Couplings below 1e-10 of
// sqrt(Dii Djj), round-off of the analysis, are made zero. A mass that is stated stays; there is none where no
// material has a density.
void analyse_shapes(Scene& scene);

}  // namespace mbd
