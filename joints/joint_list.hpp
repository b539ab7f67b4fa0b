// The joint types that a model can name. A new joint is one file, its include and its line in the list.
#pragma once

#include "joints/cylindrical.hpp"
#include "joints/distance.hpp"
#include "joints/driven_rotation.hpp"
#include "joints/driven_translation.hpp"
#include "joints/fixed.hpp"
#include "joints/planar.hpp"
#include "joints/point_on_line.hpp"
#include "joints/prescribed_rotation.hpp"
#include "joints/prescribed_translation.hpp"
#include "joints/prismatic.hpp"
#include "joints/revolute.hpp"
#include "joints/rigid_link.hpp"
#include "joints/screw.hpp"
#include "joints/spherical.hpp"
#include "joints/universal.hpp"

namespace mbd::joint {

template <class... J>
struct List {};

using Types = List<Fixed,        //
                   RigidLink,    //
                   Revolute,     //
                   Prismatic,    //
                   Cylindrical,  //
                   Screw,        //
                   Universal,    //
                   Spherical,    //
                   Planar,       //
                   PointOnLine,  //
                   Distance>;

// What <drive> and <motion> are made of.
using Prescribed =
    List<DrivenRotation, DrivenTranslation, PrescribedTranslation, PrescribedRotation>;

// Calls f.template operator()<J>() for each type.
template <class... J, class F>
void for_each(List<J...>, F&& f) {
  (f.template operator()<J>(), ...);
}

}  // namespace mbd::joint
