// Campbell diagram: modes of a scene that turns steadily, followed over the rate of rotation; critical speeds, at which a
// rotor out of balance drives a mode (which stands still as seen from what turns), and speeds at which stability is lost
// or won.
//
// Modes are found in axes in which coefficients are constant (steady_rotation.hpp), and are followed by their shapes: overlap |x^H M y|^2/(|x^H M x| |y^H M y|), with steps of the rate halved where it is low. A mode and
// its conjugate are one: what passes through a critical speed goes on with a negative frequency.
#pragma once

#include <atomic>
#include <complex>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/response.hpp"

namespace mbd {

struct CampbellOptions : RangeOfRates {
  int points = 61;  // evenly spaced, at least
  int count = 8;    // modes, the slowest at the first rate
  // Whose response is found at the same rates.
  std::vector<Unbalance> unbalance = {};
  std::vector<HarmonicForce> forces = {};
  double order = 1.0;                    // of the forces: their frequency over the rate
  std::vector<std::string> probes = {};  // where, besides where they act
  std::function<void(std::size_t done, std::size_t all)> progress = {};
  const std::atomic<bool>* interrupted = nullptr;
};

struct CampbellPoint {
  double rate = 0.0;  // [rad/s]
  std::complex<double>
      eigenvalue;  // in `axes` [1/s]; of a pair the one that goes on from the point before
  // Frequency in inertial axes [rad/s], that of the larger part where orbits are ellipses: positive forward, negative
  // backward. Empty where orbits are nearer to lines than to circles, and where there are none.
  std::optional<double> inertial = {};
  bool has_orbit = false;
  double orbit = 0.0;      // as NamedMode::orbit, of this eigenvalue
  double overlap = 1.0;    // with the point before
  double round_off = 0.0;  // as Mode::round_off
};

struct CampbellBranch {
  std::string name;  // at the first rate
  std::vector<CampbellPoint> points;
};

struct SpecialSpeed {
  enum class Kind { critical, unstable_above, stable_above } kind = Kind::critical;
  double rate = 0.0;  // [rad/s], to round-off of the eigenvalue
  std::size_t branch = 0;
  double round_off = 0.0;  // of the rate, relative, an estimate
};

const char* word_of(SpecialSpeed::Kind kind);  // "unstable_above", for files

struct CampbellStudy {
  std::string model, file;
  SteadyRotation rotation;
  ModeAxes axes = ModeAxes::turning;
  std::vector<double> rates;  // where steady rotation was found, rising
  std::vector<double>
      displacements;  // of the node that moves most from the reference configuration, there [m]
  std::vector<CampbellBranch> branches;
  std::vector<SpecialSpeed> special;  // by rate
  struct Response {
    std::string place;
    // By rate, at those of the diagram and at others about resonances, to their tops; none where the equations are singular.
    std::vector<Orbit> orbits;
  };
  std::vector<Response> responses;        // to unbalance
  std::vector<Response> force_responses;  // to harmonic forces
  double order = 1.0;                     // of these
  std::vector<std::string> notes;
};

// Throws Error as MotionsOfScene does, and where the rate after the first is not reached; a later one, or an interruption, ends
// the diagram with a note.
CampbellStudy study_campbell(const Scene& scene, const CampbellOptions& options);

std::string to_text(const CampbellStudy& study);
// One row a rate and branch.
std::string to_csv(const CampbellStudy& study);
// One row a rate and place.
std::string response_csv(const std::vector<CampbellStudy::Response>& responses);
std::string campbell_svg(const CampbellStudy& study);

// campbell.h5: all of it as arrays over the same rates (not a number: nothing there), as run.h5 has them (run_file.hpp), each
// with its `unit`, and where it is not plain its `label`:
//   /                attributes format, model, file, mbd, commit, date; axes: turning or resting; /parameters, /model
//   /axis, /through  [3] of the rotation, inertial axes
//   /rates           [rates] rad/s;  /displacement  [rates] m
//   /modes/names;    /modes/re_eigenvalue, im_eigenvalue, inertial_frequency, orbit, overlap, round_off  [rates, modes]:
//                    the columns of campbell.csv
//   /special/kind, rate, branch   critical speeds and limits of stability; branch: of /modes, counted from 0
//   /unbalance/places;  /unbalance/major, minor, lag, re_forward, … [rates, places]: the columns of unbalance.csv; and
//                    /force, which has the attribute order
//   /notes
// Groups without anything in them are left out. Throws Error, with the file, where it cannot be written.
void write_campbell(const std::filesystem::path& file, const CampbellStudy& study,
                    const Scene& scene);

}  // namespace mbd
