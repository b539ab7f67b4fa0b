// Records within elements: they leave the mesh and all other columns alone, and are of the order of the
// interpolation.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/scene/places.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_records {
namespace {

namespace fs = std::filesystem;

// ---- records leave the rest alone --------------------------------------------------------------

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(MBD_SOURCE_DIR) / "models"))
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

// The first few steps or points of a model.
Scene start_of(Scene scene) {
  if (scene.transient) {
    TransientScene& t = *scene.transient;
    t.output.reset();
    t.duration = t.step ? std::min(t.duration, 20 * *t.step) : 0.02 * t.duration;
  }
  if (scene.path) scene.path->points = std::min(scene.path->points, 8);
  return scene;
}

// All quantities of a place in each beam that has no node there.
Scene with_records(Scene scene) {
  for (const BeamScene& beam : scene.beams) {
    RecordScene record{
        {}, "within_" + beam.name, Place{Place::Kind::beam, beam.name, 0.37}, {}, {}};
    for (const schema::Quantity& q : schema::place_quantities())
      if (!q.of_section_point() &&
          (q.of == schema::Quantity::Of::any_place || rigid_with(scene, beam.name) == nullptr))
        record.quantities.emplace_back(q.name);
    scene.records.push_back(std::move(record));
  }
  return scene;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

class Records : public testing::TestWithParam<std::string> {};

TEST_P(Records, ChangeNothingElse) {
  const Scene scene = start_of(model_scene(GetParam())), recorded = with_records(scene);
  const mbd::test::History before = run_to_table(scene), after = run_to_table(recorded);
  EXPECT_EQ(after.report.failure, before.report.failure);
  EXPECT_EQ(after.report.unknowns, before.report.unknowns);
  EXPECT_EQ(after.report.nodes, before.report.nodes);
  ASSERT_GT(before.table.columns.at(0).size(), 1u);
  ASSERT_LE(before.table.names.size(), after.table.names.size());
  EXPECT_EQ(after.table.names.size() > before.table.names.size(), !scene.beams.empty());
  for (std::size_t c = 0; c < before.table.names.size(); ++c) {
    ASSERT_EQ(before.table.names[c], after.table.names[c]);
    EXPECT_TRUE(same_bits(before.table.columns[c], after.table.columns[c]))
        << before.table.names[c];
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Records, testing::ValuesIn(all_models()),
                         [](const auto& model) { return model.param; });

// ---- what they are -----------------------------------------------------------------------------

struct Kind {
  std::string name, attributes;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }
std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (const Metric metric : all_metrics)
    for (const char* const rule : {"gauss", "gauss_lobatto"})
      all.push_back({name_of(metric) + "_" + rule,
                     fmt::format(R"(metric="{}" rule="{}")", name_of(metric), rule)});
  for (const char* const rule : {"gauss", "gauss_lobatto"})
    all.push_back({std::string("classical_") + rule,
                   fmt::format(R"(kinematics="classical" rule="{}")", rule)});
  return all;
}

class Within : public testing::TestWithParam<Kind> {};

Vec3 last(const Table& table, const std::string& column) {
  return {table[column + ".1"].back(), table[column + ".2"].back(), table[column + ".3"].back()};
}

// A bar bent and twisted in space, stubby so that elements of order 1 do not lock; `place` of it is recorded.
Scene cantilever(const std::string& attributes, int order, int elements, const std::string& place) {
  return read_model_text(fmt::format(
      R"(<mbd name="cantilever"><section name="s"><stiffness EA="300" GA2="100" GA3="100" GJ="2" EI2="3" EI3="2"/></section>
         <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" order="{}" elements="{}" {}/>
         <fixed name="clamp" between="ground b.start"/>
         <load at="b.end" force="0 1 -3" moment="0.5 0 1"/> <static steps="4"/>
         <record name="P" at="{}" quantities="position displacement rotation force moment"/></mbd>)",
      order, elements, attributes, place));
}

// A third of the length lies at the same distance from the middle of an element of 2, 4, 8 and 16 equal ones, and at the
// end of one of 9. There is a node in a mesh so fine that its errors are round-off.
TEST_P(Within, ConvergesAtItsOrder) {
  static const Table exact =
      run_to_table(cantilever(R"(metric="geodesic")", 8, 9, fmt::format("b@{:.17g}", 1.0 / 3)))
          .table;
  for (const int order : {1, 2, 3}) {
    std::vector<double> h, position, rotation;
    for (const int elements : {16, 32, 64}) {
      const Table table = run_to_table(cantilever(GetParam().attributes, order, elements,
                                                  fmt::format("b@{:.17g}", 1.0 / 3)))
                              .table;
      h.push_back(1.0 / elements);
      position.push_back((last(table, "P.position") - last(exact, "P.position")).norm());
      rotation.push_back((last(table, "P.rotation") - last(exact, "P.rotation")).norm());
    }
    RecordProperty(fmt::format("position_{}", order),
                   fmt::format("{:.2f}", fitted_order(h, position)));
    RecordProperty(fmt::format("rotation_{}", order),
                   fmt::format("{:.2f}", fitted_order(h, rotation)));
    EXPECT_GT(fitted_order(h, position), order + 0.8) << order;
    EXPECT_GT(fitted_order(h, rotation), order + 0.8) << order;
    EXPECT_LT(position.back(), order == 1 ? 2e-3 : order == 2 ? 2e-5 : 1e-6) << order;
  }
}

// What is recorded close to a node is what is recorded at it.
TEST_P(Within, TendsToTheNode) {
  for (const int order : {1, 3, 5}) {
    const auto at = [&](const std::string& place) {
      return run_to_table(cantilever(GetParam().attributes, order, 2, place)).table;
    };
    const Table node = at("b@0.5"), left = at("b@0.49999999"), right = at("b@0.50000001");
    for (const Table* const near : {&left, &right})
      for (const char* const quantity : {"P.position", "P.displacement", "P.rotation"})
        EXPECT_LT((last(*near, quantity) - last(node, quantity)).norm(), 1e-6) << quantity;
    // Of two elements' resultants a node has the mean.
    for (const char* const quantity : {"P.force", "P.moment"}) {
      const Vec3 mean = 0.5 * (last(left, quantity) + last(right, quantity));
      EXPECT_LT((mean - last(node, quantity)).norm(), 1e-5) << quantity;
    }
  }
}

// A bar swung by its root, bending as it goes; started smoothly, so that its elements resolve the motion.
Scene swung(const std::string& attributes, int order, int elements, const std::string& place,
            double step = 2e-4) {
  return read_model_text(fmt::format(
      R"(<mbd name="swung"><section name="s"><stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="20" EI2="30" EI3="20"/>
           <mass per_length="1" inertia="2e-3 1e-3 1e-3"/></section>
         <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" order="{}" elements="{}" {}/>
         <revolute name="O" between="ground b.start" axis="0 0.6 0.8"/> <drive joint="O" angle="100*t^4"/>
         <transient duration="0.2" step="{}" method="radau" newton_tolerance="1e-13"/>
         <record name="P" at="{}" quantities="position rotation velocity angular_velocity acceleration"/></mbd>)",
      order, elements, attributes, step, place));
}

// Differences of order 8 of the positions: the fine steps of Radau's method leave little else.
TEST_P(Within, VelocityAndAccelerationAreThoseOfThePosition) {
  const Table t = run_to_table(swung(GetParam().attributes, 3, 2, "b@0.37")).table;
  const std::size_t rows = t.columns[0].size(), n = 4;
  for (std::size_t k = rows / 2; k + n < rows; k += 10) {
    const auto vec = [&](const std::string& name, std::size_t row) {
      return Vec3(t[name + ".1"][row], t[name + ".2"][row], t[name + ".3"][row]);
    };
    const double step = t.columns[0][1] - t.columns[0][0];
    const auto position = [&](double at) -> Vec3 {
      return vec("P.position",
                 static_cast<std::size_t>(std::lround(static_cast<double>(k) + at / step)));
    };
    const Vec3 v = first_difference(position, step), a = second_difference(position, step);
    EXPECT_LT((vec("P.velocity", k) - v).norm(), 1e-7 * v.norm()) << k;
    EXPECT_LT((vec("P.acceleration", k) - a).norm(), 1e-4 * a.norm()) << k;
  }
}

TEST_P(Within, RatesConvergeToThoseOfAFineMesh) {
  const std::string place = fmt::format("b@{:.17g}", 1.0 / 3);
  static const Table exact = run_to_table(swung(R"(metric="geodesic")", 6, 6, place)).table;
  const auto errors = [&](int elements) {
    const Table t = run_to_table(swung(GetParam().attributes, 3, elements, place)).table;
    std::vector<double> result;
    for (const char* const name :
         {"P.position", "P.velocity", "P.angular_velocity", "P.acceleration"})
      result.push_back((last(t, name) - last(exact, name)).norm() / last(exact, name).norm());
    return result;
  };
  const std::vector<double> coarse = errors(2), fine = errors(4);
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    RecordProperty(fmt::format("error_{}", i), fmt::format("{:.1e} {:.1e}", coarse[i], fine[i]));
    EXPECT_LT(fine[i], 0.25 * coarse[i]) << i;
    EXPECT_LT(fine[i], 1e-3) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Within, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

// The guide's first model: 30 unknowns with and without the record.
TEST(RecordsOf, AnElementLeaveItWhole) {
  const auto unknowns = [](const std::string& place) {
    return compile(cantilever("", 3, 1, place)).system->unknowns();
  };
  EXPECT_EQ(unknowns("b@0.37"), 30);
  EXPECT_EQ(unknowns("b.end"), 30);
}

// A place that is a node between the ends of an element, as the middle of order 2.
TEST(RecordsOf, AnElementAreThoseOfItsNodesAtNodes) {
  const Scene scene = swung("", 2, 1, "b@0.5", 1e-2);
  const Model model = compile(scene);
  EXPECT_EQ(model.system->nodes(), 4);
  State state = model.initial;
  Rng rng(1);
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    state.pose[n] = state.pose[n] * exp_se3<double>(random_vector<6>(rng, 0.1));
    state.V[n] = random_vector<6>(rng);
  }
  std::array<double, 15> x{};
  ASSERT_EQ(model.channels.at(0).columns.size(), x.size());
  model.channels[0].sample(state, x);
  EXPECT_EQ(Vec3(x[0], x[1], x[2]), state.pose[2].r);
  EXPECT_EQ(Vec3(x[6], x[7], x[8]), Vec3(state.pose[2].p * Vec3(linear(state.V[2]))));
}

// ---- the table of quantities -------------------------------------------------------------------

// Where elements meet, forces are the mean of both sides. Linear elements of a cantilever that carries q along it have one moment
// each, that of statics at their middle but for what the load at their nodes makes of it: left and right differ by far.
TEST(RecordsOf, AnEndOfElementsAreTheMeanOfBoth) {
  const History h = run_to_table(read_model_text(R"(<mbd name="cantilever">
    <section name="s"><stiffness EA="1e9" GA2="1e9" GA3="1e9" GJ="1e6" EI2="1e6" EI3="1e6"/>
      <mass per_length="1" inertia="2 1 1"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2" order="1"/>
    <fixed name="f" between="ground b.start"/><distributed beam="b" force="0 0 3"/><static/>
    <record name="left" at="b@0.25" quantities="moment"/>
    <record name="middle" at="b@0.5" quantities="moment"/>
    <record name="right" at="b@0.75" quantities="moment"/></mbd>)"));
  const double left = h.table["left.moment.2"].back(), right = h.table["right.moment.2"].back();
  EXPECT_GT(std::abs(left), 2.0 * std::abs(right));
  EXPECT_GT(std::abs(right), 0.5);
  EXPECT_NEAR(h.table["middle.moment.2"].back(), 0.5 * (left + right), 1e-9);
}

// What the manual says of axes is what moved scenes go by.
TEST(Quantities, SayTheAxesTheyHave) {
  using Axes = schema::Quantity::Axes;
  const auto says = [](const schema::Quantity& q, std::string_view words) {
    return q.doc.find(words) != std::string_view::npos;
  };
  std::size_t count = 0;
  for (const auto all : {schema::place_quantities(), schema::joint_quantities(),
                         schema::spring_quantities(), schema::system_quantities()})
    for (const schema::Quantity& q : all) {
      ++count;
      SCOPED_TRACE(q.name);
      EXPECT_EQ(q.components, q.axes == Axes::none ? 1 : 3);
      EXPECT_EQ(says(q, "inertial axes"), q.axes == Axes::inertial);
      EXPECT_EQ(says(q, "section"), q.axes == Axes::own);
      EXPECT_EQ(says(q, "joint axes"), q.axes == Axes::of_joint);
      EXPECT_EQ(says(q, "bushing") && !says(q, "strain") && !says(q, "beams"),
                q.axes == Axes::of_bushing);
      EXPECT_EQ(says(q, "axes of its ply"), q.axes == Axes::of_ply);
      EXPECT_TRUE(q.axes != Axes::of_ply || q.of_section_point());
      EXPECT_EQ(q.turns(), q.axes == Axes::inertial || q.axes == Axes::of_joint);
      EXPECT_EQ(schema::find_quantity(all, q.name), &q);
    }
  EXPECT_EQ(count, 43u);
}

TEST(Quantities, AreFoundFromColumns) {
  const Scene scene = swung("", 3, 1, "b@0.5");
  const schema::Recorded found = schema::recorded_in(scene, "P.velocity.2");
  ASSERT_NE(found.quantity, nullptr);
  EXPECT_EQ(found.record, &scene.records[0]);
  EXPECT_EQ(found.quantity->unit, "m/s");
  for (const char* const column : {"time", "P", "P.", "Q.velocity", "P.angle"})
    EXPECT_EQ(schema::recorded_in(scene, column).quantity, nullptr) << column;
}

}  // namespace
}  // namespace mbd::test::test_records
