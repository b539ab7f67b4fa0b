// Ablations change what they say and nothing else; the study finds their worth in closed form, and the cheapest model
// it suggests keeps its tolerance when it is run.
#include "libmbd/study/effects/effects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libmbd/compile/loads.hpp"
#include "libmbd/study/effects/effects_report.hpp"
#include "tests/support/machine.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_effects {
namespace {

Scene scene_of(const std::string& items) {
  return read_model_text("<mbd name=\"m\">" + items + "</mbd>", "m.xml");
}

// Tip force F across a cantilever: u = F L^3/3EI + F L/GA, of which the second part is that of shear; 3EI/(GA L^2) of the
// first = 0.0375. An axial force far below any effect on bending.
const std::string cantilever =
    R"(<section name="s"><stiffness EA="1e6" GA2="4e4" GA3="4e4" GJ="300" EI2="500" EI3="500"/>
         <mass per_length="1" inertia="1e-3 1e-3 1e-3"/></section>
       <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
       <fixed name="root" between="ground b.start"/>
       <load name="push" at="b.end" force="0 0 1e-3"/> <load at="b.end" force="0 1e-6 0"/> <static/>
       <record name="tip" at="b.end" quantities="displacement"/>
       <record name="mid" at="b@0.5" quantities="moment"/>)";

std::vector<std::string> keys_of(const Scene& scene) {
  std::vector<std::string> keys;
  for (const Ablation& a : ablations_of(scene)) keys.push_back(a.key);
  return keys;
}

TEST(Ablation, NamesWhatTheSceneHas) {
  EXPECT_EQ(keys_of(scene_of(cantilever)),
            (std::vector<std::string>{"rigid:b", "axial", "shear", "load:push", "load:load2"}));
  EXPECT_EQ(keys_of(model_scene("heavy_top")), (std::vector<std::string>{"gyroscopic", "gravity"}));
  const std::vector<std::string> shaft = keys_of(model_scene("shaft"));
  for (const char* const key : {"rigid:shaft", "D14:tube", "rotary_inertia", "gravity"})
    EXPECT_EQ(std::count(shaft.begin(), shaft.end(), key), 1) << key;
}

// Infinite where the beams of a section know it, without couplings; elsewhere by a factor that its name says. What is infinite
// already cannot be left out.
TEST(Ablation, OfStiffnesses) {
  Scene scene = scene_of(cantilever);
  scene.sections[0].stiffness(0, 5) = scene.sections[0].stiffness(5, 0) = 100.0;
  const auto ablation = [](const Scene& of, const std::string& key) {
    for (const Ablation& a : ablations_of(of))
      if (a.key == key) return a;
    return Ablation{};
  };
  EXPECT_EQ(ablation(scene, "axial").effect, "axial flexibility");
  EXPECT_NE(ablation(scene, "axial").change.find("EA=\"inf\" …/> without their couplings"),
            std::string::npos)
      << ablation(scene, "axial").change;
  const Scene held = without(scene, std::vector<std::string>{"axial"});
  EXPECT_TRUE(std::isinf(held.sections[0].stiffness(0, 0)));
  EXPECT_EQ(held.sections[0].stiffness(0, 5), 0.0);
  EXPECT_EQ(ablation(held, "axial").key, "");
  EXPECT_EQ(ablation(held, "shear").key, "shear");
  scene.beams[0].kinematics = Kinematics::classical;
  EXPECT_EQ(ablation(scene, "axial").effect, "axial flexibility (stiffened 1000 times)");
  EXPECT_NEAR(without(scene, std::vector<std::string>{"axial"}).sections[0].stiffness(0, 0), 1e9,
              1.0);
}

// Critical over the longest beam: c = 2 EA/omega, omega = pi/L sqrt(EA/m).
TEST(Ablation, OfAxialWaves) {
  std::string moving = cantilever;
  moving.replace(moving.find("<static/>"), 9, "<transient duration=\"1\" step=\"0.1\"/>");
  const Scene scene = scene_of(moving),
              damped = without(scene, std::vector<std::string>{"axial_waves"});
  ASSERT_TRUE(damped.sections[0].damping.has_value());
  const Mat6& C = damped.sections[0].damping->viscous;
  EXPECT_NEAR(C(0, 0), 2.0 * 1e6 / (std::numbers::pi * std::sqrt(1e6)), 1e-9);
  EXPECT_EQ(C.cwiseAbs().sum(), C(0, 0));
}

TEST(Ablation, OfWhatIsNotThereIsRefused) {
  const std::vector<std::string> keys{"gravty"};
  try {
    without(model_scene("heavy_top"), keys);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("gravity"), std::string::npos) << error.what();
  }
}

TEST(Ablation, OfRotaryInertiaKeepsMassAndCentre) {
  const Scene scene = model_scene("slider_crank");
  const Scene less = without(scene, std::vector<std::string>{"rotary_inertia"});
  for (std::size_t i = 0; i < scene.sections.size(); ++i) {
    if (!scene.sections[i].mass) continue;
    const Mat6 a = *scene.sections[i].mass, b = *less.sections[i].mass;
    EXPECT_EQ((a.topRows<3>()), (b.topRows<3>()));
    EXPECT_LT(b(3, 3), a(3, 3));
  }
}

const EffectRun& run_of(const EffectsStudy& study, const std::string& key) {
  return *std::find_if(study.runs.begin(), study.runs.end(),
                       [&](const EffectRun& r) { return r.ablation.key == key; });
}

TEST(Effects, OfACantileverAreThoseOfTheClosedForm) {
  const EffectsStudy study =
      study_effects(scene_of(cantilever), {.tolerance = 1e-3, .budget = no_limit});
  ASSERT_EQ(study.quantities.size(), 2u);
  ASSERT_EQ(study.quantities[0].name, "tip.displacement");
  const double bending = 1.0 / 1500.0, shear = 1.0 / 4e4, whole = bending + shear;
  const auto change = [&](const std::string& key, std::size_t q = 0) {
    const EffectRun& run = run_of(study, key);
    EXPECT_TRUE(run.complete()) << run.trial.failure;
    EXPECT_TRUE(run.changes[q].known);
    return run.changes[q].rms;
  };
  // To the nonlinear part of the deflection (squared, 1e-12).
  EXPECT_NEAR(change("shear"), shear / whole, 1e-6);
  EXPECT_LT(change("axial"), 1e-6);
  EXPECT_NEAR(change("load:push"), 1.0, 1e-5);  // the other load is a thousandth
  EXPECT_NEAR(change("load:load2"), 1e-3, 1e-8);
  EXPECT_NEAR(change("rigid:b"), 1.0, 1e-12);
  // What a rigid beam has no longer is told, and keeps it out of the cheapest model.
  EXPECT_FALSE(run_of(study, "rigid:b").changes[1].known);
  EXPECT_FALSE(run_of(study, "rigid:b").keeps_all());
  for (const std::size_t i : study.cheapest.left_out) {
    EXPECT_NE(study.runs[i].ablation.key, "shear") << "its change is 3.6e-2";
    EXPECT_NE(study.runs[i].ablation.key, "rigid:b");
  }
}

// A beam that hardly bends swings as a rigid one does: that is found, saves most of the time, and keeps the tolerance in
// a run of its own.
TEST(EffectsSlow, TheCheapestModelKeepsItsTolerance) {
  const Scene scene = scene_of(
      R"(<section name="s"><stiffness EA="1e7" GA2="4e6" GA3="4e6" GJ="3e4" EI2="5e4" EI3="5e4"/>
           <mass per_length="1" inertia="1e-3 1e-3 1e-3"/></section>
         <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4" order="3"/>
         <revolute name="pin" between="ground b.start" axis="0 1 0"/> <gravity acceleration="0 0 -9.81"/>
         <transient duration="1" step="0.002"/>
         <record name="tip" at="b.end" quantities="position"/> <record name="pin" joint="pin" quantities="angle"/>)");
  const EffectsStudy study = study_effects(scene, {.tolerance = 1e-3, .budget = no_limit});
  const CheapestModel& cheapest = study.cheapest;
  ASSERT_FALSE(cheapest.left_out.empty());
  EXPECT_EQ(study.runs[cheapest.left_out.front()].ablation.key, "rigid:b") << "the dearest";
  EXPECT_TRUE(cheapest.verified);
  EXPECT_LE(cheapest.worst(), 1e-3);
  EXPECT_LT(cheapest.cpu.median(), 0.5);
  EXPECT_GT(run_of(study, "gravity").worst(), 0.1);
  // Again, without the study: rms of the tip over its largest length, at the ends of all steps.
  std::vector<std::string> keys;
  for (const std::size_t i : cheapest.left_out) keys.push_back(study.runs[i].ablation.key);
  const Table a = run_to_table(scene).table, b = run_to_table(without(scene, keys)).table;
  double sum = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < a.columns[0].size(); ++k) {
    double d = 0.0, size = 0.0;
    for (const char* const c : {"tip.position.1", "tip.position.2", "tip.position.3"}) {
      d += std::pow(a[c][k] - b[c][k], 2);
      size += std::pow(a[c][k], 2);
    }
    sum += d;
    largest = std::max(largest, std::sqrt(size));
  }
  EXPECT_LE(std::sqrt(sum / static_cast<double>(a.columns[0].size())) / largest, 1e-3);

  const std::string text = to_text(study), csv = to_csv(study), page = effects_page(study);
  EXPECT_NE(text.find("<rigid name=\"b_rigid\" of=\"b\"/>"), std::string::npos) << text;
  EXPECT_NE(text.find("--without rigid:b"), std::string::npos) << text;
  EXPECT_NE(csv.find("\nrigid:b,"), std::string::npos);
  EXPECT_NE(page.find("\\u003csvg"), std::string::npos);
  EXPECT_EQ(page.find("http:", page.find("<body")), page.find("http://www.w3.org/2000/svg"));
  EXPECT_NE(to_json(study).find("\"verified\": true"), std::string::npos);
}

TEST(EffectsSlow, OfALongModelAreThoseOfItsBeginning) {
  Scene scene = model_scene("double_pendulum");
  scene.transient->duration = 4000.0;
  scene.transient->step.reset();
  scene.transient->method = TimeMethod::radau;
  scene.transient->rho_infinity.reset();
  scene.transient->balance.reset();
  scene.transient->newton_tolerance.reset();
  scene.transient->tolerance = 1e-6;
  // So much that a run may take as long as a fortieth of the whole does, here and now: each has its share of the budget.
  Scene beginning = scene;
  beginning.transient->duration /= 40.0;
  const Trial part = run_trial(beginning, {.repeats = 1});
  ASSERT_TRUE(part.complete) << part.failure;
  const double shares = 3.0 * static_cast<double>(ablations_of(scene).size()) + 4.0;
  std::atomic<bool> stop = false;
  EffectsOptions options{.budget = part.cpu * shares};
  options.interrupted = &stop;
  options.progress = [&](const std::string& what, std::size_t, std::size_t) {
    if (what.find("without") != std::string::npos) stop = true;  // what comes then is known
  };
  const EffectsStudy study = study_effects(scene, options);
  EXPECT_LT(study.end, study.whole_end);
  EXPECT_GT(study.end, 0.0);
  ASSERT_FALSE(study.notes.empty());
  EXPECT_NE(study.notes.front().find("the budget"), std::string::npos);
  EXPECT_TRUE(study.interrupted);
}

TEST(Effects, OfWhatDoesNotRunAreRefused) {
  Scene scene = scene_of(cantilever);
  scene.records.clear();
  EXPECT_THROW(study_effects(scene, {}), Error);
  EXPECT_THROW(study_effects(scene_of(cantilever), {.tolerance = 0.0}), Error);
}

}  // namespace
}  // namespace mbd::test::test_effects
