// The joint types that a model can name. A new joint is one file and one line here.
#pragma once

#include "joints/cylindrical.hpp"
#include "joints/driven_rotation.hpp"
#include "joints/fixed.hpp"
#include "joints/revolute.hpp"
#include "joints/spherical.hpp"

namespace mbd::joint {

template <class... J>
struct List {};

using Types = List<Fixed,        //
                   Revolute,     //
                   Cylindrical,  //
                   Spherical>;

// Calls f.template operator()<J>() for each type.
template <class... J, class F>
void for_each(List<J...>, F&& f) {
  (f.template operator()<J>(), ...);
}

}  // namespace mbd::joint
