// Knobs of accuracy: what a setting changes of a scene, how it is written, and lists of values.
#include "libmbd/study/trial/setting.hpp"

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

namespace mbd::test::test_setting {
namespace {

std::string message_of(const std::string& text) {
  Variations variations;
  try {
    add_variation(variations, text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Setting, ChangesAllBeamsAndKeepsTheProportionOfElements) {
  const Scene scene = model_scene("four_bar");  // 2, 4 and 2 elements
  const Scene varied = mbd::with(scene, {.order = 6, .elements = 3, .metric = Metric::matrix});
  ASSERT_EQ(varied.beams.size(), 3u);
  const std::vector<int> expected{3, 6, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(varied.beams[i].elements, expected[i]);
    EXPECT_EQ(varied.beams[i].order, 6);
    EXPECT_EQ(varied.beams[i].metric, Metric::matrix);
    EXPECT_EQ(varied.beams[i].form, scene.beams[i].form);
  }
  EXPECT_EQ(mbd::with(scene, {.elements = 1}).beams[1].elements, 2);
  EXPECT_EQ(*mbd::with(scene, {}).transient->step, *scene.transient->step);
}

TEST(Setting, OfTimeDropsWhatDoesNotGoWithIt) {
  const Scene scene = model_scene("free_beam");  // rho_infinity, balance and newton_tolerance
  ASSERT_TRUE(scene.transient->balance && scene.transient->newton_tolerance);
  const TransientScene radau =
      *mbd::with(scene, {.method = TimeMethod::radau, .tolerance = 1e-6}).transient;
  EXPECT_EQ(radau.method, TimeMethod::radau);
  EXPECT_EQ(radau.tolerance, 1e-6);
  EXPECT_FALSE(radau.step || radau.rho_infinity || radau.balance || radau.newton_tolerance);
  EXPECT_EQ(radau.output, scene.transient->step);  // rows stay
  const TransientScene finer = *mbd::with(scene, {.step = 1e-3}).transient;
  EXPECT_EQ(finer.step, 1e-3);
  EXPECT_TRUE(finer.balance && finer.rho_infinity && finer.newton_tolerance);
}

TEST(Setting, RefusesKnobsThatTheSceneDoesNotHave) {
  EXPECT_THROW(mbd::with(model_scene("pendulum"), {.order = 3}), Error);
  EXPECT_THROW(mbd::with(model_scene("bend45"), {.tolerance = 1e-3}), Error);
  EXPECT_THROW(mbd::with(model_scene("bend45"), {.order = 9}), Error);
  EXPECT_THROW(mbd::with(model_scene("bend45"), {.elements = 0}), Error);
}

TEST(Setting, IsSaidInWordsAndAsASnippet) {
  const Scene scene = model_scene("four_bar");
  const Setting setting{.order = 4, .elements = 2, .method = TimeMethod::radau, .tolerance = 1e-5};
  EXPECT_EQ(to_text(scene, setting), "order 4, 2/4/2 elements, radau, tolerance 1e-05");
  EXPECT_EQ(to_text(scene, {}), "as it is");
  const std::string text = snippet(scene, setting);
  EXPECT_NE(text.find("<beam name=\"bar1\" … order=\"4\"/>"), std::string::npos) << text;
  EXPECT_EQ(text.find("elements="), std::string::npos) << text;  // they stay
  EXPECT_NE(
      text.find(
          "<transient duration=\"36\" method=\"radau\" tolerance=\"1e-05\" output=\"0.009\"/>"),
      std::string::npos)
      << text;
  EXPECT_EQ(snippet(scene, setting_of(scene)), "");
}

// The <transient> of the snippet says the same as the setting, when it stands in the model.
TEST(Setting, SnippetsAreReadBackAsTheSameScene) {
  const std::string begin = "<mbd name=\"m\"><body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/>",
                    end = "</mbd>";
  const Scene scene = read_model_text(
      begin + "<transient duration=\"2\" step=\"0.01\" rho_infinity=\"0.5\"/>" + end);
  for (const Setting& setting :
       {Setting{.step = 1.0 / 300.0}, Setting{.method = TimeMethod::radau, .tolerance = 3e-7},
        Setting{.method = TimeMethod::ida, .tolerance = 1e-5},
        Setting{.method = TimeMethod::radau, .step = 0.005}}) {
    const TransientScene wanted = *mbd::with(scene, setting).transient;
    const TransientScene read = *read_model_text(begin + snippet(scene, setting) + end).transient;
    EXPECT_EQ(read.method, wanted.method);
    EXPECT_EQ(read.step, wanted.step);
    EXPECT_EQ(read.tolerance, wanted.tolerance);
    EXPECT_EQ(read.output, wanted.output);
    EXPECT_EQ(read.rho_infinity, wanted.rho_infinity);
  }
}

TEST(Variations, AreListsRangesAndAll) {
  Variations v;
  for (const char* text :
       {"order=2:4,6", "elements=1,2,4,2", "tolerance=1e-2:1e-5", "step=1e-3,5e-4", "metric=all",
        "rule=gauss_lobatto", "method=ida,radau"})
    add_variation(v, text);
  EXPECT_EQ(v.order, (std::vector{2, 3, 4, 6}));
  EXPECT_EQ(v.elements, (std::vector{1, 2, 4}));
  EXPECT_EQ(v.tolerance, (std::vector{1e-2, 1e-3, 1e-4, 1e-5}));
  EXPECT_EQ(v.step, (std::vector{1e-3, 5e-4}));
  EXPECT_EQ(v.metric.size(), 3u);
  EXPECT_EQ(v.rule, std::vector{Rule::gauss_lobatto});
  EXPECT_EQ(v.method, (std::vector{TimeMethod::ida, TimeMethod::radau}));
}

TEST(Variations, RefusalsSayWhatIsAllowed) {
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(message_of(text).find(part), std::string::npos) << text << ": " << message_of(text);
  };
  expect("ordre=2", "did you mean \"order\"?");
  expect("order", "KNOB=VALUES");
  expect("order=", "KNOB=VALUES");
  expect("order=2,", "a value is missing");
  expect("order=2.5", "whole number");
  expect("order=0", "between 1 and 8");
  expect("order=3:2", "range is empty");
  expect("order=1:1e9", "range is too long");
  expect("elements=1000000", "at most");
  expect("step=0", "step");
  expect("step=nan", "not a number");
  expect("tolerance=-1", "tolerance");
  expect("metric=geodetic", "did you mean \"geodesic\"?");
  expect("method=", "KNOB=VALUES");
}

TEST(Variations, CombineWhatGoesTogether) {
  Variations v;
  for (const char* text : {"method=all", "step=1e-2,1e-3", "tolerance=1e-3,1e-4,1e-5", "order=2,3"})
    add_variation(v, text);
  // Generalized-alpha with 2 steps, Radau and IDA with 3 tolerances; for 2 orders.
  const std::vector<Setting> all = settings_of(v);
  EXPECT_EQ(all.size(), 2u * (2u + 3u + 3u));
  for (const Setting& s : all) {
    EXPECT_NE(s.step.has_value(), s.tolerance.has_value());
    EXPECT_EQ(s.step.has_value(), s.method == TimeMethod::generalized_alpha);
  }
  Variations one;
  add_variation(one, "method=radau");
  add_variation(one, "step=1e-2,1e-3");
  EXPECT_EQ(settings_of(one).size(), 2u);  // fixed steps of Radau, where nothing else is asked for
  EXPECT_EQ(settings_of({}).size(), 1u);
}

TEST(Variations, DefaultsSuitTheModel) {
  const Variations rigid = default_variations(model_scene("pendulum"));
  EXPECT_TRUE(rigid.order.empty() && rigid.elements.empty());
  EXPECT_GE(rigid.step.size(), 3u);
  EXPECT_GE(rigid.tolerance.size(), 3u);
  const Variations bend = default_variations(model_scene("bend45"));
  EXPECT_TRUE(bend.method.empty() && bend.step.empty() && bend.tolerance.empty());
  EXPECT_GE(bend.order.size(), 3u);
  EXPECT_GE(bend.elements.size(), 3u);
  for (const char* const name : {"shaft", "four_bar", "cart_pole", "windows"})
    for (const Setting& setting : settings_of(default_variations(model_scene(name))))
      EXPECT_NO_THROW(compile(mbd::with(model_scene(name), setting))) << name;
  Variations given;
  add_variation(given, "order=5");
  EXPECT_EQ(default_variations(model_scene("shaft"), given).order, std::vector{5});
}

}  // namespace
}  // namespace mbd::test::test_setting
