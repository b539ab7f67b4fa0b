// Large, small and very many rotations.
//
// A thousand turns of a shaft against its steady whirl; joints carried through several half turns about random axes
// against closed forms; a loaded cantilever turned by whole turns about any axis, whose shape must not notice;
// rotations down to 1e-14 in relative terms; elements bent towards and beyond the range of their metric.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elements/metrics.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/hard/whirl.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_rotations {
namespace {

using std::numbers::pi;

TEST(Turns, AThousandOfTheShaft) {
  const Scene scene =
      read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / "hard" / "thousand_turns.xml");
  const History h = run_to_table(scene, 20020);
  ASSERT_TRUE(h.report.complete()) << h.report.failure;
  const PlaneBeam beam{1.449e5, 1.623e7, 1.93, 2.227e-3, 900.0, 1.0};
  const double w = whirl(beam, 6.0, 40.0, 1e-4);
  const double u2 = h.table["M.displacement.2"].back(), u3 = h.table["M.displacement.3"].back(),
               angle = h.table["drive.angle"].back(), free = h.table["T.angle"].back();
  const double error = std::hypot(u2, u3 - w) / w,
               turned = std::max(std::abs(angle - 2000 * pi), std::abs(free - 2000 * pi));
  EXPECT_LE(error, 1e-7);
  EXPECT_LE(turned, 1e-11);
  hard::record({.id = "3a",
                .what = "a thousand turns of a shaft with an eccentric disk",
                .run = "`mbd run models/hard/thousand_turns.xml`",
                .reference = "steady whirl of the linear shaft with shear; 2000 pi",
                .error = "place of the disk " + hard::bounded(error, 1e-7) +
                         " of its deflection, angles " + hard::bounded(turned, 1e-11) + " rad",
                .shown = "angles not followed (in the engine): 2000 pi off"});
}

std::string text(const Vec3& x) { return fmt::format("{:.17g} {:.17g} {:.17g}", x(0), x(1), x(2)); }

Vec3 place(const Table& t, const std::string& name) {
  return {t[name + ".position.1"].back(), t[name + ".position.2"].back(),
          t[name + ".position.3"].back()};
}
Quaternion<double> turn(const Table& t, const std::string& name) {
  return exp_so3<double>(Vec3(t[name + ".rotation.1"].back(), t[name + ".rotation.2"].back(),
                              t[name + ".rotation.3"].back()));
}
double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
  return log_so3<double>(a.conjugate() * b).norm();
}

// A rotor that turns by up to 10 rad in a step: its angle must count all turns, by each method.
TEST(Turns, ThatAreLongerThanAStep) {
  double worst = 0.0;
  int refused = 0;
  for (const double rate : {10.0, 30.0, 32.0, 50.0, 62.8, 100.0, 1000.0})
    for (const char* method : {"generalized_alpha", "radau"}) {
      const History h = run_to_table(read(fmt::format(
          R"(<body name="rotor" mass="1" inertia="1 1 1" angular_velocity="0 0 {}"/>
             <body name="other" mass="1" inertia="1 1 1" angular_velocity="0 0 {}"/>
             <revolute name="A" between="ground rotor" axis="0 0 1"/>
             <revolute name="B" between="ground other" axis="0 0 1"/>
             <transient duration="10" step="0.1" method="{}"/><record name="A" joint="A" quantities="angle"/>
             <record name="B" joint="B" quantities="angle"/>)",
          rate, -0.7 * rate, method)));
      if (h.report.complete()) {
        worst = std::max({worst, std::abs(h.table["A.angle"].back() - 10 * rate) / rate,
                          std::abs(h.table["B.angle"].back() + 7 * rate) / rate});
      } else {
        ++refused;
        EXPECT_NE(h.report.failure.find("body 'rotor' turns by more than"), std::string::npos)
            << h.report.failure;
        EXPECT_GT(rate, 48.0 / 0.1 - 1);  // more than 32 times 1.5 rad
      }
    }
  EXPECT_LE(worst, 1e-9);
  EXPECT_EQ(refused, 2);
  hard::record({.id = "3h",
                .what = "rotors that turn by 1 … 100 rad in a fixed step, both methods",
                .run = "in C++",
                .reference = "even rotation",
                .error = hard::bounded(worst, 1e-9) + " of the angle; at 100 rad refused by name",
                .shown = "long turns accepted (in the engine): whole turns lost"});
}

// Two turns and a half of each joint, and of what carries it.
TEST(TurnsSlow, OfJointsInEveryDirection) {
  constexpr double duration = 1.0, full = 5 * pi;
  double worst[2] = {0.0, 0.0};
  int mechanisms = 0;
  Rng rng(34);
  for (int trial = 0; trial < 2; ++trial) {
    // Of each mechanism: where it stands, its axis, and the axis about which its base turns.
    std::string model;
    struct Expected {
      std::string body;
      Vec3 r;
      Quaternion<double> p;
    };
    std::vector<Expected> expected;
    struct Angle {
      std::string column;
      double value;
    };
    std::vector<Angle> angles;
    int n = 0;
    const auto base = [&](const std::string& kind, const Vec3& at, const Vec3& axis) {
      ++n;
      ++mechanisms;
      model += fmt::format(
          R"(<body name="base_{0}" at="{1}" mass="1" inertia="1 1 1"/>
             <motion name="motion_{0}" of="base_{0}" displacement="0 0 0" axis="{2}" angle="{3:.17g}*(1-cos(pi*t))/2"/>)",
          kind, text(at), text(axis), full);
    };
    const auto body = [&](const std::string& kind, const Vec3& at, const std::string& more = {}) {
      model += fmt::format(
          R"(<body name="{0}" at="{1}" mass="2" inertia="0.4 0.4 0.4" {2}/><record name="{0}" at="{0}" quantities="position rotation"/>)",
          kind, text(at), more);
    };
    const auto spin = [&] { return random_direction(rng); };
    const auto where = [&] { return Vec3(random_vector<3>(rng, 5.0)); };
    // Carried rigidly, or driven about and along its own axis e, by the base that turns about f: R(f) R(e).
    for (const std::string kind :
         {"fixed", "rigid_link", "revolute", "cylindrical", "screw", "prismatic", "planar"}) {
      const Vec3 o = where(), e = spin(), f = spin(), arm = 0.5 * spin();
      base(kind, o, f);
      body(kind, o + arm);
      const bool turns =
          kind == "revolute" || kind == "cylindrical" || kind == "screw" || kind == "planar";
      const bool slides = kind == "cylindrical" || kind == "prismatic";
      model += fmt::format(
          R"(<{0} name="j_{0}" between="base_{0} {0}" {1} at="{2}" {3}/>)", kind,
          kind == "fixed" || kind == "rigid_link" ? "" : fmt::format(R"(axis="{}")", text(e)),
          text(o), kind == "screw" ? R"(pitch="0.1")" : "");
      if (turns) {
        model += fmt::format(
            R"(<drive joint="j_{0}" angle="{1:.17g}*(1-cos(pi*t))/2"/><record name="c_{0}" joint="j_{0}" quantities="angle"/>)",
            kind, -full);
        angles.push_back({"c_" + kind + ".angle", -full});
      }
      if (slides)
        model += fmt::format(R"(<drive joint="j_{}" displacement="0.3*sin(pi*t/2)^2"/>)", kind);
      const Quaternion<double> F = rotation(full, f), E = rotation(turns ? -full : 0.0, e);
      const double slide = slides ? 0.3 : kind == "screw" ? 0.1 * -full / (2 * pi) : 0.0;
      if (kind == "planar") {
        // Slides freely in its plane: held to its normal and its angle only.
        expected.push_back({kind, Vec3::Constant(std::nan("")), F * E});
      } else {
        expected.push_back({kind, o + F * Vec3(E * arm + slide * e), F * E});
      }
    }
    // Free to turn, about its centre, with the same inertia about all axes: spins evenly.
    {
      const Vec3 o = where(), w = full * spin();
      ++mechanisms;
      body("spherical", o, fmt::format(R"(angular_velocity="{}")", text(w)));
      model +=
          fmt::format(R"(<spherical name="j_s" between="ground spherical" at="{}"/>)", text(o));
      expected.push_back({"spherical", o, exp_so3<double>(w)});
    }
    {
      // Both angles of a universal joint grow evenly: their kinetic energies do not mix.
      const Vec3 o = where(), a = spin(), b = a.cross(spin()).normalized();
      const double alpha = full, beta = -0.8 * full;
      ++mechanisms;
      body("universal", o, fmt::format(R"(angular_velocity="{}")", text(alpha * a + beta * b)));
      model += fmt::format(
          R"(<universal name="j_u" between="ground universal" at="{}" axis="{}" second_axis="{}"/>)",
          text(o), text(a), text(b));
      expected.push_back({"universal", o, rotation(alpha, a) * rotation(beta, b)});
    }
    {
      // A ball on a rod about a fixed point, even rotation in a plane; it spins about any axis.
      const Vec3 o = where(), a = spin(), x = a.cross(spin()).normalized(), w = full * spin();
      ++mechanisms;
      body("distance", o + 0.7 * x,
           fmt::format(R"(velocity="{}" angular_velocity="{}")",
                       text(full * a.cross(Vec3(0.7 * x))), text(w)));
      model +=
          fmt::format(R"(<distance name="j_d" between="ground distance" at_a="{}"/>)", text(o));
      expected.push_back({"distance", o + rotation(full, a) * Vec3(0.7 * x), exp_so3<double>(w)});
    }
    {
      // A line on a body that spins through a fixed point on it: nothing slides.
      const Vec3 o = where(), w = full * spin();
      ++mechanisms;
      body("point_on_line", o, fmt::format(R"(angular_velocity="{}")", text(w)));
      model += fmt::format(
          R"(<point_on_line name="j_p" between="ground point_on_line" at="{}" axis="{}"/>)",
          text(o), text(spin()));
      expected.push_back({"point_on_line", o, exp_so3<double>(w)});
    }
    for (int method = 0; method < 2; ++method) {
      const History h = run_to_table(
          read(model + fmt::format(R"(<transient duration="{}" {}/>)", duration,
                                   method == 0 ? R"(method="radau" tolerance="1e-10")"
                                               : R"(step="1e-3" rho_infinity="0.9")")));
      ASSERT_TRUE(h.report.complete()) << h.report.failure;
      for (const Expected& e : expected) {
        double error = angle_between(e.p, turn(h.table, e.body));
        if (e.r.allFinite()) error = std::max(error, (place(h.table, e.body) - e.r).norm());
        EXPECT_LE(error, method == 0 ? 3e-6 : 3e-3)
            << e.body << " trial " << trial << " method " << method;
        worst[method] = std::max(worst[method], error);
      }
      for (const Angle& a : angles)
        EXPECT_NEAR(h.table[a.column].back(), a.value, 1e-9) << a.column;
    }
  }
  hard::record(
      {.id = "3b",
       .what = fmt::format(
           "{} joints of every type through two and a half turns about random axes, on bases "
           "that turn as far",
           mechanisms),
       .run = "`mbd run models/hard/turning_joints.xml` (one of each)",
       .reference = "composition of the laws; free spin",
       .error = "radau " + hard::bounded(worst[0], 3e-6) + ", generalized-alpha " +
                hard::bounded(worst[1], 3e-3) + " (m, rad)",
       .shown = "angles not followed (in the engine): the screw is 0.2 m off"});
}

// The root of a cantilever under a follower force is turned by a load step at a time, through 3 pi about any axis.
TEST(Turns, OfAClampedBeamInEveryDirection) {
  double worst = 0.0;
  Rng rng(35);
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms) {
      const auto bent = [&](const Vec3& rotation, const Vec3& along, const Vec3& normal) {
        Scene scene = read(fmt::format(
            R"(<section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="0.8" EI2="1" EI3="2"/></section>
               <beam name="b" section="s" from="0 0 0" to="{}" normal="{}" elements="3"/>
               <motion name="root" of="b.start" displacement="0 0 0" rotation="{}"/>
               <load at="b.end" follower_force="0 1 2"/><static steps="10"/>
               <record name="tip" at="b.end" quantities="position rotation"/><record name="root" at="b.start" quantities="rotation moment"/>)",
            text(along), text(normal), text(rotation)));
        return run_to_table(with(scene, metric, form));
      };
      for (int trial = 0; trial < 3; ++trial) {
        const Vec3 along = random_direction(rng),
                   normal = along.cross(random_direction(rng)).normalized();
        const double angle = trial == 0 ? 3 * pi : uniform(rng, 0.9 * pi, 3 * pi);
        const Vec3 psi = angle * random_direction(rng);
        const History still = bent(Vec3::Zero(), along, normal), turned = bent(psi, along, normal);
        ASSERT_TRUE(still.report.complete()) << still.report.failure;
        ASSERT_TRUE(turned.report.complete())
            << turned.report.failure << ", along " << text(along) << ", normal " << text(normal)
            << ", turned " << text(psi) << ", " << name_of(metric) << " " << name_of(form);
        const Quaternion<double> R = exp_so3<double>(psi);
        double error = (place(turned.table, "tip") - R * place(still.table, "tip")).norm();
        error =
            std::max(error, angle_between(turn(turned.table, "tip"), R * turn(still.table, "tip")));
        for (const char* m : {"root.moment.1", "root.moment.2", "root.moment.3"})
          error = std::max(error, std::abs(turned.table[m].back() - still.table[m].back()));
        worst = std::max(worst, error);
      }
    }
  EXPECT_LE(worst, 1e-9);
  hard::record(
      {.id = "3c",
       .what = "a loaded cantilever turned at its root by up to 3 pi about random axes; "
               "metrics and forms",
       .run = "in C++",
       .reference = "the same, not turned: invariance",
       .error = hard::bounded(worst, 1e-9) + " (m, rad, N.m)",
       .shown = "directions accepted where tr R > 0 (in the engine): a third of a turn off"});
}

// --- small rotations ---

using Long = long double;
Long relative_error(const Vec6& x, const Vector6<Long>& y) {
  const auto part = [](const Vector3<Long>& a, const Vector3<Long>& b) {
    return b.norm() > 0 ? (a - b).norm() / b.norm() : a.norm();
  };
  const Vector6<Long> X = x.cast<Long>();
  return std::max(part(X.head<3>(), y.head<3>()), part(X.tail<3>(), y.tail<3>()));
}

// exp and log written out by their definitions, in long double: exp of a 4x4 matrix by scaling and squaring would lose
// small angles; its power series does not.
Pose<Long> series_exp(const Vector6<Long>& U) {
  // R - I = sum psi~^k/k!, r = sum psi~^k u/(k+1)!: of the quaternion, sine and cosine series.
  const Vector3<Long> u = U.head<3>(), psi = U.tail<3>();
  Vector3<Long> r = u, term = u;
  for (int k = 1; k < 80; ++k) {
    term = psi.cross(term) / static_cast<Long>(k + 1);
    r += term;
  }
  const Long y = psi.squaredNorm() / 4;
  Long c = 0, s = 0, power = 1;
  // cos = sum (-y)^k/(2k)!, sin(x)/x = sum (-y)^k/(2k+1)!
  for (int k = 0; k < 40; ++k) {
    c += power;
    s += power / static_cast<Long>(2 * k + 1);
    power *= -y / (static_cast<Long>(2 * k + 1) * static_cast<Long>(2 * k + 2));
  }
  return {Quaternion<Long>(c, s * psi(0) / 2, s * psi(1) / 2, s * psi(2) / 2), r};
}

template <class Metric>
void relative_parameters(Rng& rng, Worst& worst) {
  for (int k = 0; k < 2000; ++k) {
    const double angle = log_uniform(rng, 1e-14, Metric::max_angle);
    Vec6 U;
    U << random_vector<3>(rng), angle * random_direction(rng);
    const Pose<Long> exact = series_exp(U.cast<Long>());
    const Pose<double> g{
        Quaternion<double>(static_cast<double>(exact.p.w()), static_cast<double>(exact.p.x()),
                           static_cast<double>(exact.p.y()), static_cast<double>(exact.p.z())),
        exact.r.cast<double>()};
    // q in long double by the kernel's own text is of the same formulas: only round-off is measured here.
    const typename Metric::template Pair<double> pair(g);
    const typename Metric::template Pair<Long> fine(g.cast<Long>());
    worst.add(static_cast<double>(relative_error(pair.q(), fine.q())),
              fmt::format("{} at {:.2e}", Metric::name, angle));
  }
}

TEST(SmallAngles, OfExponentialLogarithmAndParameters) {
  Rng rng(36);
  double reached = 0.0, uncoupled = 0.0;
  {
    Worst exponential("exp", 2e-15), logarithm("log", 4e-15), parameters("q", 1e-14),
        back("T", 1e-14);
    for (int k = 0; k < 20000; ++k) {
      const double angle = log_uniform(rng, 1e-14, 0.9 * pi);
      Vec6 U;
      U << random_vector<3>(rng), angle * random_direction(rng);
      const Pose<double> H = exp_se3<double>(U);
      const Pose<Long> exact = series_exp(U.cast<Long>());
      const Vector3<Long> e = exact.p.vec();
      exponential.add(
          static_cast<double>((Vector3<Long>(H.p.vec().cast<Long>()) - e).norm() / e.norm() +
                              (Vector3<Long>(H.r.cast<Long>()) - exact.r).norm() / exact.r.norm()),
          fmt::format("{:.2e}", angle));
      // The exponential without what rotation does to translation.
      const Vector3<Long> u = U.head<3>().cast<Long>();
      uncoupled = std::max(uncoupled, static_cast<double>((u - exact.r).norm() / exact.r.norm()));
      logarithm.add(static_cast<double>(relative_error(log_se3<double>(H), U.cast<Long>())),
                    fmt::format("{:.2e}", angle));
      const Vec6 x = random_vector<6>(rng);
      back.add((T_times<double>(U, T_inverse_times<double>(U, x)) - x).norm() / x.norm(),
               fmt::format("{:.2e}", angle));
    }
    relative_parameters<MatrixMetric>(rng, parameters);
    relative_parameters<QuaternionMetric>(rng, parameters);
    relative_parameters<GeodesicMetric>(rng, parameters);
    reached = std::max({exponential.worst(), logarithm.worst(), parameters.worst()});
  }
  EXPECT_GT(uncoupled, 0.1);
  hard::record({.id = "3d",
                .what = "exp, log, T and motion parameters at angles log-uniform in 1e-14 … 0.9 pi",
                .run = "in C++",
                .reference = "power series in long double",
                .error = hard::bounded(reached, 1e-14) + ", relative, linear and angular part each",
                .shown = fmt::format("exp without its coupling: {:.0e} (in the test)", uncoupled)});
}

// A cantilever bent and twisted by end moments into a small rotation: relative to the closed form.
TEST(SmallAngles, OfACantilever) {
  Rng rng(37);
  double worst = 0.0, stiffer = 0.0;
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      for (int power = -14; power <= -2; power += 2) {
        const double theta = std::pow(10.0, power) * uniform(rng, 1, 9);
        Scene scene = read(fmt::format(
            R"(<section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="3" EI2="2" EI3="5"/></section>
               <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
               <fixed name="clamp" between="ground b.start"/><load at="b.end" moment="0 0 {:.17g}"/><static/>
               <record name="tip" at="b.end" quantities="displacement rotation"/>)",
            5 * theta / 2));
        const History h = run_to_table(with(scene, metric, form));
        ASSERT_TRUE(h.report.complete()) << h.report.failure;
        // Arc of angle theta: deflection 2 (1 - cos theta)/theta = 4 sin^2(theta/2)/theta.
        const double u = 4 * std::pow(std::sin(theta / 2), 2) / theta;
        const double error = std::max(std::abs(h.table["tip.rotation.3"].back() / theta - 1.0),
                                      std::abs(h.table["tip.displacement.2"].back() / u - 1.0));
        EXPECT_LE(error, 1e-8) << name_of(metric) << " " << name_of(form) << " theta " << theta;
        worst = std::max(worst, error);
        scene.sections[0].stiffness(5, 5) *= 1.1;
        const History other = run_to_table(with(scene, metric, form));
        stiffer = std::max(stiffer, std::abs(other.table["tip.rotation.3"].back() / theta - 1.0));
      }
  EXPECT_LE(worst, 1e-8);
  EXPECT_GT(stiffer, 0.05);
  hard::record({.id = "3e",
                .what = "cantilever bent by 1e-14 … 1e-2 rad, metrics and forms",
                .run = "in C++",
                .reference = "circular arc",
                .error = hard::bounded(worst, 1e-8) + " of rotation and deflection each",
                .shown = fmt::format("EI3 + 10 %: {:.0e} (in the test)", stiffer)});
}

// --- the range of the metrics ---

// One element of order N, bent by an end moment to `share` of its metric's limit: the arc, or "more elements".
TEST(Range, NearTheLimitOfTheMetric) {
  double worst = 0.0;
  int answered = 0, refused = 0;
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      for (int order = 3; order <= 6; ++order)
        for (double share = 0.8; share < 1.21; share += 0.05) {
          const double limit =
              metric == Metric::matrix ? MatrixMetric::max_angle : GeodesicMetric::max_angle;
          const double theta = share * limit;
          Scene scene = read(fmt::format(
              R"(<section name="s"><stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="3" EI2="2" EI3="5"/></section>
                 <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" order="{}"/>
                 <fixed name="clamp" between="ground b.start"/><load at="b.end" moment="0 0 {:.17g}"/><static steps="20"/>
                 <record name="tip" at="b.end" quantities="displacement rotation"/>)",
              order, 5 * theta));
          const History h = run_to_table(with(scene, metric, form));
          const std::string what =
              fmt::format("{} {} order {} at {:.2f} of the limit: {}", name_of(metric),
                          name_of(form), order, share, h.report.failure);
          if (h.report.complete()) {
            ++answered;
            const double x = std::sin(theta) / theta - 1.0, y = (1 - std::cos(theta)) / theta;
            const double error = std::hypot(h.table["tip.displacement.1"].back() - x,
                                            h.table["tip.displacement.2"].back() - y);
            // Geodesic: an arc is exact. The others converge with the order; near their limits few digits are left.
            EXPECT_LE(error, metric == Metric::geodesic ? 1e-9 : 0.05) << what;
            EXPECT_LE(share, 1.0 + 0.06) << what;
            worst = std::max(worst, metric == Metric::geodesic ? error : 0.0);
          } else {
            ++refused;
            EXPECT_NE(h.report.failure.find("give the beam more elements"), std::string::npos)
                << what;
            EXPECT_GT(h.report.rows, 1) << what;
          }
          if (share < 0.94) {
            EXPECT_TRUE(h.report.complete()) << what;
          }
          if (share > 1.01 && metric == Metric::geodesic) {
            EXPECT_FALSE(h.report.complete()) << what;
          }
        }
  EXPECT_GT(answered, 0);
  EXPECT_GT(refused, 0);
  hard::record(
      {.id = "3f",
       .what = "an element bent to 0.8 … 1.2 of its metric's limit, metrics, forms, orders 3 … 6",
       .run = "in C++",
       .reference = "circular arc",
       .error = fmt::format(
           "{} answered (geodesic metric {:.0e} m, bound 1e-9), {} refused with \"more elements\"",
           answered, worst, refused),
       .shown = "range not tested (in the engine): wrong by up to 1 m"});
}

// In motion: a moment that grows bends the element out of its range; the run ends there and keeps its rows.
TEST(Range, InMotion) {
  int ended = 0;
  for (const Metric metric : all_metrics)
    for (const char* how : {R"(step="2e-3")", R"(method="radau" step="2e-3")",
                            R"(method="radau" tolerance="1e-5")"}) {
      const double limit =
          metric == Metric::matrix ? MatrixMetric::max_angle : GeodesicMetric::max_angle;
      const auto scene = [&](int elements) {
        return with(
            read(fmt::format(
                R"x(<section name="s"><stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="3" EI2="2" EI3="5"/>
                           <mass per_length="0.1" inertia="2e-4 1e-4 1e-4"/></section>
                           <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="{}"/>
                           <fixed name="clamp" between="ground b.start"/><load at="b.end" moment="0 0 {:.17g}*t^2*(3-2*t)"/>
                           <transient duration="1" {}/><record name="tip" at="b.end" quantities="displacement rotation"/>)x",
                elements, 5 * 1.3 * limit, how)),
            metric, Form::energy);
      };
      const History one = run_to_table(scene(1)), four = run_to_table(scene(4));
      EXPECT_FALSE(one.report.complete()) << name_of(metric) << how;
      EXPECT_NE(one.report.failure.find("give the beam more elements"), std::string::npos)
          << one.report.failure;
      EXPECT_GT(one.report.t, 0.5);
      EXPECT_LT(one.report.t, 0.9);
      EXPECT_GT(one.report.rows, 10);
      EXPECT_TRUE(four.report.complete()) << four.report.failure;
      ended += one.report.complete() ? 0 : 1;
      // What is kept lies within the range, and is right: rows up to half of the load against four elements.
      const std::vector<double>& t = one.table["time"];
      const std::vector<double>&x = one.table["tip.displacement.2"],
            &y = four.table["tip.displacement.2"];
      for (std::size_t i = 0; i < t.size() && t[i] <= 0.4; ++i)
        EXPECT_NEAR(x[i], y[i], 0.03) << name_of(metric);
    }
  hard::record(
      {.id = "3g",
       .what = "an element bent out of its metric's range in motion, three integrations",
       .run = "in C++",
       .reference = "four elements: to the end",
       .error = fmt::format("{} of 9 end by name with \"more elements\", rows kept", ended),
       .shown = "range not tested (in the engine): no end by name"});
}

}  // namespace
}  // namespace mbd::test::test_rotations
