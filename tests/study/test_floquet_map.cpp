// Maps of stability over parameters against monodromy matrices of Mathieu's equation, integrated here; frequencies in inertial axes
// against closed form.
#include "libmbd/study/modes/floquet_map.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "libmbd/language/reader.hpp"
#include "tests/support/monodromy.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_floquet_map {
namespace {

constexpr double pi = std::numbers::pi, g = 9.81;

// A pendulum of equivalent length 1 m, upright on a carriage that is shaken up and down.
const char* const shaken = R"xml(<mbd name="shaken">
  <parameter name="W" value="20"/><parameter name="a" value="0.25 m"/>
  <body name="carriage" mass="1" inertia="1 1 1"/>
  <motion name="path" of="carriage" displacement="0 0 a*(cos(W*t)-1)" rotation="0 0 0"/>
  <parameter name="m" value="4"/>
  <body name="arm" center="0 0 0.5" mass="m" inertia="m/4 m/4 0.01"/>
  <revolute name="hinge" between="carriage arm" axis="1 2 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="1" step="1e-3"/>
  <record name="hinge" joint="hinge" quantities="angle"/></mbd>)xml";

ReadSweptModel reader(const char* text) {
  return [text](const Overrides& values) { return read_model_text(text, "m.xml", values); };
}

// Half the trace of x'' = (g - a W^2 cos(W t)) x over a period.
double half_trace(double W, double a) {
  const auto rates = [&](double t, const Eigen::MatrixXd& x) {
    Eigen::MatrixXd dx(2, 2);
    dx << x.row(1), (g - a * W * W * std::cos(W * t)) * x.row(0);
    return dx;
  };
  return 0.5 * monodromy_of(rates, 2, 2.0 * pi / W).trace();
}

FloquetMapOptions by_rate() {
  FloquetMapOptions options;
  options.floquet.settle = 0;
  options.period = [](const Scene& scene) {
    for (const auto& [name, value] : scene.parameters)
      if (name == "W") return 2.0 * pi / value;
    throw Error("no W");
  };
  return options;
}

TEST(FloquetMap, OfMathieu) {
  const std::vector<std::string> vary{"W=12,18,30", "a=100,250,400 mm"};
  const FloquetMap map = map_floquet(reader(shaken), grid_plan(vary), by_rate());
  ASSERT_EQ(map.points.size(), 9U);
  std::size_t unstable = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const double W = std::array{12.0, 18.0, 30.0}[i / 3], a = std::array{0.1, 0.25, 0.4}[i % 3];
    ASSERT_TRUE(map.points[i].study) << map.points[i].failure;
    const double trace = std::abs(half_trace(W, a));
    const double growth = trace > 1.0 ? std::acosh(trace) : 0.0;
    EXPECT_NEAR(map.points[i].study->growth(), growth, 1e-8) << W << ' ' << a;
    unstable += growth > 0.0 ? 1 : 0;
  }
  EXPECT_GT(unstable, 2U);
  EXPECT_LT(unstable, 8U);
  EXPECT_NE(to_text(map).find(fmt::format("{} neutral {} unstable", 9 - unstable, unstable)),
            std::string::npos)
      << to_text(map);
  EXPECT_NE(floquet_svg(map).value_or("").find("unstable"), std::string::npos);
}

// What fails is a row that says why; a value of which there is one is no axis of the picture.
TEST(FloquetMap, FailuresAreRows) {
  const std::vector<std::string> vary{"W=20,30", "m=3,-3"};
  const FloquetMap map = map_floquet(reader(shaken), grid_plan(vary), by_rate());
  EXPECT_TRUE(map.points[0].study && map.points[2].study);
  EXPECT_NE(map.points[1].failure.find("m.xml"), std::string::npos) << map.points[1].failure;
  EXPECT_NE(floquet_svg(map).value_or("").find("failed"), std::string::npos);
  std::istringstream rows(to_csv(map));
  std::string row;
  std::getline(rows, row);
  const auto cells = std::ranges::count(row, ',');
  EXPECT_NE(row.find("point,W,m,verdict,period,growth,mode"), std::string::npos) << row;
  int count = 0;
  while (std::getline(rows, row))
    if (row.find('"') == std::string::npos) {
      EXPECT_EQ(std::ranges::count(row, ','), cells) << row;
      ++count;
    }
  EXPECT_GT(count, 2);
  const std::vector<std::string> one{"W=18,20,30", "m=3"};
  EXPECT_NE(floquet_svg(map_floquet(reader(shaken), grid_plan(one), by_rate()))
                .value_or("")
                .find("Frequencies of small motions"),
            std::string::npos);
  // Growth of round-off is not drawn, any other is.
  for (const char* const rates : {"W=30,40", "W=12,30"}) {
    const std::vector<std::string> rate{rates};
    const std::string picture =
        floquet_svg(map_floquet(reader(shaken), grid_plan(rate), by_rate())).value_or("");
    EXPECT_EQ(picture.find("Growth of small motions") != std::string::npos, rates[2] == '1');
  }
  const std::vector<std::string> none{"m=-1,-2"};
  EXPECT_THROW(map_floquet(reader(shaken), grid_plan(none), by_rate()), Error);
  const std::vector<std::string> three{"W=20,30", "m=1,2", "a=0.1,0.2 m"};
  EXPECT_FALSE(floquet_svg(map_floquet(reader(shaken), grid_plan(three), by_rate())));
  EXPECT_FALSE(floquet_svg(map_floquet(reader(shaken), list_plan({"a"}, {{"250 mm"}, {"0.3 m"}}),
                                       by_rate())));  // no common unit
  const std::vector<std::string> unknown{"W=20,30", "b=1,2"};
  EXPECT_THROW(map_floquet(reader(shaken), grid_plan(unknown), by_rate()), Error);
}

// A disk that turns in a housing on springs alike in all directions: as its bearings feel it, its motions across the axis have
// the frequency sqrt(k/m) at every rate, while in its own axes it is W more or less.
TEST(FloquetMap, FrequenciesInInertialAxes) {
  const char* const rotor = R"xml(<mbd name="rotor"><parameter name="W" value="3"/>
    <body name="housing" mass="0.1" inertia="0.1 0.1 0.1"/>
    <body name="disk" mass="1.9" inertia="0.4 0.2 0.2" angular_velocity="W 0 0"/>
    <bushing name="bearing" between="ground housing" stiffness="800 98 98" angular_stiffness="1e4 1e4 1e4"/>
    <revolute name="R" between="housing disk" axis="1 0 0"/><drive joint="R" rate="W"/>
    <transient duration="1" step="1e-3"/><record name="d" at="disk" quantities="displacement"/></mbd>)xml";
  const std::vector<std::string> vary{"W=3,5,11"};
  const FloquetMap map = map_floquet(reader(rotor), grid_plan(vary), by_rate());
  for (const FloquetMap::Point& point : map.points) {
    ASSERT_TRUE(point.study) << point.failure;
    int found = 0;
    for (const NamedFloquetMode& mode : point.study->modes)
      found += std::abs(mode.inertial - 7.0) < 1e-7 ? 1 : 0;
    EXPECT_EQ(found, 2);
  }
}

TEST(FloquetMap, ByTheProgram) {
  const TemporaryDirectory directory;
  const std::filesystem::path model = directory.path() / "m.xml", out = directory.path() / "out";
  test::write_text(model, shaken);
  const auto call = [&](const std::string& rest) {
    return shell(quote(test::mbd_program) + " floquet " + model.string() + " --settle 0 --out " +
                 out.string() + " " + rest);
  };
  const Output done = call("--rate W --vary W=12,30 a=\"100,400 mm\"");
  EXPECT_EQ(done.status, 0) << done.text;
  EXPECT_NE(done.text.find("periodic motion at 4 points:"), std::string::npos) << done.text;
  EXPECT_TRUE(test::read_text(out / "floquet.csv").starts_with("point,W,a,verdict,"));
  EXPECT_NE(test::read_text(out / "floquet.svg").find("<svg"), std::string::npos);
  EXPECT_EQ(call("--rate W --vary W=12,30 --motion").status, 1);
  const Output wrong = call("--rate V --vary W=12,30");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.text.find("V"), std::string::npos) << wrong.text;
}

}  // namespace
}  // namespace mbd::test::test_floquet_map
