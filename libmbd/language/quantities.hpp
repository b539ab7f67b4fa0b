// What <record> can write: each quantity once, with its name, unit, axes, meaning and how it is read. The reader's checks,
// the manual, the columns of a run, what a moved scene makes of them and the theory of errors follow from these
// tables; a new quantity is one entry in quantities.cpp.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/section/failure.hpp"

namespace mbd::schema {

// A point of a section, of one material: strains and stresses from resultants (libmbd/section/stress.hpp).
struct SectionPointReading {
  Mat6 strain = Mat6::Zero(), stress = Mat6::Zero();
  section::Strengths strengths;
  double yield = 0.0;
};

// What quantities are read from. Of a place at a state, once for all quantities of a record, since it may have to be
// interpolated; zero where none of them needs it (Quantity::From), or there are no rates.
struct PlaceReading {
  Pose<double> start;  // reference configuration
  Pose<double> H;
  Vec6 V = Vec6::Zero(), Vdot = Vec6::Zero();          // own axes
  Vec6 resultants = Vec6::Zero();                      // of a flexible beam, section axes
  const SectionPointReading* section_point = nullptr;  // where the record has one
};
// Of others how compile reads them from a state. Functions are empty where there is none of that: Quantity::Of says
// where there is.
struct JointReading {
  bool rates = true;  // false without a transient
  std::function<double(const State&)> angle, displacement;
  std::function<Vec6(const State&)> relative_velocity, reaction;  // joint axes
};
struct SpringReading {
  std::function<double(const State&)> effort;  // tension, or moment or force of a joint spring
  std::function<Vec6(const State&)> wrench;    // of a bushing
  struct Length {
    double length, rate;
  };
  std::function<Length(const State&)> length;
};
struct SystemReading {
  const System* system = nullptr;
  bool rates = true;  // false without a transient
};

// Writes as many numbers as the quantity has components.
template <class Reading>
using SampleOf = void (*)(const Reading&, const State&, std::span<double>);

// Something <record> can write, and the columns it makes: name.quantity, or name.quantity.1 … .3.
struct Quantity {
  // What has it.
  enum class Of {
    any_place,
    beam_place,
    section_point,              // of a beam place
    section_point_of_plies,     // of a material with strengths along its axes
    section_point_that_yields,  // of an isotropic material with a yield stress
    any_joint,
    joint_with_angle,
    joint_with_displacement,
    spring,  // <spring>
    bushing,
    spring_of_angle,  // <joint_spring>
    spring_of_displacement,
    whole_system
  };
  // Axes of its components.
  enum class Axes { none, inertial, own, of_joint, of_bushing, of_ply };
  // What a rigid motion of the whole scene, R and a shift, makes of it; that of the axes of a joint, which may
  // follow inertial ones, comes on top of R.
  enum class Moved {
    unchanged,
    as_point,     // R x + shift
    as_vector,    // R x
    as_momentum,  // about the origin: R x + shift x R p, p the linear momentum
    as_potential  // plus what gravity's potential gains
  };
  // What it is read from, which tells what is needed and how its error falls.
  enum class From { pose, velocity, acceleration, strain };

  std::string_view name;
  std::string_view unit;
  int components;
  std::string_view doc;
  Of of;
  Axes axes;
  Moved moved;
  From from;
  std::variant<SampleOf<PlaceReading>, SampleOf<JointReading>, SampleOf<SpringReading>,
               SampleOf<SystemReading>>
      sample;
  bool is_integral = false;  // over time since the start: no function of poses and velocities

  constexpr bool of_section_point() const {
    return of == Of::section_point || of == Of::section_point_of_plies ||
           of == Of::section_point_that_yields;
  }
  // Its three components turn with the scene.
  constexpr bool turns() const {
    return moved == Moved::as_point || moved == Moved::as_vector || moved == Moved::as_momentum;
  }
};

// "inertial axes", "axes of the joint on b", …; "" of what has none.
std::string_view in_words(Quantity::Axes axes);

std::span<const Quantity> place_quantities();
std::span<const Quantity> joint_quantities();
std::span<const Quantity> spring_quantities();
std::span<const Quantity> system_quantities();
std::span<const Quantity> quantities_of(const RecordScene& record);  // of what it is of

// A resultant, of a place that is on no beam.
bool needs_beam(const RecordScene& record, const Quantity& quantity);

// nullptr when there is none.
const Quantity* find_quantity(std::span<const Quantity> quantities, std::string_view name);
std::vector<std::string_view> names(std::span<const Quantity> quantities);

// The record and the quantity of a column of results, "C.displacement.3"; null in both for columns of no record.
struct Recorded {
  const RecordScene* record = nullptr;
  const Quantity* quantity = nullptr;
};
Recorded recorded_in(const Scene& scene, std::string_view column);

}  // namespace mbd::schema
