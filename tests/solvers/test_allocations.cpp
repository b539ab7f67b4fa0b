// Nothing is allocated while stepping: neither by operator new nor by malloc, which Eigen's arrays and
// SuiteSparse call. A full factorisation of KLU (the first after a start, and where pivots have become poor)
// makes its own arrays by malloc; the steps counted here have none, or the test says so.
#include <gtest/gtest.h>

#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "solvers/time/radau.hpp"
#include "tests/support/scenes.hpp"

#if MBD_SANITIZED
#define MBD_COUNTS_ALLOCATIONS 0  // the sanitizer has its own allocator
#else
#define MBD_COUNTS_ALLOCATIONS 1

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<bool> counting{false};
std::atomic<long> mallocs{0}, news{0};
}  // namespace

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  if (counting) ++mallocs;
  return __libc_malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (counting) ++news;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace mbd::test::test_allocations {
namespace {

#if MBD_COUNTS_ALLOCATIONS

struct Count {
  long news = 0, mallocs = 0;
};
template <class F>
Count count(const F& f) {
  news = mallocs = 0;
  counting = true;
  f();
  counting = false;
  return {news, mallocs};
}

TEST(Allocations, AreCounted) {
  const Count c = count([] {
    VecX x = VecX::Zero(100);
    auto* p = new std::array<double, 100>;
    volatile double y = x.sum() + static_cast<double>(reinterpret_cast<std::uintptr_t>(p) & 1);
    (void)y;
    delete p;
  });
  EXPECT_GE(c.news, 1);
  EXPECT_GE(c.mallocs, 2);
}

// With damping where no model has any.
Scene damped_scene(const std::string& name) {
  Scene scene = model_scene(name);
  if (name == "free_beam")
    scene.sections.front().damping = SectionDamping{{}, 1e-3, 0.1, Mat6::Zero()};
  return scene;
}

class AllocationFree : public testing::TestWithParam<const char*> {};
TEST_P(AllocationFree, Steps) {
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    Scene scene = damped_scene(GetParam());
    // one beam of each kind, where there are several
    if (scene.beams.size() > 1) scene.beams.back().kinematics = Kinematics::classical;
    const Model model = compile(scene);
    GeneralizedAlpha stepper(*model.system, make_klu_solver(),
                             {.step = scene.transient->step.value(),
                              .rho_infinity = rho_infinity_of(*scene.transient),
                              .balance = balance,
                              .newton = {}});
    State state = model.initial;
    ASSERT_TRUE(stepper.start(state).converged);
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(stepper.step(state).converged);
    const long tangents = stepper.counters().tangents;
    bool converged = true;
    const Count c = count([&] {
      for (int k = 0; k < 400; ++k) converged = converged && stepper.step(state).converged;
    });
    EXPECT_TRUE(converged);
    if (GetParam() != std::string_view("damped_oscillator")) {  // which is linear
      EXPECT_GT(stepper.counters().tangents, tangents);  // refactorisations are among the steps
    }
    EXPECT_EQ(c.news, 0);
    EXPECT_EQ(c.mallocs, 0);
  }
}

// Steps of Radau, fixed and adaptive, without an observer.
TEST_P(AllocationFree, RadauSteps) {
  const Scene scene = damped_scene(GetParam());
  for (const auto& [adaptive, stages] :
       {std::pair{false, 3u}, {true, 3u}, {true, 5u}, {true, 7u}}) {
    const Model model = compile(scene);
    RadauOptions options;
    options.stages = stages;
    if (adaptive) {
      options.tolerances.relative = 1e-5;
      // Beyond that of the model, which more stages may come to: a step after the end says so in words.
      options.end = 10.0 * scene.transient->duration;
      options.max_step = 0.05 * scene.transient->duration;
    } else {
      options.step = scene.transient->step.value();
    }
    Radau stepper(*model.system, make_klu_solver(), make_klu_pencil_solver(), options);
    State state = model.initial;
    ASSERT_TRUE(stepper.start(state).converged);
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(stepper.step(state).converged);
    const Counters before = stepper.counters();
    bool converged = true;
    const Count c = count([&] {
      for (int k = 0; k < 60; ++k) converged = converged && stepper.step(state).converged;
    });
    EXPECT_TRUE(converged);
    RecordProperty((adaptive ? "adaptive_" : "fixed_") + std::to_string(stages),
                   std::to_string(stepper.counters().factorizations - before.factorizations));
    EXPECT_EQ(c.news, 0) << adaptive << " " << stages;
    EXPECT_EQ(c.mallocs, 0) << adaptive << " " << stages;
  }
}

// Nor by steps that an observer samples, with the solvers that models get. (Radau: two vectors a step, for HermiteStep's inner
// multipliers.)
TEST_P(AllocationFree, StepsThatAreSampled) {
  const Scene scene = damped_scene(GetParam());
  const Model model = compile(scene);
  const double h = scene.transient->step.value();
  const auto solver = [] {
    return make_linear_solver(LinearMethod::block, PivotOrder::nodes_first);
  };
  const auto pencil = [] { return make_pencil_solver(LinearMethod::block); };
  GeneralizedAlpha alpha(*model.system, solver(), {.step = h, .newton = {}});
  Radau radau(*model.system, solver(), pencil(), {.step = h});
  Radau seven(*model.system, solver(), pencil(), {.step = h, .stages = 7});
  for (Stepper* const stepper : std::initializer_list<Stepper*>{&alpha, &radau, &seven}) {
    State state = model.initial, dense = state;
    stepper->on_substep(
        [&](const DenseStep& step) { step.at(0.5 * (step.begin() + step.end()), dense); });
    ASSERT_TRUE(stepper->start(state).converged);
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(stepper->step(state).converged);
    bool converged = true;
    const Count c = count([&] {
      for (int k = 0; k < 20; ++k) converged = converged && stepper->step(state).converged;
    });
    EXPECT_TRUE(converged);
    const char* const name = stepper == &alpha   ? "generalized-alpha"
                             : stepper == &radau ? "radau"
                                                 : "seven stages";
    EXPECT_EQ(c.news, 0) << name;
    EXPECT_EQ(c.mallocs, 0) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Models, AllocationFree,
                         testing::Values("four_bar", "shaft", "heavy_top", "free_beam",
                                         "damped_oscillator"),
                         [](const auto& model) { return std::string(model.param); });

// What the models above do not have: drag along a beam and at a place, still and flowing, added mass, a moving base,
// inertia without gyroscopic moments.
TEST(Allocations, StepsInAFluid) {
  Scene scene =
      read_model(std::filesystem::path(MBD_SOURCE_DIR) / "tests/bad_models/good/diver.xml");
  scene.gravity = Gravity{{}, Vec3(0, 0, -9.81)};
  for (const InertiaTerms inertia : {InertiaTerms::full, InertiaTerms::no_gyroscopic}) {
    scene.transient->inertia = inertia;
    const Model model = compile(scene);
    GeneralizedAlpha alpha(*model.system, make_klu_solver(), {.step = 1e-3, .newton = {}});
    GeneralizedAlpha momenta(
        *model.system, make_klu_solver(),
        {.step = 1e-3, .rho_infinity = 0.9, .balance = Balance::momentum, .newton = {}});
    Radau radau(*model.system, make_klu_solver(), make_klu_pencil_solver(), {.step = 1e-3});
    for (Stepper* const stepper : std::initializer_list<Stepper*>{&alpha, &momenta, &radau}) {
      if (stepper == &momenta && inertia != InertiaTerms::full) continue;
      State state = model.initial;
      ASSERT_TRUE(stepper->start(state).converged);
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(stepper->step(state).converged);
      bool converged = true;
      const Count c = count([&] {
        for (int k = 0; k < 100; ++k) converged = converged && stepper->step(state).converged;
      });
      EXPECT_TRUE(converged);
      EXPECT_EQ(c.news, 0);
      EXPECT_EQ(c.mallocs, 0);
    }
  }
}

#else
TEST(Allocations, AreCountedWithoutSanitizersOnly) {
  GTEST_SKIP() << "the sanitizer has its own allocator";
}
#endif

}  // namespace
}  // namespace mbd::test::test_allocations
