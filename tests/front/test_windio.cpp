// mbd import windio: blades whose deflection and weight have closed forms, in both layouts, and what is refused.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_windio {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

// Of a blade in the axes of windIO, the same along it; bent by edge and flap with other stiffness.
struct Data {
  double shear_flap = 3e8, shear_edge = 5e8, ea = 7e9, edge = 4e7, flap = 1e7, gj = 2e6;
  double mass = 120.0, x = 0.03, y = -0.2, i_edge = 40.0, i_flap = 11.0, i_cp = 3.0;
  std::string twist = "0.0, 0.0";  // in the unit of the layout
  std::string z = "0.0, 10.0", prebend = "0.0, 0.0";
  std::string more = "";  // of elastic_properties in layout 2
};

std::string axis(const Data& d, const std::string& indent) {
  const auto line = [&](const char* name, const std::string& values) {
    return fmt::format("{}  {}: {{grid: [0.0, 1.0], values: [{}]}}\n", indent, name, values);
  };
  return indent + "reference_axis:\n" + line("x", d.prebend) + line("y", "0.0, 0.0") +
         line("z", d.z);
}

// Rows of the upper triangles as the documents of windIO have them.
std::string layout_1(const Data& d) {
  const std::string
      k = fmt::format("[{}, 0, 0, 0, 0, 0, {}, 0, 0, 0, 0, {}, 0, 0, 0, {}, 0, 0, {}, 0, {}]",
                      d.shear_flap, d.shear_edge, d.ea, d.edge, d.flap, d.gj),
      m = fmt::format(
          "[{0}, 0, 0, 0, 0, {1}, {0}, 0, 0, 0, {2}, {0}, {3}, {4}, 0, {5}, {6}, 0, {7}, 0, {8}]",
          d.mass, -d.mass * d.y, d.mass * d.x, d.mass * d.y, -d.mass * d.x, d.i_edge, -d.i_cp,
          d.i_flap, d.i_edge + d.i_flap);
  return "name: a turbine\ncomponents:\n  blade:\n    outer_shape_bem:\n      twist: &twist {grid: "
         "[0.0, 1.0], values: [" +
         d.twist + "]}\n" + axis(d, "      ") +
         "    elastic_properties_mb:\n      six_x_six:\n        twist: *twist\n        "
         "stiff_matrix:\n          grid: [0.0, "
         "1.0]\n          values: [" +
         k + ", " + k +
         "]\n        inertia_matrix:\n          grid: [0.0, 0.5, 1.0]\n          values: [" + m +
         ", " + m + ", " + m + "]\n";
}

std::string layout_2(const Data& d) {
  std::string text = "components:\n  blade:\n" + axis(d, "    ") +
                     "    outer_shape:\n      twist: {grid: [0.0, 1.0], values: [" + d.twist +
                     "]}\n    structure:\n      elastic_properties:\n        stiffness_matrix:\n   "
                     "       grid: [0.0, 1.0]\n";
  const double diagonal[] = {d.shear_flap, d.shear_edge, d.ea, d.edge, d.flap, d.gj};
  for (int i = 1; i <= 6; ++i)
    for (int j = i; j <= 6; ++j)
      text += fmt::format("          K{0}{1}: [{2}, {2}]\n", i, j, i == j ? diagonal[i - 1] : 0.0);
  text += "        inertia_matrix:\n          grid: [0.0, 0.5, 1.0]\n";
  const std::pair<const char*, double> all[] = {
      {"mass", d.mass},     {"cm_x", d.x},        {"cm_y", d.y},
      {"i_edge", d.i_edge}, {"i_flap", d.i_flap}, {"i_plr", d.i_edge + d.i_flap},
      {"i_cp", d.i_cp}};
  for (const auto& [name, value] : all)
    text += fmt::format("          {0}: [{1}, {1}, {1}]\n", name, value);
  return text + d.more;
}

class Windio : public testing::Test {
 protected:
  void SetUp() override {
    if (shell(quote(mbd_program) + " import windio /dev/null").text.find("without yaml-cpp") !=
        std::string::npos)
      GTEST_SKIP() << "this build reads no windIO files";
  }
  std::filesystem::path path(const char* name) const { return directory_.path() / name; }
  Output import(const std::string& yaml, const std::string& options = "") const {
    write_text(path("t.yaml"), yaml);
    return shell("cd " + quote(directory_.path().string()) + " && " + quote(mbd_program) +
                 " import windio t.yaml " + options);
  }
  std::string model(const std::string& yaml, const std::string& options = "") const {
    const Output output = import(yaml, options + " --out blade.xml");
    EXPECT_EQ(output.status, 0) << output.text;
    return read_text(path("blade.xml"));
  }
  // Motion of the tip under a small force there, without weight.
  Vec3 tip_under(const std::string& yaml, const std::string& force,
                 const std::string& options = "") const {
    std::string text = model(yaml, options);
    const std::string weight = "<gravity acceleration=\"-g 0 0\"/>";
    const std::size_t at = text.find(weight);
    if (at == std::string::npos) throw Error("the model has no weight");
    text.replace(at, weight.size(), "<load at=\"blade.end\" force=\"" + force + "\"/>");
    const Table t = run_to_table(read_model_text(text)).table;
    return {t["tip.displacement.1"].back(), t["tip.displacement.2"].back(),
            t["tip.displacement.3"].back()};
  }

 private:
  const TemporaryDirectory directory_;
};

// Twist is about -z: of a blade turned by theta towards feather the soft direction, x of its sections, is cos theta x - sin
// theta y; Euler and Timoshenko. Mutations: twist without its change of sign; stiffness in windIO's order of rows.
TEST_F(Windio, BendsTheWayItIsTwisted) {
  const double theta = 25.0 * degree, L = 10.0;
  Data d;
  d.twist = fmt::format("{0}, {0}", theta);
  const double c = std::cos(theta), s = std::sin(theta);
  const double soft = L * L * L / 3 / d.flap + L / d.shear_flap,
               stiff = L * L * L / 3 / d.edge + L / d.shear_edge;
  const Vec3 u = tip_under(layout_1(d), "10 0 0");
  EXPECT_NEAR(u.x() / 10, c * c * soft + s * s * stiff, 1e-5 * soft);
  EXPECT_NEAR(u.y() / 10, -c * s * (soft - stiff), 1e-5 * soft);
  // In degrees by the second layout, and by the first where that is said.
  d.twist = "25, 25";
  for (const Vec3& v :
       {tip_under(layout_2(d), "10 0 0"), tip_under(layout_1(d), "10 0 0", "--twist-unit deg")})
    EXPECT_LT((v - u).norm(), 1e-9 * u.norm());
  // Without twist: edge and flap by their names.
  d.twist = "0, 0";
  EXPECT_NEAR(tip_under(layout_2(d), "0 10 0").y() / 10, stiff, 1e-5 * stiff);
  EXPECT_NEAR(tip_under(layout_2(d), "10 0 0").x() / 10, soft, 1e-5 * soft);
}

// Both layouts have the same matrices, and the energies of motions and strains that windIO says. Mutation: my of the other
// sign.
TEST_F(Windio, MatricesOfBothLayouts) {
  const Data d;
  const Scene one = read_model_text(model(layout_1(d))), two = read_model_text(model(layout_2(d)));
  ASSERT_EQ(one.sections.at(0).stations.size(), 3u);
  ASSERT_EQ(two.sections.at(0).stations.size(), 3u);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (std::size_t k = 0; k < 3; ++k) {
    const Station &a = one.sections[0].stations[k], &b = two.sections[0].stations[k];
    EXPECT_NEAR(a.at, 0.5 * static_cast<double>(k), 1e-12);
    EXPECT_LT((a.stiffness - b.stiffness).norm(), 1e-12 * a.stiffness.norm());
    EXPECT_LT((*a.mass - *b.mass).norm(), 1e-12 * a.mass->norm());
    // A point mass away from the line, and moments about the axes through it: kinetic energy by hand.
    const Vec3 v(any(random), any(random), any(random)), w(any(random), any(random), any(random));
    const double xx = d.i_edge, yy = d.i_flap, xy = d.i_cp;
    const double by_hand =
        0.5 * (d.mass * v.squaredNorm() + 2 * d.mass * v.dot(w.cross(Vec3(d.x, d.y, 0))) +
               xx * w.x() * w.x() + yy * w.y() * w.y() - 2 * xy * w.x() * w.y() +
               (xx + yy) * w.z() * w.z());
    Vec6 motion;
    motion << v.z(), v.x(), v.y(), w.z(), w.x(), w.y();  // along b1 = z, b2 = x, b3 = y
    EXPECT_NEAR(0.5 * motion.dot(*a.mass * motion), by_hand, 1e-12 * d.mass);
  }
}

// A bent blade weighs what mass times length is, and says so. Its points lie on the line given: here x = z^2/400, whose
// length has a closed form.
TEST_F(Windio, WeighsWhatItsLengthDoes) {
  Data d;
  std::string grid, x, z;
  for (int i = 0; i <= 40; ++i) {
    grid += fmt::format("{}{}", i > 0 ? ", " : "", i / 40.0);
    z += fmt::format("{}{}", i > 0 ? ", " : "", i * 0.5);
    x += fmt::format("{}{}", i > 0 ? ", " : "", i * i * 0.25 / 400);
  }
  std::string yaml = layout_2(d);
  for (const auto& [name, values] : {std::pair{"x", x}, {"z", z}}) {
    const std::size_t begin = yaml.find(fmt::format("{}: {{grid", name)),
                      end = yaml.find('}', begin);
    yaml.replace(begin, end + 1 - begin,
                 fmt::format("{}: {{grid: [{}], values: [{}]}}", name, grid, values));
  }
  const double slope = 2 * 20.0 / 400;
  const double length = 100 * (slope * std::sqrt(1 + slope * slope) + std::asinh(slope));
  const Output output = import(yaml, "--out bent.xml");
  ASSERT_EQ(output.status, 0) << output.text;
  EXPECT_NE(output.text.find(fmt::format("blade of {:.6g} m along its reference line", length)),
            std::string::npos)
      << output.text << length;
  EXPECT_NE(output.text.find(fmt::format("mass {:.6g} kg", d.mass * length)), std::string::npos)
      << output.text;
  const Scene bent = read_model(path("bent.xml"));
  // A station stands where the line has the point of its grid, here z = 10 m. Mutation: at 0.5 of the line.
  const double half = 100 * (slope / 2 * std::sqrt(1 + slope * slope / 4) + std::asinh(slope / 2));
  EXPECT_NEAR(bent.sections.at(0).stations.at(1).at, half / length, 1e-7);
  const Table t = run_to_table(bent).table;
  EXPECT_NEAR(std::hypot(t["root.force.1"].back(),
                         std::hypot(t["root.force.2"].back(), t["root.force.3"].back())),
              d.mass * length * 9.80665, 1e-3 * d.mass * length);
}

// Prebend and twist given at few places: the line stays within what is given, as monotone curves do; a spline through those places
// alone leaves it by more than all of it. Mutation: points at the places of the grids only.
TEST_F(Windio, FewPlacesMakeNoOvershoot) {
  Data d;
  std::string yaml = layout_1(d);
  const std::string x = "x: {grid: [0.0, 1.0], values: [0.0, 0.0]}";
  const std::size_t at = yaml.find(x);
  ASSERT_NE(at, std::string::npos);
  yaml.replace(at, x.size(), "x: {grid: [0.0, 0.4, 0.5, 1.0], values: [0.0, 0.0, 1.0, 1.0]}");
  const ReferenceLine line = make_reference_line(read_model_text(model(yaml)).beams.at(0));
  double least = 1.0, most = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double here = line.at(i / 1000.0).r.x();
    least = std::min(least, here);
    most = std::max(most, here);
  }
  EXPECT_GT(least, -0.01);
  EXPECT_LT(most, 1.01);
}

// Damping in proportion to stiffness is taken over where it is one number, else left out, which is said.
TEST_F(Windio, Damping) {
  Data d;
  d.more = "        structural_damping: {mu: [1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3]}\n";
  const Scene scene = read_model_text(model(layout_2(d)));
  ASSERT_TRUE(scene.sections.at(0).damping);
  EXPECT_EQ(scene.sections[0].damping->stiffness_proportional, 1e-3);
  d.more = "        structural_damping: {mu: [1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3, 2.0e-3, 1.0e-3]}\n";
  const Output output = import(layout_2(d), "--out blade.xml");
  EXPECT_EQ(output.status, 0);
  EXPECT_NE(output.text.find("note: its structural damping differs"), std::string::npos)
      << output.text;
  EXPECT_FALSE(read_model(path("blade.xml")).sections.at(0).damping);
}

TEST_F(Windio, Refused) {
  Data d, twisted, negative, nothing;
  twisted.twist = "15.5, 0";  // degrees, where the first layout has radians
  negative.flap = -1e7;
  nothing.z = "0.0, 0.0";
  const auto without = [](std::string text, const std::string& line) {
    const std::size_t at = text.find(line);
    if (at == std::string::npos) throw Error("nothing to leave out");
    return text.erase(at, line.size());
  };
  const auto replaced = [](std::string text, const std::string& part, const std::string& by) {
    const std::size_t at = text.find(part);
    if (at == std::string::npos) throw Error("nothing to replace");
    return text.replace(at, part.size(), by);
  };
  struct Bad {
    std::string yaml, part;
  };
  const Bad all[] = {
      {"a: [1, 2\n", "t.yaml:2: is no YAML"},
      {"", "has no \"components\""},
      {"[1, 2]\n", "has no \"components\""},
      {"components: {blade: {layers: 1}}\n",
       "t.yaml:1: components.blade has neither elastic_properties_mb (layout 1) nor"},
      {layout_1(twisted),
       "twist reaches 888.1 degrees, taken as radians as this layout of windIO says; are they "
       "degrees? Give "
       "--twist-unit deg"},
      {without(layout_2(d), "          K24: [0, 0]\n"), "stiffness_matrix has no \"K24\""},
      {replaced(layout_1(d), ", 2000000]", "]"), "stiff_matrix.values"},
      {replaced(layout_1(d), "[120, 0, 0, 0, 0, 24,", "[120, 0, 0, 0, 0, -24,"),
       "inertia_matrix.values[0] is no mass of a section: entry 34 is -24, and by its mass and the "
       "place of its centre it should be 24"},
      {layout_2(negative), "section \"blade\": station at 0"},
      {layout_2(nothing), "t.yaml: "},
      {replaced(layout_2(d), ", 1.0]", "]"), "must"}};
  for (const Bad& bad : all) {
    const Output output = import(bad.yaml, "--out none.xml");
    EXPECT_EQ(output.status, 1) << bad.part;
    EXPECT_NE(output.text.find(bad.part), std::string::npos)
        << output.text << "\nwanted: " << bad.part;
    EXPECT_FALSE(std::filesystem::exists(path("none.xml")));
  }
  EXPECT_NE(import(layout_1(d), "--out t.yaml").text.find("is the file that is read"),
            std::string::npos);
  EXPECT_EQ(read_text(path("t.yaml")), layout_1(d));
}

}  // namespace
}  // namespace mbd::test::test_windio
