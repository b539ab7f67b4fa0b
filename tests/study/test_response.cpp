// Response to unbalance against Jeffcott's rotor in closed form, on bearings that are alike in all directions (turning axes would
// be enough) and on unequal ones, and against the motion of an eccentric mass in time.
// Response to forces of fixed direction against the same rotor at other orders, and an unround shaft in turning axes.
// Mutations seen: half the force; e3 the other way; 1.0001 W in the equations; an unbalance of what rests taken. Not seen: a free spin
// that nothing holds (its motion moves no point of the axis).
#include "libmbd/study/modes/response.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "libmbd/study/modes/campbell.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_response {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr Complex i(0.0, 1.0);

constexpr double m = 20.0, k2 = 2e5, c2 = 400.0,
                 e = 1e-6;  // w = 100 rad/s, 10 % of critical damping

// A rigid disk that turns in a housing on springs and dampers; nothing tilts. `more`: of the disk, the drive and the run.
std::string rotor(double k3, double c3, const std::string& disk, const std::string& more) {
  return fmt::format(R"(
    <body name="housing" at="0 0 0" mass="1e-9" inertia="1e-9 1e-9 1e-9"/>
    <body name="disk" at="0 0 0" mass="20" inertia="0.4 0.2 0.2" {}/>
    <bushing name="bearing" between="ground housing" stiffness="1e6 {} {}" angular_stiffness="1e6 1e6 1e6"
             damping="1e3 {} {}"/>
    <revolute name="R" between="housing disk" axis="1 0 0"/>{})",
                     disk, k2, k3, c2, c3, more);
}

CampbellStudy study(const std::string& scene, double from, double to, int points) {
  CampbellOptions options;
  options.from = from;
  options.to = to;
  options.points = points;
  options.count = 2;
  options.at_rest = {"housing"};
  options.unbalance = {{"disk", m * e}};
  return study_campbell(read(scene), options);
}

// y of k y + c y' + m y'' = m e W^2 exp(i W t).
Complex jeffcott(double k, double c, double W) {
  return m * e * W * W / (k - m * W * W + i * c * W);
}

TEST(Unbalance, OfJeffcottsRotor) {
  for (const double k3 : {2e5, 3.2e5}) {
    const double c3 = k3 == k2 ? c2 : 900.0;
    const CampbellStudy result =
        study(rotor(k3, c3, "", R"(<drive joint="R" angle="0"/><static/>)"), 20.0, 200.0, 10);
    ASSERT_EQ(result.responses.size(), 1U);
    const std::vector<Orbit>& orbits = result.responses[0].orbits;
    ASSERT_GE(orbits.size(), 10U);
    for (const Orbit& orbit : orbits) {
      const double W = orbit.rate;
      const Complex y = jeffcott(k2, c2, W), z = -i * jeffcott(k3, c3, W);
      const Complex forward = 0.5 * (y + i * z), backward = 0.5 * std::conj(y - i * z);
      const double size = std::abs(forward);
      EXPECT_LT(std::abs(orbit.forward - forward), 1e-8 * size) << k3 << ' ' << W;
      EXPECT_LT(std::abs(orbit.backward - backward), 1e-8 * size) << k3 << ' ' << W;
      if (k3 != k2) continue;
      // Amplitude and phase as textbooks have them.
      const double r = W / 100.0, d = 2.0 * 0.1 * r;
      EXPECT_NEAR(orbit.major(), e * r * r / std::hypot(1.0 - r * r, d), 1e-8 * size);
      EXPECT_NEAR(orbit.lag(), std::atan2(d, 1.0 - r * r), 1e-8);
    }
    EXPECT_GT(orbits.back().lag(), 0.5 * pi);
    EXPECT_NE(response_csv(result.responses).find("re_forward"), std::string::npos);
    EXPECT_NE(campbell_svg(result).find("Response to unbalance"), std::string::npos);
  }
}

// Resonances far narrower than steps between rates: 0.05 and 0.04 % of critical damping, steps of 20 rad/s; without damping.
// Mutation seen: the golden section the wrong way. Not seen: no intervals where a mode has the frequency of what acts (there
// are the critical speeds too).
TEST(Unbalance, AtResonancesBetweenTheRates) {
  constexpr double k3 = 3.2e5, c3 = 2.0;
  const std::string more = R"(<drive joint="R" angle="0"/><static/>)";
  std::string scene = rotor(k3, c3, "", more);
  scene.replace(scene.find("damping=\"1e3 400"), 16, "damping=\"1e3 2");
  const CampbellStudy result = study(scene, 20.0, 210.0, 10);
  const std::vector<Orbit>& orbits = result.responses.at(0).orbits;
  EXPECT_TRUE(std::ranges::is_sorted(orbits, {}, &Orbit::rate));
  const auto largest = [&](double from, double to) {
    double most = 0.0;
    for (const Orbit& orbit : orbits)
      if (orbit.rate > from && orbit.rate < to) most = std::max(most, orbit.major());
    return most;
  };
  const auto top = [](double k, double c) {
    double most = 0.0;
    const double W = std::sqrt(k / m);
    for (int n = -1000; n <= 1000; ++n)
      most = std::max(most, std::abs(jeffcott(k, c, W * (1.0 + 1e-6 * n))));
    return most;
  };
  EXPECT_NEAR(largest(90.0, 110.0) / top(k2, 2.0), 1.0, 1e-4);
  EXPECT_NEAR(largest(120.0, 135.0) / top(k3, c3), 1.0, 1e-4);
  EXPECT_NE(to_text(result).find(fmt::format("at most {:.4g}", top(k3, c3)).substr(0, 13)),
            std::string::npos)
      << to_text(result);

  scene.replace(scene.find("damping=\"1e3 2 2\""), 17, "");
  const std::string undamped = to_text(study(scene, 20.0, 210.0, 10));
  EXPECT_NE(undamped.find("without bound at "), std::string::npos) << undamped;
}

// The shaft's centre in time, after it has settled: mean over a turn of w exp(-i W t) and w exp(i W t).
TEST(Unbalance, OfAnEccentricMassInTime) {
  constexpr double k3 = 3.2e5, c3 = 900.0;
  for (const double W : {80.0, 140.0}) {
    const double turn = 2.0 * pi / W;
    const Scene scene =
        read(rotor(k3, c3, fmt::format(R"(center="0 {} 0" angular_velocity="{} 0 0")", e, W),
                   fmt::format(R"(<drive joint="R" rate="{0}"/>
          <transient duration="{1:.17g}" method="radau" tolerance="1e-9" output="{2:.17g}"/>
          <record name="D" at="housing" quantities="displacement"/>
          <record name="angle" joint="R" quantities="angle"/>)",
                               W, 31.0 * turn, turn / 32.0)));
    const History history = run_to_table(scene);
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const Table& table = history.table;
    Complex forward = 0.0, backward = 0.0;
    const std::size_t rows = table.rows() - 1;  // that of the end may lie beside the others
    ASSERT_GT(rows, 32U * 30U);
    for (std::size_t row = rows - 32; row < rows; ++row) {
      const Complex w(table["D.displacement.2"][row], table["D.displacement.3"][row]);
      const double angle = table["angle.angle"][row];
      forward += w * std::exp(-i * angle) / 32.0;
      backward += w * std::exp(i * angle) / 32.0;
    }
    const CampbellStudy result =
        study(rotor(k3, c3, "", R"(<drive joint="R" angle="0"/><static/>)"), W, W + 1.0, 2);
    const Orbit& orbit = result.responses.at(0).orbits.at(0);
    ASSERT_NEAR(orbit.rate, W, 1e-9);
    const double size = std::abs(orbit.forward);
    EXPECT_LT(std::abs(orbit.forward - forward), 1e-5 * size) << W;
    EXPECT_LT(std::abs(orbit.backward - backward), 1e-5 * size) << W;
    EXPECT_GT(std::abs(orbit.backward), 0.3 * size) << "no ellipse";
  }
}

// A flexible shaft in axes that turn with it: k = 1/(L^3/(192 EI) + L/(4 GA)) at mid-span of a shaft with both ends held, without
// damping, and of which the spin is free.
TEST(Unbalance, OfAFlexibleShaftInTurningAxes) {
  constexpr double L = 1.0, EI = 1000.0, GA = 1e7;
  const double k = 1.0 / (L * L * L / (192.0 * EI) + L / (4.0 * GA)), w2 = k / m;
  CampbellOptions options;
  options.to = 2.0 * std::sqrt(w2);
  options.points = 6;
  options.count = 2;
  options.unbalance = {{"shaft@0.5", m * e}};
  options.probes = {"disk", "shaft@0.25"};
  const CampbellStudy result = study_campbell(read(R"(
    <section name="wire"><stiffness EA="1e8" GA2="1e7" GA3="1e7" GJ="1e6" EI2="1000" EI3="1000"/>
      <mass per_length="2e-6" inertia="2e-10 1e-10 1e-10"/></section>
    <beam name="shaft" section="wire" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
    <body name="disk" attached_to="shaft@0.5" mass="20" inertia="0.004 0.002 0.002"/>
    <revolute name="R" between="ground shaft.start" axis="1 0 0"/>
    <cylindrical name="T" between="ground shaft.end" axis="1 0 0"/><static/>)"),
                                              options);
  EXPECT_EQ(result.axes, ModeAxes::turning);
  ASSERT_EQ(result.responses.size(), 3U);
  ASSERT_GE(result.responses[0].orbits.size(), 6U);
  for (const Orbit& orbit : result.responses[0].orbits) {
    // Near a resonance without damping, what is left of the difference is round-off of the frequency.
    if (!std::ranges::binary_search(result.rates, orbit.rate)) continue;
    const double W2 = orbit.rate * orbit.rate, wanted = e * W2 / (w2 - W2);
    EXPECT_NEAR(orbit.forward.real(), wanted, 1e-5 * std::abs(wanted)) << orbit.rate;
    EXPECT_LT(std::abs(orbit.forward.imag()), 1e-9 * std::abs(wanted));
    EXPECT_EQ(orbit.backward, 0.0);
  }
  for (std::size_t j = 0; j < result.responses[1].orbits.size(); ++j) {
    const double middle = result.responses[0].orbits[j].forward.real();
    EXPECT_NEAR(result.responses[1].orbits[j].forward.real(), middle, 1e-12 * std::abs(middle));
    // Half of it, of a cubic between held ends.
    EXPECT_NEAR(result.responses[2].orbits[j].forward.real(), 0.5 * middle,
                1e-3 * std::abs(middle));
  }
}

// F/(k + i c w - m w^2) along each axis, w = n W; along lines, as what is driven and held differently along two axes.
TEST(HarmonicForces, OfJeffcottsRotor) {
  constexpr double k3 = 3.2e5, c3 = 900.0, F2 = 3.0, F3 = -2.0;
  for (const double order : {0.5, 1.0, 2.0}) {
    CampbellOptions options;
    options.from = 20.0;
    options.to = 200.0;
    options.points = 5;
    options.count = 2;
    options.at_rest = {"housing"};
    options.forces = {{"disk", F2, 0.0}, {"housing", 0.0, F3}};
    options.order = order;
    const CampbellStudy result = study_campbell(
        read(rotor(k3, c3, "", R"(<drive joint="R" angle="0"/><static/>)")), options);
    ASSERT_EQ(result.force_responses.size(), 2U);
    EXPECT_TRUE(result.responses.empty());
    for (const CampbellStudy::Response& response : result.force_responses) {
      ASSERT_GE(response.orbits.size(), 5U);
      for (const Orbit& orbit : response.orbits) {
        const double w = order * orbit.rate;
        const Complex y = F2 / (k2 - m * w * w + i * c2 * w),
                      z = F3 / (k3 - m * w * w + i * c3 * w);
        const double size = std::abs(y) + std::abs(z);
        EXPECT_LT(std::abs(orbit.forward - 0.5 * (y + i * z)), 1e-8 * size) << w;
        EXPECT_LT(std::abs(orbit.backward - 0.5 * std::conj(y - i * z)), 1e-8 * size) << w;
        EXPECT_EQ(orbit.besides, 0.0);
      }
    }
    EXPECT_NE(campbell_svg(result).find("Response to forces at"), std::string::npos);
    EXPECT_NE(to_text(result).find("response to forces at"), std::string::npos);
  }
}

// A mass on an unround shaft without mass, in turning axes: m (w'' + 2 i W w' - W^2 w) + k w + d conj(w) = f, w = y + i z,
// k, d half the sum and the difference of the stiffnesses along two axes; f = F/2 (exp(i (w - W) t) + exp(-i (w + W) t)). With
// w = a exp(i v t) + b exp(-i v t):  (k - m (v + W)^2) a + d conj(b) = F/2,  (k - m (v - W)^2) conj(b) + d a = 0.
TEST(HarmonicForces, OfAnUnroundShaftInTurningAxes) {
  constexpr double L = 1.0, GA = 1e7, F = 5.0;
  const auto stiffness = [](double EI) {
    return 1.0 / (L * L * L / (192.0 * EI) + L / (4.0 * GA));
  };
  for (const double EI3 : {1000.0, 1500.0}) {
    // b3 is i2.
    const double ky = stiffness(1000.0), kz = stiffness(EI3), k = 0.5 * (ky + kz),
                 d = 0.5 * (ky - kz);
    for (const double order : {1.0, 2.0, 0.7}) {
      CampbellOptions options;
      options.from = 0.1 * std::sqrt(k / m);
      options.to = 0.8 * std::sqrt(k / m);
      options.points = 4;
      options.count = 2;
      options.forces = {{"disk", F, 0.0}};
      options.order = order;
      const CampbellStudy result = study_campbell(read(fmt::format(R"(
    <section name="wire"><stiffness EA="1e8" GA2="1e7" GA3="1e7" GJ="1e6" EI2="1000" EI3="{}"/>
      <mass per_length="2e-6" inertia="2e-10 1e-10 1e-10"/></section>
    <beam name="shaft" section="wire" from="0 0 0" to="1 0 0" normal="0 1 0" elements="2" order="4"/>
    <body name="disk" attached_to="shaft@0.5" mass="20" inertia="0.004 0.002 0.002"/>
    <revolute name="R" between="ground shaft.start" axis="1 0 0"/>
    <cylindrical name="T" between="ground shaft.end" axis="1 0 0"/><static/>)",
                                                                   EI3)),
                                                  options);
      EXPECT_EQ(result.axes, ModeAxes::turning);
      ASSERT_GE(result.force_responses.at(0).orbits.size(), 4U);
      for (const Orbit& orbit : result.force_responses[0].orbits) {
        if (!std::ranges::binary_search(result.rates, orbit.rate)) continue;
        const double W = orbit.rate, w = order * W;
        const auto solved = [&](double v) {  // a and b, real
          const double A = k - m * (v + W) * (v + W), B = k - m * (v - W) * (v - W);
          if (d == 0.0) return std::array{0.5 * F / A, 0.0};
          const double a = 0.5 * F * B / (A * B - d * d);
          return std::array{a, -d * a / B};
        };
        const auto [a1, b1] = solved(w - W);
        const auto [a2, b2] = solved(-(w + W));
        double forward = a1, besides = std::abs(b1) + std::abs(b2);
        if (order == 1.0) {  // at rest: k w + d conj(w) - m W^2 w = F/2, w real
          forward = 0.5 * F / (k + d - m * W * W);
          besides = std::abs(b2);
        }
        EXPECT_NEAR(orbit.forward.real(), forward, 1e-5 * std::abs(forward)) << order << ' ' << W;
        EXPECT_NEAR(orbit.backward.real(), a2, 1e-5 * (std::abs(a2) + std::abs(forward)))
            << order << ' ' << W;
        EXPECT_NEAR(orbit.besides, besides, 1e-5 * (std::abs(forward) + besides)) << order;
      }
    }
  }
}

TEST(Unbalance, RefusesWhatDoesNotTurn) {
  const std::string scene = rotor(k2, c2, "", R"(<drive joint="R" angle="0"/><static/>)");
  CampbellOptions options;
  options.to = 10.0;
  options.points = 2;
  options.count = 2;
  options.at_rest = {"housing"};
  for (const char* place : {"housing", "ground", "dsik"}) {
    options.unbalance = {{place, 1.0}};
    EXPECT_THROW(study_campbell(read(scene), options), Error) << place;
  }
  options.unbalance.clear();
  options.probes = {"disk"};
  EXPECT_THROW(study_campbell(read(scene), options), Error);
  options.probes.clear();
  for (const char* place : {"ground", "dsik"}) {
    options.forces = {{place, 1.0, 0.0}};
    EXPECT_THROW(study_campbell(read(scene), options), Error) << place;
  }
  options.forces = {{"disk", 1.0, 0.0}};
  options.order = 0.0;
  EXPECT_THROW(study_campbell(read(scene), options), Error);
}

}  // namespace
}  // namespace mbd::test::test_response
