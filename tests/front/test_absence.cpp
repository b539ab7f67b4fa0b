// An effect that a scene does not state costs nothing: the batches of scenes that name none of the terms that came
// later are, to the byte, those of the commit before any of them was written (f49cfbd, 22 November 2026). A regression
// test by its nature. Allocations while stepping: tests/solvers/test_allocations.cpp; instructions: tools/instructions.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/scenes.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_absence {
namespace {

struct BatchSize {
  std::string type;
  Index size;
  std::size_t bytes;  // of data, indices and slots
  bool operator==(const BatchSize&) const = default;
};
void PrintTo(const BatchSize& batch, std::ostream* out) {
  *out << batch.type << ": " << batch.size << ", " << batch.bytes << " bytes";
}

struct Before {
  std::string model;
  Index unknowns;
  std::vector<BatchSize> batches;
};

void PrintTo(const Before& before, std::ostream* out) { *out << before.model; }

const Before all_before[] = {
    {"four_bar",
     183,
     {{"inertia", 27, 7884},
      {"revolute", 4, 2976},
      {"driven rotation", 1, 744},
      {"beam elastic, geodesic, energy form, N = 3, Gauss", 8, 3520}}},
    {"shaft",
     160,
     {{"inertia", 25, 7300},
      {"gravity", 25, 900},
      {"revolute", 1, 744},
      {"driven rotation", 1, 744},
      {"cylindrical", 1, 744},
      {"beam elastic, geodesic, energy form, N = 3, Gauss", 8, 3520}}},
    {"chain", 90, {{"inertia", 10, 2920}, {"gravity", 10, 360}, {"spherical", 10, 7440}}},
    {"heavy_top", 9, {{"inertia", 1, 292}, {"gravity", 1, 36}, {"spherical", 1, 744}}},
    {"every_joint",  // its fixed joint is fused
     172,
     {{"inertia", 19, 5548},
      {"gravity", 19, 684},
      {"screw", 1, 744},
      {"driven rotation", 3, 2232},
      {"prismatic", 1, 744},
      {"driven translation", 2, 1488},
      {"revolute", 1, 744},
      {"cylindrical", 1, 744},
      {"universal", 1, 744},
      {"rigid_link", 1, 744},
      {"spherical", 2, 1488},
      {"distance", 1, 744},
      {"planar", 1, 744},
      {"point_on_line", 1, 744},
      {"prescribed translation", 2, 1488},
      {"prescribed rotation", 2, 1488},
      {"beam elastic, geodesic, energy form, N = 3, Gauss", 2, 880}}},
    {"bend45",
     204,
     {{"dead load", 1, 36},
      {"fixed", 1, 744},
      {"beam elastic, geodesic, energy form, N = 4, Gauss", 8, 5664}}},
    {"four_bar_static",
     369,
     {{"dead load", 1, 36},
      {"revolute", 3, 2232},
      {"fixed", 1, 744},
      {"beam elastic, geodesic, energy form, N = 5, Gauss", 11, 11968}}},
};

class Absence : public ::testing::TestWithParam<Before> {};

TEST_P(Absence, CostsNothing) {
  if (!fixed_orders()) GTEST_SKIP() << "the sizes are those of kernels of fixed order";
  const Before& before = GetParam();
  const Model model = compile(model_scene(before.model));
  EXPECT_EQ(model.system->unknowns(), before.unknowns);
  std::vector<BatchSize> now;
  for (const auto& batch : model.system->batches())
    now.push_back({std::string(batch->type()), batch->size(), batch->bytes()});
  ASSERT_EQ(now.size(), before.batches.size()) << testing::PrintToString(now);
  // Constants stand once more in packs, as wide as the processor's registers, the last of them filled up.
  for (std::size_t i = 0; i < now.size(); ++i) {
    constexpr std::size_t widest = 8;
    const BatchSize& then = before.batches[i];
    EXPECT_EQ(now[i].type, then.type);
    EXPECT_EQ(now[i].size, then.size);
    EXPECT_LE(now[i].bytes,
              2 * then.bytes + widest * then.bytes / static_cast<std::size_t>(then.size))
        << testing::PrintToString(now[i]);
  }
}
INSTANTIATE_TEST_SUITE_P(Every, Absence, ::testing::ValuesIn(all_before),
                         [](const auto& one) { return one.param.model; });

// Statics have no rates, nor what needs them.
TEST(AbsenceOfRates, InStatics) {
  for (const char* const name : {"bend45", "arch", "four_bar_static"}) {
    const Model model = compile(model_scene(name));
    EXPECT_FALSE(model.system->with_rates()) << name;
    EXPECT_TRUE(model.initial.V.empty()) << name;
    EXPECT_TRUE(model.initial.Vdot.empty()) << name;
    for (const auto& batch : model.system->batches()) EXPECT_NE(batch->type(), "inertia") << name;
  }
}

}  // namespace
}  // namespace mbd::test::test_absence
