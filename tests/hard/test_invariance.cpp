// Case 8: a model gives the same wherever it stands, in whatever units and order it is written down, and however many
// runs go on beside it. Bounds come from the runs themselves (libmbd/study/trust/sameness.hpp): what another tolerance and a
// change in the twelfth digit make of the motion; where that is more than 1e-3, trajectories are not compared.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "libmbd/language/schema.hpp"
#include "libmbd/language/xml.hpp"
#include "libmbd/study/trust/sameness.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "solvers/newton/increments.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_invariance {
namespace {

namespace fs = std::filesystem;

// How much of each model is run; 0: all of it. Shortened so that about ten runs of each take a second or two.
struct Case {
  const char* model;  // of models/, or of tests/hard/models
  double duration;    // [s]
  bool slow;          // paths over many points
  // What it does is said in inertial axes and SI units (laws of sensors): it is neither moved nor rescaled.
  bool as_it_stands = false;
};
constexpr Case cases[] = {
    {"arch", 0, true},
    {"bend45", 0, false},
    {"bushing", 0, false},
    {"cart_pole", 2.0, false},  // of 10
    {"chain", 0, false},
    {"composite", 0, false},
    {"damped_oscillator", 0.25, false},  // of 1
    {"double_pendulum", 0, false},
    {"double_pendulum_beams", 1.0, false},  // of 2
    {"dzhanibekov", 5.0, false},            // of 10
    {"elastica", 0, false},
    {"every_joint", 0.5, false},  // of 2
    {"four_bar", 9.0, false},     // of 36
    {"four_bar_static", 0, false},
    {"free_beam", 5.0, false},         // of 15
    {"heavy_top", 0.5, false},         // of 2
    {"internal_damping", 0.1, false},  // of 0.8
    {"lee_frame", 0, true},
    {"pendulum", 0, false},
    {"portal_frame", 0, false},
    {"princeton", 0, false},
    {"right_angle_frame", 0, false},
    {"rigid_frame", 0, false},
    {"roll_up", 0, false},
    {"shaft", 0, false},
    {"shaken_oscillator", 2.0, false},  // of 5
    {"shallow_arch", 0, false},
    {"slider_crank", 0.04, false},  // of 0.25
    {"submerged_beam", 0, false},
    {"swept_cantilever", 0, false},
    {"terminal_velocity", 1.0, false},  // of 4
    {"torsion_pendulum", 1.0, false},   // of 5
    {"windows", 0.3, false},            // of 10: before its first singular configuration (case 2)
    // What those before leave out of the schema.
    {"every_attribute_beams", 0, false},
    {"every_attribute_control", 0, false, true},
    {"every_attribute_joints", 0, false},
    {"every_attribute_material", 0, false},
    {"every_attribute_path", 0, true},
};

TrialOptions limits() {
  TrialOptions options;
  options.samples = 50;
  options.repeats = 1;
  return options;
}

fs::path file_of(const Case& c) {
  const bool ours = std::string_view(c.model).starts_with("every_attribute");
  return fs::path(MBD_SOURCE_DIR) / (ours ? "tests/hard/models" : "models") /
         (std::string(c.model) + ".xml");
}

// Paths by a coarse mesh: it is the same one on both sides of a comparison. Read once: sections from material take a while.
const Scene& scene_of(const Case& c) {
  static std::map<std::string, Scene> all;
  if (const auto it = all.find(c.model); it != all.end()) return it->second;
  const bool coarse = c.model == std::string("arch") || c.model == std::string("lee_frame");
  const Overrides mesh{{"elements", c.model == std::string("arch") ? "8" : "4"}, {"order", "4"}};
  const Scene scene = without_inertial_marks(read_model(file_of(c), coarse ? mesh : Overrides{}));
  return all.emplace(c.model, c.duration > 0.0 ? shortened(scene, c.duration) : scene)
      .first->second;
}

const Twins& twins_of(const Case& c) {
  static std::map<std::string, std::unique_ptr<Twins>> all;
  std::unique_ptr<Twins>& one = all[c.model];
  if (!one) one = std::make_unique<Twins>(scene_of(c), limits());
  return *one;
}

double length_of(const Scene& scene) { return compile(scene).system->length_scale(); }

// The worst of all models, beside its bound.
struct Worst {
  double ratio = 0.0, difference = 0.0, bound = 0.0;
  std::string where;
  int compared = 0, whole = 0;

  void look(const Case& c, const Sameness& s) {
    ++compared;
    whole += s.whole ? 1 : 0;
    if (s.difference / s.bound < ratio) return;
    ratio = s.difference / s.bound;
    difference = s.difference;
    bound = s.bound;
    where = fmt::format("{}, {}", c.model, s.quantity);
  }
  std::string text() const {
    return fmt::format("{} at {}; {} models, {} to their end", hard::bounded(difference, bound),
                       where, compared, whole);
  }
};

enum class Whom { all, those_that_carry };

template <class Change, class Back>
void expect_same(bool slow, Whom whom, Worst& worst, const Change& change, const Back& back) {
  for (const Case& c : cases) {
    if (c.slow != slow || (c.as_it_stands && whom == Whom::those_that_carry)) continue;
    SCOPED_TRACE(c.model);
    const Twins& twins = twins_of(c);
    ASSERT_EQ(twins.failure(), "");
    const Trial run = run_trial(change(twins.scene()), limits());
    ASSERT_TRUE(run.complete) << run.failure;
    const Sameness same = twins.compare(back(run.findings, twins.scene()));
    EXPECT_TRUE(same.comparable);
    EXPECT_EQ(same.what, "");
    // Of roll_up, round-off of its axial forces turns the tip by 1.14e-9 of 1.09e-9 since elements are evaluated in packs
    // (6.6e-10 before), however far Newton's iterations go.
    const double share = std::string_view(c.model) == "roll_up" ? 1.2 : 1.0;
    EXPECT_LE(same.difference, share * same.bound) << same.quantity << " at " << same.at;
    worst.look(c, same);
  }
}

void expect_same_moved(bool slow, Worst& worst) {
  const auto motion = [](const Scene& scene) { return random_motion(7, length_of(scene)); };
  expect_same(
      slow, Whom::those_that_carry, worst,
      [&](const Scene& scene) { return moved(scene, motion(scene)).scene; },
      [&](const Findings& f, const Scene& scene) {
        std::vector<std::string> not_compared;
        const Findings back = moved_back(f, scene, motion(scene), not_compared);
        EXPECT_TRUE(not_compared.empty());
        return back;
      });
}

void expect_same_units(bool slow, Worst& worst, const UnitChange& units) {
  expect_same(
      slow, Whom::those_that_carry, worst,
      [&](const Scene& scene) { return rescaled(scene, units).scene; },
      [&](const Findings& f, const Scene& scene) { return rescaled_back(f, scene, units); });
}

constexpr UnitChange mm_t_s{1e3, 1e-3, 1.0};
constexpr UnitChange powers_of_ten[] = {{1e-5, 1e4, 1e2}, {1e6, 1e-6, 1e-3}};

TEST(InvarianceSlow, MovedRigidly) {
  Worst worst;
  expect_same_moved(false, worst);
  hard::record({"8a", "every model moved by a random rigid motion", "`mbd torture --trials motion`",
                "invariance", worst.text(), "8h: a mass 1e-4 heavier"});
}

TEST(InvarianceSlow, InMillimetresAndTonnes) {
  Worst worst;
  expect_same_units(false, worst, mm_t_s);
  hard::record({"8b", "every model in mm, t, s", "`mbd torture --trials units`", "invariance",
                worst.text(), "8h"});
}

TEST(InvarianceSlow, InPowersOfTen) {
  Worst worst;
  for (const UnitChange& units : powers_of_ten) expect_same_units(false, worst, units);
  hard::record({"8c", "every model in units of random powers of ten",
                "`mbd torture --trials units`", "invariance", worst.text(), "8h"});
}

TEST(InvarianceSlow, InAnotherOrder) {
  Worst worst;
  expect_same(
      false, Whom::all, worst, [](const Scene& scene) { return reordered(scene, 3); },
      [](const Findings& f, const Scene&) { return f; });
  hard::record({"8d", "parts of every model listed in another order",
                "`mbd torture --trials order`", "invariance", worst.text(), "8h"});
}

class Rows : public Observer {
 public:
  void accepted(const Sample& sample) override {
    rows.insert(rows.end(), sample.row.begin(), sample.row.end());
  }
  std::vector<double> rows;
};

TEST(InvarianceSlow, TwoRunsAtOnceAreOneToTheLastBit) {
  std::size_t numbers = 0;
  for (const Case& c : cases) {
    if (c.slow) continue;
    SCOPED_TRACE(c.model);
    Scene scene = scene_of(c);
    if (scene.transient) scene = shortened(scene, 0.3 * scene.transient->duration);
    Rows rows[3];
    const auto one = [&](std::size_t k) {
      const RunReport report = run(scene, {.output = {}, .observers = {&rows[k]}});
      EXPECT_TRUE(report.complete()) << report.failure;
    };
    std::thread first(one, 0), second(one, 1);
    first.join();
    second.join();
    one(2);
    ASSERT_FALSE(rows[0].rows.empty());
    numbers += rows[0].rows.size();
    for (const std::size_t k : {1U, 2U}) {
      ASSERT_EQ(rows[k].rows.size(), rows[0].rows.size());
      EXPECT_EQ(std::memcmp(rows[k].rows.data(), rows[0].rows.data(),
                            rows[0].rows.size() * sizeof(double)),
                0);
    }
  }
  hard::record({"8e", "1 and 2 threads: two runs of every model at once, and one alone",
                "`mbd torture --trials threads`", "bitwise equality",
                fmt::format("0 of {} numbers differ", numbers),
                "without the lock around MUMPS shallow_arch ends the program"});
}

// A state off the reference: nodes moved by about a hundredth of their spacing, multipliers of the size of the forces.
State random_state(const System& system, double spacing, double force, std::uint64_t seed) {
  Rng rng(seed);
  State state = system.reference_state();
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    Vec6 U = random_vector<6>(rng, 0.01);
    U.head<3>() *= spacing;
    state.pose[n] = state.pose[n] * exp_se3<double>(U);
    if (!state.V.empty()) state.V[n] = random_vector<6>(rng, 1.0);
    if (!state.Vdot.empty()) state.Vdot[n] = random_vector<6>(rng, 1.0);
  }
  for (Index i = 0; i < state.lambda.size(); ++i) state.lambda(i) = force * uniform(rng, -1.0, 1.0);
  return state;
}

double spacing_of(const Model& model) {
  double least = model.system->length_scale();
  const State reference = model.system->reference_state();
  for (const Model::Line& line : model.lines)
    for (std::size_t k = 1; k < line.size(); ++k)
      least = std::min(
          least, (line.pose(reference.pose, k).r - line.pose(reference.pose, k - 1).r).norm());
  return least;
}

// Residual and tangent a million metres away: round-off of positions is eps times the distance, and strains and
// directions know it over the spacing of nodes.
TEST(InvarianceSlow, ResidualAndTangentFarAway) {
  const RigidMotion far{Mat3::Identity(), Vec3(6e5, -6e5, 529150)};  // |shift| = 1e6 m
  const double distance = far.shift.norm();
  double worst = 0.0, single = 0.0;
  std::string where;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.model);
    const Scene scene = scene_of(c);
    const Model here = compile(scene), there = compile(moved(scene, far).scene);
    const System &a = *here.system, &b = *there.system;
    ASSERT_EQ(a.rows(), b.rows());
    const double L = a.length_scale(), spacing = spacing_of(here);
    DenseSolver A, B;
    A.analyze(a.graph());
    B.analyze(b.graph());
    VecX ra, rb;
    const TangentWeights weights{
        .U = 1.0, .V = scene.transient ? 1.0 : 0.0, .A = scene.transient ? 1.0 : 0.0, .T_inv = {}};
    State at = a.reference_state();
    a.linearize(at, weights, ra, A);
    const double k = std::max(largest_stiffness(a, A), 1e-3);
    at = random_state(a, spacing, 0.01 * k * spacing, 11);
    State moved_at = b.reference_state();  // with its own signals, of which there may be more
    moved_at.pose = at.pose;
    moved_at.V = at.V;
    moved_at.Vdot = at.Vdot;
    moved_at.lambda = at.lambda;
    moved_at.angles = at.angles;
    for (std::size_t n = 1; n < at.pose.size(); ++n) moved_at.pose[n].r += far.shift;
    ASSERT_TRUE(a.linearize(at, weights, ra, A));
    ASSERT_TRUE(b.linearize(moved_at, weights, rb, B));
    const double unit = eps * distance / spacing;
    const auto look = [&](double difference, double scale, const char* what) {
      const double ratio = difference / (unit * scale);
      if (!(ratio <= worst)) {
        worst = ratio;
        where = fmt::format("{}, {}", c.model, what);
      }
      EXPECT_LE(ratio, 100.0) << what;
    };
    for (Index i = 6; i < ra.size(); ++i) {
      const bool node = i < 6 * a.nodes();
      const double scale = !node ? L : k * spacing * (i % 6 < 3 ? 1.0 : L);
      look(std::abs(ra(i) - rb(i)), scale, node ? "force" : "constraint");
    }
    for (std::size_t i = 0; i < a.graph().contributions.size(); ++i) {
      const auto [row, column] = a.graph().contributions[i];
      if (row < 0 || column < 0) continue;
      const auto& R = a.graph().blocks[static_cast<std::size_t>(row)];
      const auto& C = a.graph().blocks[static_cast<std::size_t>(column)];
      const bool nodes = R.kind == BlockGraph::Kind::node && C.kind == BlockGraph::Kind::node;
      const Slot s = A.slots()[i], t = B.slots()[i];
      for (Index n = 0; n < C.size; ++n)
        for (Index m = 0; m < R.size; ++m) {
          const double units = (m < 3 ? 1.0 : L) * (n < 3 ? 1.0 : L);
          look(std::abs(s.data[n * s.ld + m] - t.data[n * t.ld + m]),
               nodes ? k * units : std::max(1.0, L), "tangent");
        }
    }
    // Positions from the origin in single precision.
    for (Pose<double>& H : moved_at.pose) H.r = Vec3(H.r.cast<float>().cast<double>());
    b.residual(moved_at, rb);
    for (Index i = 6; i < 6 * a.nodes(); ++i)
      single =
          std::max(single, std::abs(ra(i) - rb(i)) / (unit * k * spacing * (i % 6 < 3 ? 1.0 : L)));
  }
  EXPECT_GT(single, 1e4);
  hard::record({"8f", "residual and tangent of every model 1e6 m away", "in C++",
                "those at the origin",
                fmt::format("{:.2g} ε distance / node spacing (bound 100), {}", worst, where),
                fmt::format("positions in single precision: {:.0e} (in the test)", single)});
}

// Every model comes to its end there, and Newton's iterations see the floor: no more of them than at the origin, but
// for the few that round-off asks for.
TEST(InvarianceSlow, NewtonFindsItsFloorFarAway) {
  const RigidMotion far{Mat3::Identity(), Vec3(6e5, -6e5, 529150)};
  double most = 0.0;
  std::string where;
  for (const Case& c : cases) {
    if (c.slow) continue;
    SCOPED_TRACE(c.model);
    Scene scene = scene_of(c);
    if (scene.transient) scene = shortened(scene, 0.2 * scene.transient->duration);
    const RunReport here = run(scene), there = run(moved(scene, far).scene);
    ASSERT_TRUE(here.complete()) << here.failure;
    EXPECT_TRUE(there.complete()) << there.failure;
    const auto iterations = [](const RunReport& r) {
      return static_cast<double>(r.static_counters.iterations + r.transient_counters.iterations);
    };
    const double ratio = iterations(there) / iterations(here);
    if (ratio > most) {
      most = ratio;
      where = c.model;
    }
    EXPECT_LE(ratio, 3.0);
  }
  hard::record({"8g", "every model runs 1e6 m away", "`mbd torture --trials far`",
                "Newton's iterations at the origin",
                fmt::format("{:.2g} times as many (bound 3), {}", most, where),
                "Newton's floor without the farthest position (in the engine): 13 times"});
}

// An orientation is turned by that much and stays a rotation. Mutation: entries changed as those of an inertia are, symmetric.
TEST(Invariance, PerturbedOrientationsStayRotations) {
  const Scene scene = read_model_text(R"(<mbd name="m">
      <body name="b" at="1 0 0" orientation="0.3 0.4 0.5" mass="2" inertia="2 2 3 0.1 0.2 0.3"/>
      <gravity acceleration="0 0 -9.81"/><transient duration="1" step="0.01"/></mbd>)");
  const Scene other = perturbed(scene, 1e-3, 1);
  const Mat3 &before = scene.bodies[0].orientation, &after = other.bodies[0].orientation;
  EXPECT_LT((after.transpose() * after - Mat3::Identity()).norm(), 1e-14);
  EXPECT_LT((after - before).norm(), 3e-3);
  EXPECT_NE(other.bodies[0].inertia, scene.bodies[0].inertia);
  EXPECT_TRUE(compile(other).system);
}

// Adds element.attribute of all that stands in the file, and in those that it includes.
void add_attributes(const fs::path& file, std::set<std::string>& names) {
  const auto add = [&](const auto& self, const xml::Element& element) -> void {
    names.insert(element.name);
    for (const xml::Attribute& a : element.attributes) {
      names.insert(element.name + "." + a.name);
      if (element.name == "include") add_attributes(file.parent_path() / a.value, names);
    }
    for (const xml::Element& child : element.children) self(self, child);
  };
  add(add, xml::parse_file(file));
}

// An attribute that a model file may have stands in one of these scenes; a new one is added to the scenes every_attribute_*.
// Shown by any attribute taken out of them: base_motion.velocity, say.
TEST(Invariance, TrialsHaveEveryAttribute) {
  std::set<std::string> had, missed;
  for (const Case& c : cases) add_attributes(file_of(c), had);
  for (const schema::Element& element : schema::elements()) {
    if (element.name == "extension")
      continue;  // numbers of a plug-in, whose units nobody else knows
    if (!had.contains(std::string(element.name))) missed.insert(std::string(element.name));
    for (const schema::Attribute& a : element.attributes)
      if (const std::string name = std::string(element.name) + "." + std::string(a.name);
          !had.contains(name))
        missed.insert(name);
  }
  EXPECT_EQ(missed, std::set<std::string>());
}

// The comparison sees what it should: masses and loads changed in the fourth digit.
TEST(InvarianceSlow, ADifferenceInTheFourthDigitIsSeen) {
  int seen = 0, all = 0;
  std::string missed;
  for (const Case& c : cases) {
    if (c.slow) continue;
    SCOPED_TRACE(c.model);
    const Twins& twins = twins_of(c);
    const Trial run = run_trial(perturbed(twins.scene(), 1e-4, 5), limits());
    ++all;
    if (run.complete && twins.compare(run.findings).same())
      missed += std::string(missed.empty() ? "" : ", ") + c.model;
    else
      ++seen;
  }
  EXPECT_EQ(missed, "");
  hard::record({"8h", "numbers of every model changed in the fourth digit are seen", "in C++",
                "the bounds of 8a to 8d", fmt::format("{} of {} models", seen, all),
                "bounds that are too wide"});
}

// Paths over many points. Not moved: steps of a path are measured in the size of the scene, the diagonal of its box
// along the inertial axes, so that a turned path with a given number of points goes another way along the curve.
TEST(InvarianceSlow, Paths) {
  Worst worst;
  expect_same_units(true, worst, mm_t_s);
  expect_same(
      true, Whom::all, worst, [](const Scene& scene) { return reordered(scene, 3); },
      [](const Findings& f, const Scene&) { return f; });
  hard::record({"8i", "arch and lee_frame: in mm, t, s, and in another order",
                "`mbd torture models/arch.xml`", "invariance", worst.text(), "8h"});
}

}  // namespace
}  // namespace mbd::test::test_invariance
