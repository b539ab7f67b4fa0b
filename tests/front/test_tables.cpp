// Units and recorded quantities against tables written by hand: a wrong factor or unit is seen nowhere else.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "libmbd/language/quantities.hpp"
#include "libmbd/language/units.hpp"

namespace mbd::test::test_tables {
namespace {

// To SI units and rad, in twenty digits.
TEST(Tables, EveryWordOfAnAngle) {
  const std::map<std::string, double> factors = {
      {"deg", 0.017453292519943295769},         {"degree", 0.017453292519943295769},
      {"degrees", 0.017453292519943295769},     {"arc_degree", 0.017453292519943295769},
      {"arcdeg", 0.017453292519943295769},      {"°", 0.017453292519943295769},
      {"arc_minute", 2.9088820866572159615e-4}, {"arcminute", 2.9088820866572159615e-4},
      {"arcmin", 2.9088820866572159615e-4},     {"arc_second", 4.8481368110953599359e-6},
      {"arcsecond", 4.8481368110953599359e-6},  {"arcsec", 4.8481368110953599359e-6},
      {"rev", 6.2831853071795864769},           {"revolution", 6.2831853071795864769},
      {"turn", 6.2831853071795864769},          {"circle", 6.2831853071795864769},
      {"cycle", 6.2831853071795864769}};
  for (const auto& [word, factor] : factors) {
    EXPECT_DOUBLE_EQ(unit_factor(word, "rad"), factor) << word;
    EXPECT_DOUBLE_EQ(unit_factor(word + "/s", "rad/s"), factor) << word;
  }
  for (const char* word : {"rpm", "revolutions_per_minute"})
    EXPECT_DOUBLE_EQ(unit_factor(word, "rad/s"), 0.10471975511965977462) << word;
  EXPECT_DOUBLE_EQ(unit_factor("rps", "rad/s"), 6.2831853071795864769);
}

TEST(Tables, EveryUnitOfAQuantity) {
  const auto check = [](std::span<const schema::Quantity> quantities,
                        const std::map<std::string, std::pair<std::string, int>>& expected) {
    EXPECT_EQ(quantities.size(), expected.size()) << "a new quantity belongs into this table";
    for (const schema::Quantity& q : quantities) {
      const auto found = expected.find(std::string(q.name));
      ASSERT_NE(found, expected.end()) << q.name;
      EXPECT_EQ(q.unit, found->second.first) << q.name;
      EXPECT_EQ(q.components, found->second.second) << q.name;
    }
  };
  check(schema::place_quantities(), {{"position", {"m", 3}},
                                     {"displacement", {"m", 3}},
                                     {"displacement_local", {"m", 3}},
                                     {"rotation", {"rad", 3}},
                                     {"velocity", {"m/s", 3}},
                                     {"velocity_local", {"m/s", 3}},
                                     {"angular_velocity", {"rad/s", 3}},
                                     {"angular_velocity_local", {"rad/s", 3}},
                                     {"acceleration", {"m/s2", 3}},
                                     {"force", {"N", 3}},
                                     {"moment", {"N.m", 3}},
                                     {"ply_stress", {"Pa", 3}},
                                     {"ply_shear_stress", {"Pa", 3}},
                                     {"ply_strain", {"", 3}},
                                     {"ply_shear_strain", {"", 3}},
                                     {"von_mises", {"Pa", 1}},
                                     {"yield_index", {"", 1}},
                                     {"max_stress", {"", 1}},
                                     {"tsai_hill", {"", 1}},
                                     {"tsai_wu", {"", 1}},
                                     {"hashin", {"", 1}}});
  check(schema::joint_quantities(), {{"angle", {"rad", 1}},
                                     {"rate", {"rad/s", 1}},
                                     {"displacement", {"m", 1}},
                                     {"speed", {"m/s", 1}},
                                     {"reaction_force", {"N", 3}},
                                     {"reaction_moment", {"N.m", 3}}});
  check(schema::spring_quantities(), {{"tension", {"N", 1}},
                                      {"length", {"m", 1}},
                                      {"length_rate", {"m/s", 1}},
                                      {"force", {"N", 3}},
                                      {"moment", {"N.m", 3}},
                                      {"joint_moment", {"N.m", 1}},
                                      {"joint_force", {"N", 1}}});
  check(schema::system_quantities(), {{"linear_momentum", {"N.s", 3}},
                                      {"angular_momentum", {"N.m.s", 3}},
                                      {"kinetic_energy", {"J", 1}},
                                      {"strain_energy", {"J", 1}},
                                      {"potential_energy", {"J", 1}},
                                      {"total_energy", {"J", 1}},
                                      {"work_of_loads", {"J", 1}},
                                      {"work_of_drives", {"J", 1}},
                                      {"work_of_damping", {"J", 1}}});
}

}  // namespace
}  // namespace mbd::test::test_tables
