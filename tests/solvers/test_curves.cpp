// Beams along given points: the line is that of the points' curve to the order of the elements.
//
// Quarter circle, R = 1, EI = GJ/0.84 = 1, clamped, dead force at the tip out of its plane (and a third of it
// within): u of the tip against the same beam as an exact <arc>, 12 elements of order 6, relative.
// Measured: orders 4.0 (N = 2), 5.9 … 6.0 (3), 7.8 … 8.0 (4) over metrics and forms; uneven points give the
// same errors to four digits: the line is not what limits the accuracy.
#include <gtest/gtest.h>

#include <numbers>

#include "elements/beam/beam_motion.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_curves {
namespace {

using std::numbers::pi;

Vec3 last(const Table& t, const std::string& name) {
  return {t[name + ".1"].back(), t[name + ".2"].back(), t[name + ".3"].back()};
}

// ---- the quarter circle -----------------------------------------------------------------------

Scene quarter(Metric metric, Form form, int order, int elements) {
  Scene scene = read_model_text(R"xml(<mbd name="quarter">
    <section name="s"><stiffness EA="1.2e5" GA2="5e4" GA3="5e4" GJ="0.84" EI2="1" EI3="1"/></section>
    <arc name="b" section="s" from="0 0 0" center="1 0 0" axis="0 0 -1" angle="pi/2" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/>
    <load at="b.end" force="0.3 -0.3 1.5"/>
    <static steps="2"/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)xml");
  scene.beams[0].order = order;
  scene.beams[0].elements = elements;
  return with(scene, metric, form);
}

Vec3 on_circle(double s) { return {1 - std::cos(s * pi / 2), std::sin(s * pi / 2), 0}; }

// Points at fractions k/n of the length, moved by up to `jitter` of their distance (not at the ends).
Curve through_points(int n, double jitter = 0.0) {
  Rng rng(5);
  Curve curve;
  for (int k = 0; k <= n; ++k) {
    const double move = k == 0 || k == n ? 0.0 : uniform(rng, -jitter, jitter);
    curve.points.push_back({{}, on_circle((k + move) / n), {}, 0.0});
  }
  return curve;
}

Vec3 tip(const Scene& scene) {
  const History history = run_to_table(scene);
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  return last(history.table, "tip.displacement");
}

class CurveOrder : public testing::TestWithParam<std::tuple<Metric, Form>> {};

// Detects a degree of the spline of N, chord lengths as its parameters, the length of the chords.
TEST_P(CurveOrder, QuarterCircleIsThatOfTheArc) {
  const auto [metric, form] = GetParam();
  const Vec3 exact = tip(quarter(metric, form, 6, 12));
  for (int N = 2; N <= 4; ++N) {
    std::vector<double> length, even, uneven;
    for (const int elements : N == 4 ? std::vector{4, 8} : std::vector{4, 8, 16}) {
      Scene scene = quarter(metric, form, N, elements);
      length.push_back(1.0 / elements);
      for (auto* const errors : {&even, &uneven}) {
        scene.beams[0].line = through_points(elements * N, errors == &even ? 0.0 : 0.3);
        errors->push_back((tip(scene) - exact).norm() / exact.norm());
      }
    }
    const std::string what = "N = " + std::to_string(N) + ": " + testing::PrintToString(even) +
                             ", uneven points " + testing::PrintToString(uneven);
    EXPECT_GT(orders(length, even).back(), 2 * N - 0.3) << what;
    EXPECT_GT(orders(length, uneven).back(), 2 * N - 0.7) << what;
    EXPECT_LT(even.back(), N == 2 ? 2e-5 : 1e-8) << what;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, CurveOrder,
                         testing::Combine(testing::ValuesIn(all_metrics),
                                          testing::ValuesIn(all_forms)),
                         [](const auto& p) {
                           return name_of(std::get<0>(p.param)) + "_" +
                                  name_of(std::get<1>(p.param));
                         });

// ---- curvature and twist ----------------------------------------------------------------------

constexpr double radius = 2.0, pitch = 0.6, turns = 0.75;  // (R cos a, R sin a, c a)
const double per_angle = std::hypot(radius, pitch);        // ds/da

CurvePoint on_helix(double a) {
  return {{},
          Vec3(radius * std::cos(a), radius * std::sin(a), pitch * a),
          Vec3(-std::cos(a), -std::sin(a), 0),
          0.0};
}
BeamScene helix(int points) {
  BeamScene beam;
  beam.name = "helix";
  Curve curve;
  for (int k = 0; k < points; ++k)
    curve.points.push_back(on_helix(2 * pi * turns * k / (points - 1)));
  beam.line = curve;
  return beam;
}

// The largest error of K0 at the Gauss points of the elements, from the curve's Frenet formulae: with b3
// along the principal normal, K0 = (1, 0, 0, tau, -kappa, 0). Order N + 1: the derivative of an interpolant
// on the GLL points is most accurate at the Gauss points. Detects 10 % less twist, points at 1.1 of the
// distance, or normals left out (then b3 is not the principal normal).
TEST(Curve, CurvatureAndTwistOfAHelix) {
  const double kappa = radius / (per_angle * per_angle), tau = pitch / (per_angle * per_angle);
  Vec6 exact;
  exact << 1, 0, 0, tau, -kappa, 0;
  for (int N = 2; N <= 4; ++N) {  // round-off: 1e-9 (in the end spans)
    const SpectralTable table = spectral_table(N, Rule::gauss);
    std::vector<double> h, error;
    for (const int elements : {6, 12, 24}) {
      BeamScene beam = helix(elements * N + 1);
      beam.order = N;
      const ReferenceLine line = make_reference_line(beam);
      double worst = 0.0;
      for (int e = 0; e < elements; ++e) {
        std::vector<Pose<double>> pose;
        for (const double xi : table.nodes.points)
          pose.push_back(line.at((e + 0.5 * (1 + xi)) / elements));
        const std::vector<double> J(pose.size(), 0.5 * line.length / elements);
        const auto data = beam::make_data<GeodesicMetric, 0>(table, J, pose, 0, 0);
        for (std::size_t i = 0; i < table.rule.points.size(); ++i)
          worst = std::max(worst, (data.K0[i] - exact).norm());
      }
      h.push_back(1.0 / elements);
      error.push_back(worst);
    }
    EXPECT_GT(orders(h, error).front(), N + 0.7)
        << "N = " << N << ": " << testing::PrintToString(error);
    EXPECT_LT(error.back(), N == 2 ? 1e-5 : N == 3 ? 1e-8 : 1e-9);
  }
}

// Length and places: equal fractions of the arc length, to the order of the spline and to round-off once it
// is resolved. Detects a length by chords, or places by the spline's parameter.
TEST(Curve, ArcLengthOfAHelix) {
  BeamScene beam = helix(81);
  beam.order = 5;
  const ReferenceLine line = make_reference_line(beam);
  EXPECT_NEAR(line.length / (2 * pi * turns * per_angle), 1.0, 1e-13);
  for (const double s : {0.0, 0.123, 0.5, 0.77, 1.0}) {
    const CurvePoint exact = on_helix(2 * pi * turns * s);
    const Pose<double> H = line.at(s);
    EXPECT_LT((H.r - exact.at).norm(), 2e-13) << s;
    EXPECT_LT((H.p * Vec3(Vec3::UnitZ()) - *exact.normal).norm(), 1e-11) << s;
  }
}

// Three halves of an ellipse, strongly uneven points: the length is an elliptic integral, here by the
// trapezoidal rule, which converges faster than any power for a periodic integrand.
TEST(Curve, ArcLengthOfAnEllipse) {
  double quarter = 0.0;
  const int n = 4000;
  for (int k = 0; k < n; ++k) {
    const double a = 2 * pi * k / n;
    quarter += std::hypot(2 * std::sin(a), std::cos(a)) * 2 * pi / n / 4;
  }
  BeamScene beam;
  beam.order = 3;
  std::vector<double> h, error;
  for (const int points : {33, 65, 129}) {
    Curve curve;
    for (int k = 0; k < points; ++k) {
      const double x = k / (points - 1.0), a = pi / 2 * x * x * (1.5 - 0.5 * x);
      if (k > 0 && k < points - 1 && k % 5 == 2) continue;  // with holes
      curve.points.push_back({{}, Vec3(2 * std::cos(a), std::sin(a), 0), {}, 0.0});
    }
    beam.line = curve;
    h.push_back(1.0 / points);
    error.push_back(std::abs(make_reference_line(beam).length / quarter - 1));
  }
  EXPECT_LT(error.back(), 1e-12) << testing::PrintToString(error);
}

// At equal fractions of the length also where the spline's parameter is not the arc length (few points, low
// degree): |dr/ds| = 1. Detects places by the parameter.
TEST(Curve, PlacesAreFractionsOfTheLength) {
  BeamScene beam;
  Curve curve;
  for (const double x : {0.0, 0.5, 0.8, 2.0, 2.4})
    curve.points.push_back({{}, Vec3(x, std::sin(x), 0.1 * x * x), {}, 0.0});
  for (const int degree : {2, 3, 4}) {
    curve.degree = degree;
    beam.line = curve;
    const ReferenceLine line = make_reference_line(beam);
    for (const double s : {0.01, 0.2, 0.4, 0.65, 0.9}) {
      const Vec3 d = first_difference([&](double e) { return line.at(s + e).r; }, 1e-4);
      EXPECT_NEAR(d.norm() / line.length, 1.0, 1e-9) << degree << ", " << s;
    }
  }
}

// Two points are a straight beam; with a twist it is constant: K0 = (1 0 0; theta/L 0 0).
TEST(Curve, TwoPointsAreAStraightLine) {
  BeamScene curve, straight;
  const Vec3 from(1, 2, 3), to(2, 0, 5);
  straight.line = Straight{from, to};
  curve.line = Curve{{{{}, from, {}, 0.0}, {{}, to, {}, 0.0}}, 0};
  const ReferenceLine a = make_reference_line(straight), b = make_reference_line(curve);
  EXPECT_NEAR(a.length, b.length, 1e-15 * a.length);
  for (const double s : {0.0, 0.3, 1.0}) {
    EXPECT_LT((a.at(s).r - b.at(s).r).norm(), 1e-14);
    EXPECT_LT((a.at(s).R() - b.at(s).R()).norm(), 1e-14);
  }
  std::get<Curve>(curve.line).points[1].twist = 1.2;
  const ReferenceLine twisted = make_reference_line(curve);
  const SpectralTable table = spectral_table(4, Rule::gauss);
  std::vector<Pose<double>> pose;
  for (const double xi : table.nodes.points) pose.push_back(twisted.at(0.5 * (1 + xi)));
  const auto data =
      beam::make_data<GeodesicMetric, 0>(table, std::vector<double>(5, 0.5 * a.length), pose, 0, 0);
  for (std::size_t i = 0; i < table.rule.points.size(); ++i)
    EXPECT_LT((data.K0[i] - Vec6(1, 0, 0, 1.2 / a.length, 0, 0)).norm(), 1e-13);
}

// The same points turned and moved give the same line, turned and moved.
TEST(Curve, Objectivity) {
  Rng rng(8);
  Worst worst("error", 1e-12);
  for (int sample = 0; sample < 20; ++sample) {
    BeamScene here;
    here.order = 1 + sample % 3;  // more amplifies round-off
    here.normal = Vec3(0.1, 0.2, 1);
    Curve curve;
    for (int k = 0; k < 5 + sample; ++k) {
      CurvePoint p;
      p.at = Vec3(k, std::sin(0.4 * k), 0.05 * k * k) + random_vector<3>(rng, 1e-3);
      if (k % 3 == 0) p.normal = Vec3(0, 0.3, 1) + random_vector<3>(rng, 0.2);
      p.twist = 0.2 * k;
      curve.points.push_back(p);
    }
    here.line = curve;
    const Pose<double> G = random_pose(rng, 3.0);
    BeamScene there = here;
    there.normal = G.p * here.normal;
    for (CurvePoint& p : std::get<Curve>(there.line).points) {
      p.at = G * p.at;
      if (p.normal) p.normal = Vec3(G.p * *p.normal);
    }
    const ReferenceLine a = make_reference_line(here), b = make_reference_line(there);
    worst.add(std::abs(a.length - b.length) / a.length);
    for (const double s : {0.0, 0.2, 0.55, 1.0}) {
      const Pose<double> A = G * a.at(s), B = b.at(s);
      worst.add((A.r - B.r).norm() / a.length + (A.R() - B.R()).norm());
    }
  }
}

// ---- what cannot be a line --------------------------------------------------------------------

std::string message(const BeamScene& beam) {
  try {
    const ReferenceLine line = make_reference_line(beam);
    for (int k = 0; k <= 20; ++k) line.at(k / 20.0);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Curve, SaysWhatIsWrong) {
  const auto beam = [](std::vector<Vec3> points, int degree = 0) {
    BeamScene b;
    b.name = "b";
    Curve curve;
    curve.degree = degree;
    for (const Vec3& p : points) curve.points.push_back({{}, p, {}, 0.0});
    b.line = curve;
    return b;
  };
  const Vec3 O(0, 0, 0), X(1, 0, 0), Y(1, 1, 0), Z(0, 0, 1);
  const auto says = [](const BeamScene& b, const std::string& part) {
    EXPECT_NE(message(b).find(part), std::string::npos) << message(b);
  };
  EXPECT_EQ(message(beam({O, X, Y})), "no error");
  says(beam({O}), "has 1 <point>s; a curve needs two at least");
  says(beam({O, X, X, Y}), "points 2 and 3 are the same");
  says(beam({O, X, Y}, 3), "degree 3 is out of range; 3 points allow 1 to 2");
  says(beam({O, X, Y}, 1), "has corners");
  says(beam({O, X, Vec3(0.5, 0, 0)}), "turns back or stops near");
  says(beam({O, Z}), "the normal is along the curve at 0 of its length");
  BeamScene rough;  // 1 % of the distance, amplified by a degree of 11
  rough.name = "b";
  rough.order = 5;
  Rng rng(9);
  Curve line;
  for (int k = 0; k < 16; ++k)
    line.points.push_back({{}, Vec3(k, 0, 0) + random_vector<3>(rng, 0.01), {}, 0.0});
  rough.line = line;
  says(rough, "swings out between its points; give more points, to more digits, or a lower degree");
  BeamScene zero = beam({O, X, Y});
  std::get<Curve>(zero.line).points[1].normal = Vec3::Zero();
  says(zero, "point 2: the normal is zero");
}

}  // namespace
}  // namespace mbd::test::test_curves
