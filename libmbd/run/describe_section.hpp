// What a section is worth: D, M, its centres and principal axes, and how well they are known. mbd section prints it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// A section, or one station of it. Points are (x2, x3) [m], angles from b2 towards b3 [rad].
struct SectionReport {
  std::string section;
  std::optional<double> at;  // of a station
  std::string from;          // what stated it: a shape or matrices, and where
  Mat6 stiffness = Mat6::Zero();
  std::optional<Mat6> mass;
  std::optional<ShapeFound> found;  // where D and M were computed from a shape

  std::optional<std::array<double, 2>> mass_centre;
  std::array<double, 2> tension_centre{};  // a force N1 there causes no curvature
  std::array<double, 2> shear_centre{};    // forces Q2, Q3 at the section there cause no twist
  // Of bending by moments alone, which does not depend on the reference line: the larger and the smaller stiffness
  // [N m^2], and the angle of the axis about which it is the larger, in (-pi/2, pi/2].
  std::array<double, 2> bending{};
  double bending_axis = 0.0;
  // Stiffness against Q2 and Q3 at the shear centre [N]; over G A of a section of one isotropic material: its shear
  // coefficients.
  std::array<double, 2> shear{};
  std::optional<std::array<double, 2>> shear_coefficients;
};

// Of the section of that name, or (empty) of all of them, stations one by one. Throws Error where there is none.
std::vector<SectionReport> describe_sections(const Scene& scene, const std::string& name = {});

std::string to_text(const SectionReport& report);
std::string to_json(const std::vector<SectionReport>& reports);
// A row for each row of a matrix: section, at, matrix (D, error, M), row, six columns.
std::string to_csv(const std::vector<SectionReport>& reports);

}  // namespace mbd
