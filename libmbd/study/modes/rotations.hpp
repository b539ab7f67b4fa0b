// Steady rotations of a scene over their rate, with all that belong to one rate: paths that turn back at folds
// (rotation_path.hpp), and others that are not joined to them within the range. A rotor out of balance whose bending stiffens
// turns in three shapes beyond its critical speed, of which the run-up follows one, until it jumps.
//
// A first path is from the equilibrium that there is at rest, turned to the first rate. At some rates others are sought: each
// rotation that is known there is pushed by forces along its slowest modes, and where a force vanishes again on the way there is another, which is followed both ways. Nothing proves that
// there are no more.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"

namespace mbd {

struct RotationsOptions : RangeOfRates {
  int count = 8;     // modes whose growth is looked at, the slowest
  int searches = 9;  // rates at which others are sought, evenly spaced to the ends; 0: none
  // How far a push may move it from one: mean over the nodes, of the scene's size and in rad, or of twice what that one
  // is away from the reference configuration, if that is more.
  double far = 1.0;
  int points = 500;                      // of a path, at most, in each sense
  double largest_step = 1.0 / 50.0;      // of the range of rates
  std::vector<std::string> probes = {};  // places whose displacement is given
  std::function<void(std::size_t paths, double rate)> progress = {};
  const std::atomic<bool>* interrupted = nullptr;
};

struct RotationOnPath {
  double rate = 0.0;  // [rad/s]
  double arc = 0.0;   // along the path, rotation_path.hpp (1)
  bool is_fold = false;
  double displacement = 0.0;    // of the node that moves most from the reference configuration [m]
  std::string displaced;        // which
  double growth = 0.0;          // largest Re of the eigenvalues looked at [1/s]; of round-off: 0
  std::optional<int> unstable;  // how many of these grow; empty where they could not be found
  std::vector<Vec3> probes;  // displacements of the places, inertial axes, with drives at t = 0 [m]
};

struct PathOfRotations {
  std::vector<RotationOnPath> points;  // along it
  std::vector<std::string>
      ends;               // why it ends: of one that was found on its way, at its begin and end
  double found_at = 0.0;  // [rad/s] where it was found
};

struct RotationsStudy {
  std::string model, file;
  double from = 0.0, to = 0.0;
  int count = 0;
  std::vector<double> searched;  // rates at which others were sought [rad/s]
  std::vector<std::string> probes;
  std::vector<PathOfRotations> paths;  // the first is the one from rest
  std::vector<std::string> notes;
};

// Throws Error as MotionsOfScene does. Interrupted it ends with what there is, and a note.
RotationsStudy study_rotations(const Scene& scene, const RotationsOptions& options);

// For the terminal: each path, its folds, where it is stable.
std::string to_text(const RotationsStudy& study);
// A row a point.
std::string to_csv(const RotationsStudy& study);
// Displacement over the rate, stable and unstable, folds; and of each probe.
std::string rotations_svg(const RotationsStudy& study);

}  // namespace mbd
