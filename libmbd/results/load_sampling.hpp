// How well the nodes of beams know the distributed loads on them.
//
// A load is sampled at the nodes, f_k = w_k J q(s_k). What acts in truth is f*_k = int N_k q ds, N_k the polynomials of the
// element. Of a load that is no polynomial of degree N - 1 in an element both differ, and where it goes up and down
// between two nodes by more than it is large. Then the deflection is that of another load, in which elements see nothing wrong.
#pragma once

#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

struct LoadSampling {
  bool any = false;    // is there a load that varies along a beam with elements
  double error = 0.0;  // of the worst row: (sum |f_k - f*_k|^2 / sum |f*_k|^2)^1/2
  std::string where;   // its load, and the beam
};

// At the start and two more times of the run; of long beams some of the elements. Laws of sensors are left out.
LoadSampling load_sampling(const Scene& scene, const Model& model);

}  // namespace mbd
