// Scenes without one of their effects. An ablation is Scene -> Scene, and what it leaves is compiled anew: no switch
// exists at run time, and what is left out costs nothing.
//
// Axial and shear flexibility are left out by infinite stiffnesses, without their couplings. What has a limit of no effect
// that needs no other equations is taken to this limit in part, by a stated factor: the rotary inertia of sections is
// lowered `reduction` times, and EA, GA2, GA3 are raised so of beams that know no infinite ones (kinematics, form, rule or
// reduction).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Of what is left out in part: 1/reduction is left.
inline constexpr double reduction = 1e3;

struct Ablation {
  std::string key;     // as --without writes it: "gravity", "load:push", "rigid:bar1", "shear"
  std::string effect;  // what is left out: "gravity", "flexibility of beam "bar1""
  std::string change;  // what to write into the model for it; lines
};

// Everything that can be left out of the scene, in the order of tables: flexibility beam by beam, axial and shear
// flexibility, couplings, rotary inertia, masses, axial waves (by damping of their own), damping, gravity, loads, springs, initial curvature.
std::vector<Ablation> ablations_of(const Scene& scene);

// The scene without the effects of these keys. Records, plots and expectations of what no longer exists (sectional
// forces of a rigid beam) are left out. The order of keys does not matter. Throws Error for keys that are none of
// ablations_of(scene), naming them.
Scene without(const Scene& scene, std::span<const std::string> keys);

}  // namespace mbd
