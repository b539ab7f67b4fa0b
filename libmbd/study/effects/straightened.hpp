// A curved beam made of straight ones.
//
// Initial curvature and twist couple stretching, bending and torsion of an element (K0, NOTATION.md 3). No number of
// the scene turns this off; without it, elements are straight, and what was smooth is a polygon: straight beams of one
// element between the points at which the elements of the beam end, their third axis that of its middle, joined by
// <fixed>. So its effect includes that of the shorter line; with the number of elements it goes as its square to zero.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// `name`, or where a part of the scene has it, `name` with as many _ after it as are needed.
std::string free_name(const Scene& scene, std::string name);

// Whether the named beam has initial curvature or twist, is flexible, and can be made of straight ones: not where its
// section is interpolated by a spline through stations, of which pieces are none.
bool can_be_straightened(const Scene& scene, const BeamScene& beam);

// The straight beams' names, in order: those of the beam with _1, _2 …
std::vector<std::string> names_of_pieces(const Scene& scene, const BeamScene& beam);

// The scene with straight beams in place of the named one. Places on it, which are all ends of pieces, are those of the
// piece before (the start: of the first); what lies along it is divided. For a beam that can_be_straightened.
void straighten(Scene& scene, const std::string& beam);

}  // namespace mbd
