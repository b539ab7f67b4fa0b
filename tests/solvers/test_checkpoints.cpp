// A stepper that is saved and restored goes on to the last bit; one that goes back takes a step again.
//
// Tried in the library, and killed: tangents kept by save(), and by restore(); pivots kept by either method; another model's
// checkpoint taken; of what generalized-alpha archives, h_, A_, history_, t_old_, t_older_, Vdot_old_ left out. Not told apart by
// these ways: kept_ (which go_back() alone needs) and stiffness_ (which a step of another size would use).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/time/ida.hpp"
#include "solvers/time/stepper.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_checkpoints {
namespace {

// Every number of a state, as bits.
std::vector<char> bits(const State& state) {
  State copy = state;
  Archive a;
  a(copy);
  return a.take();
}

struct Way {
  const char *name, *model, *method;
  double step, tolerance, rho;
  int before, after;  // steps
  const char* balance = "";
  std::optional<StageCount> stages = {};
};

class CheckpointsOfMethods : public testing::TestWithParam<Way> {
 protected:
  static Scene scene_of(const Way& way) {
    Scene scene = model_scene(way.model);
    TransientScene& transient = *scene.transient;
    transient.method =
        std::string(way.method) == "radau" ? TimeMethod::radau : TimeMethod::generalized_alpha;
    transient.step.reset();
    transient.tolerance.reset();
    transient.rho_infinity.reset();
    transient.balance.reset();
    if (way.step > 0.0)
      transient.step = way.step;
    else
      transient.tolerance = way.tolerance;
    if (transient.method == TimeMethod::generalized_alpha) transient.rho_infinity = way.rho;
    if (way.balance[0] != '\0') transient.balance = Balance::momentum;
    transient.stages = way.stages;
    return scene;
  }
};

void take(Stepper& stepper, State& state, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport report = stepper.step(state);
    ASSERT_TRUE(report.converged) << report.failure;
  }
}

TEST_P(CheckpointsOfMethods, GoOnToTheLastBit) {
  const Way& way = GetParam();
  const Scene scene = scene_of(way);
  const Model model = compile(scene);
  const std::unique_ptr<Stepper> stepper = make_stepper(*model.system, *scene.transient);
  State state = start_of(scene, model);
  ASSERT_TRUE(stepper->start(state).converged);
  take(*stepper, state, way.before);
  const Checkpoint saved = stepper->save(state);
  const State there = state;
  take(*stepper, state, way.after);

  // In a model compiled anew, whose stepper has not been started.
  const Model again = compile(scene);
  const std::unique_ptr<Stepper> other = make_stepper(*again.system, *scene.transient);
  State restored;
  other->restore(saved, restored);
  EXPECT_EQ(bits(restored), bits(there));
  take(*other, restored, way.after);
  EXPECT_EQ(bits(restored), bits(state));
  EXPECT_EQ(other->counters().iterations, stepper->counters().iterations);
  EXPECT_EQ(other->counters().factorizations, stepper->counters().factorizations);
  EXPECT_EQ(other->counters().steps, way.before + way.after);

  // And in the stepper itself, which has gone on since.
  State back;
  stepper->restore(saved, back);
  take(*stepper, back, way.after);
  EXPECT_EQ(bits(back), bits(state));
}

INSTANTIATE_TEST_SUITE_P(
    Ways, CheckpointsOfMethods,
    testing::Values(Way{"alpha", "double_pendulum", "", 5e-3, 0.0, 0.8, 37, 60},
                    Way{"alpha_adaptive", "double_pendulum", "", 0.0, 1e-4, 0.8, 37, 60},
                    Way{"alpha_momenta", "free_beam", "", 1e-3, 0.0, 0.6, 20, 30, "momentum"},
                    Way{"alpha_beams", "four_bar", "", 9e-3, 0.0, 0.6, 50, 30},
                    Way{"alpha_at_the_start", "four_bar", "", 9e-3, 0.0, 0.6, 0, 30},
                    Way{"radau_at_the_start", "four_bar", "radau", 0.0, 1e-4, 0.0, 0, 20},
                    Way{"alpha_rings", "chain", "", 5e-3, 0.0, 1.0, 30, 40},
                    Way{"alpha_redundant", "windows", "", 1e-3, 0.0, 0.9, 40, 40},
                    Way{"radau", "double_pendulum", "radau", 1e-2, 0.0, 0.0, 37, 60},
                    Way{"radau_adaptive", "double_pendulum", "radau", 0.0, 1e-6, 0.0, 37, 60, "",
                        StageCount::three},
                    Way{"radau_beams", "four_bar", "radau", 0.0, 1e-4, 0.0, 30, 30},
                    // In the first trial of other stages, and before it.
                    Way{"radau_auto", "double_pendulum", "radau", 0.0, 1e-6, 0.0, 19, 60, "",
                        StageCount::automatic},
                    Way{"radau_seven", "heavy_top", "radau", 0.0, 1e-8, 0.0, 20, 20, "",
                        StageCount::seven}),
    [](const auto& of) { return std::string(of.param.name); });

const std::string driven = R"(<input name="u"/>
  <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="4"/>
  <revolute name="r" between="ground b.start" axis="0 1 0"/>
  <joint_spring name="js" joint="r" angular_stiffness="40" angular_damping="1"/>
  <load at="b.end" force="0 0 u"/>
  <record name="b" at="b.end" quantities="displacement"/>)";

// A step taken again with other inputs is that of a stepper which had them at once; and costs no new tangent.
TEST(Checkpoints, GoBackForOtherInputs) {
  for (const char* method : {"generalized_alpha", "radau"}) {
    SCOPED_TRACE(method);
    const Scene scene =
        read(driven + fmt::format(R"(<transient duration="1" step="2e-3" method="{}"/>)", method));
    const Model model = compile(scene);
    const auto advance = [&](Stepper& stepper, State& state, double u) {
      state.inputs[0].ramp(u, state.t, state.t + 2e-3);  // of a coupling that is iterated
      take(stepper, state, 1);
    };
    const auto law = [](int k) { return 20.0 * std::sin(0.1 * k); };
    const auto plain = make_stepper(*model.system, *scene.transient),
               iterated = make_stepper(*model.system, *scene.transient);
    State once = model.initial, often = model.initial;
    ASSERT_TRUE(plain->start(once).converged);
    ASSERT_TRUE(iterated->start(often).converged);
    long most = 0;
    for (int k = 1; k <= 100; ++k) {
      const long before = iterated->counters().factorizations;
      const Checkpoint here = iterated->remember(often);
      for (const double off : {3.0, -1.0, 0.4, 0.02, 0.0}) {
        iterated->go_back(here, often);
        advance(*iterated, often, law(k) + off);
      }
      most = std::max(most, iterated->counters().factorizations - before);
      advance(*plain, once, law(k));
    }
    for (std::size_t n = 0; n < once.pose.size(); ++n) {
      EXPECT_LT((once.pose[n].r - often.pose[n].r).norm(), 1e-8) << n;
      EXPECT_LT((once.V[n] - often.V[n]).norm(), 1e-5) << n;
    }
    EXPECT_EQ(iterated->counters().steps, plain->counters().steps);
    EXPECT_GT((once.pose.back().r - model.initial.pose.back().r).norm(), 0.01);
  }
}

std::string why_not(Stepper& stepper, const Checkpoint& checkpoint) {
  State state;
  try {
    stepper.restore(checkpoint, state);
  } catch (const Error& error) {
    return error.what();
  }
  return "restored";
}

TEST(Checkpoints, AreOfOneModelAndMethod) {
  const auto transient = [](const std::string& of) {
    return "<transient duration=\"1\" " + of + "/>";
  };
  const Scene scene = read(driven + transient(R"(step="1e-3")"));
  const Model model = compile(scene);
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State state = model.initial;
  EXPECT_THROW(stepper->save(state), Error);  // not started
  ASSERT_TRUE(stepper->start(state).converged);
  take(*stepper, state, 3);
  const Checkpoint saved = stepper->save(state);
  EXPECT_THROW(stepper->save(model.initial), Error);  // not the state that it has reached
  EXPECT_EQ(why_not(*stepper, saved), "restored");

  for (const std::string other :
       {R"(step="2e-3")", R"(tolerance="1e-4")", R"(step="1e-3" method="radau")",
        R"(step="1e-3" rho_infinity="0.3")"}) {
    const Scene differs = read(driven + transient(other));
    EXPECT_SAYS(why_not(*make_stepper(*model.system, *differs.transient), saved), "and this is")
        << other;
  }
  // Of another stiffness, density, spring, or name of an input.
  for (const auto& [from, to] : {std::pair{"EI2=\"100\"", "EI2=\"101\""},
                                 {"per_length=\"1.2\"", "per_length=\"1.21\""},
                                 {"angular_damping=\"1\"", "angular_damping=\"2\""},
                                 {"elements=\"4\"", "elements=\"5\""}}) {
    std::string text = driven;
    text.replace(text.find(from), std::strlen(from), to);
    const Scene differs = read(text + transient(R"(step="1e-3")"));
    const Model of = compile(differs);
    EXPECT_SAYS(why_not(*make_stepper(*of.system, *differs.transient), saved), "another model")
        << to;
  }
  // Cut off anywhere, or longer.
  for (std::size_t size = 0; size < saved.bytes.size(); size += 1 + size / 7) {
    const Checkpoint cut{
        {saved.bytes.begin(), saved.bytes.begin() + static_cast<std::ptrdiff_t>(size)}};
    EXPECT_SAYS(why_not(*stepper, cut), "damaged") << size;
  }
  Checkpoint longer = saved;
  longer.bytes.push_back('\0');
  EXPECT_SAYS(why_not(*stepper, longer), "damaged");
  Checkpoint flipped = saved;
  flipped.bytes[flipped.bytes.size() / 2] ^= 4;
  EXPECT_SAYS(why_not(*stepper, flipped), "damaged");
  EXPECT_EQ(why_not(*stepper, saved), "restored");
  take(*stepper, state, 0);

  const Scene ida_scene = read(driven + transient(R"(tolerance="1e-4" method="ida")"));
  const auto ida = make_stepper(*model.system, *ida_scene.transient);
  State own = model.initial;
  ASSERT_TRUE(ida->start(own).converged);
  try {
    ida->save(own);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_SAYS(std::string(error.what()), "start() from it");
  }
}

}  // namespace
}  // namespace mbd::test::test_checkpoints
