// How far sections are from failure: failure indices and stresses over a section that is stated by material, from its
// resultants. mbd section --stress prints it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/scene/scene.hpp"
#include "libmbd/section/stress.hpp"

namespace mbd {

// Resultants [N1 Q2 Q3 M1 M2 M3] about the reference line, section axes [N, N m]; of a run the time or load factor as well.
struct SectionLoad {
  std::optional<double> at;
  Vec6 resultants = Vec6::Zero();
};

struct StressReport {
  std::string section;
  std::size_t loads = 0;
  std::string at_name = {};  // what `at` is
  // The largest of a quantity over the section and all loads.
  struct Largest {
    std::string quantity, unit;  // a failure index, or the largest absolute value of a stress [Pa]
    double value = 0.0;
    std::array<double, 2> point{};  // x2, x3 [m]
    std::string where;              // ply or element
    SectionLoad load;
    Vec6 stress = Vec6::Zero();  // there, [LL TT NN TN LN LT]
    // The same on the mesh before (coarser by one), of the same load. Where it is much less, stresses are singular.
    double before = 0.0;
  };
  std::vector<Largest> largest;
  std::vector<double> times;                 // `at` of the loads, if they have any
  std::vector<std::vector<double>> history;  // by load, then as `largest`
};

// Names of what is looked at: failure indices, von_mises, and the components LL TT NN TN LN LT.
std::vector<std::string_view> stress_quantities();
// Its unit: Pa, or none of a failure index.
std::string_view stress_quantity_unit(std::string_view quantity);
// Its value for a stress [LL TT NN TN LN LT] of a material, components with their sign; nothing where the material lacks the
// strengths that it is of.
std::optional<double> stress_quantity(std::string_view quantity,
                                      const section::MeshMaterial& material, const Vec6& stress);

// Of a section of one shape, or (`station`: place along the beam) of one of its stations. Throws Error where there is no such
// section or it has no shape.
StressReport describe_stress(const Scene& scene, const std::string& section,
                             std::optional<double> station, std::span<const SectionLoad> loads);

// Stresses and strains at a point. Throws Error where it lies outside or between plies.
struct PointStress {
  std::array<double, 2> point{};
  std::string where;
  Mat3 axes;            // L T N as columns along b1 b2 b3
  Vec6 stress, strain;  // [LL TT NN TN LN LT]
  std::vector<std::pair<std::string, double>> indices;
};
PointStress describe_point(const Scene& scene, const std::string& section,
                           std::optional<double> station, const SectionLoad& load,
                           const std::array<double, 2>& point);

std::string to_text(const StressReport& report);
std::string to_text(const PointStress& point);
std::string to_json(const StressReport& report);
std::string to_json(const PointStress& point);
// A row for each load: what it is at, and the largest of each quantity over the section.
std::string to_csv(const StressReport& report);

// The shape of that section or station; `name` becomes that of the only section where it is empty.
const SectionShape& shape_of_section(const Scene& scene, std::string& name,
                                     std::optional<double> station);

}  // namespace mbd
