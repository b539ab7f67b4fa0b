// Stresses that models record, mbd section --stress, and sections from meshes of Gmsh in models: against closed
// forms of cantilevers and of sections, in other units, and what is refused.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/material/scene_files.hpp"
#include "libmbd/run/describe_stress.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "libmbd/view/figure.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_recorded_stresses {
namespace {

constexpr double pi = std::numbers::pi;

const std::string steel =
    R"xml(<material name="steel" E="210 GPa" nu="0.3" rho="7850" yield="355 MPa"/>)xml";
const std::string plies =
    R"xml(<material name="ud" EL="140 GPa" ET="10 GPa" GLT="5 GPa" nuLT="0.3" nuTN="0.4" rho="1600"
            Xt="1500 MPa" Xc="1200 MPa" Yt="50 MPa" Yc="200 MPa" SLT="70 MPa" STN="40 MPa"/>)xml";

// A cantilever of 1 m along i1 with its end loaded by `load`; b2 and b3 are i2 and i3.
std::string cantilever(const std::string& section, const std::string& load,
                       const std::string& records) {
  return section +
         R"xml(<beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" order="3"/>
    <fixed name="clamp" between="ground b.start"/> <load at="b.end" )xml" +
         load + "/> <static/>" + records;
}
const std::string bar =
    steel + R"xml(<section name="s"><bar radius="20 mm" material="steel"/></section>)xml";

const std::string fine_bar =
    steel +
    R"xml(<section name="s"><bar radius="20 mm" material="steel" tolerance="1e-8"/></section>)xml";

std::string message(const std::string& inside) {
  try {
    compile(read(inside));
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

// 1 N at the end: small enough that the bar stays straight.
TEST(RecordedStresses, RoundBarUnderATipForce) {
  const Table t =
      run_to_table(
          read(cantilever(
              fine_bar, "force=\"0 0 -1\" moment=\"0.5 0 0\"",
              R"xml(<record name="top" at="b@0.25" section_point="0 19 mm" quantities="ply_stress ply_shear_stress von_mises yield_index ply_strain"/>
            <record name="side" at="b@0.25" section_point="12 0 mm" quantities="ply_shear_stress ply_stress"/>
            <record name="R" at="b@0.25" quantities="force moment"/>)xml")))
          .table;
  const double r = 0.02, i = pi / 4 * std::pow(r, 4), nu = 0.3;
  // Bent down: tension above, by M2 x3/I, M2 = 1 N 0.75 m. N of the bar is b3, T = b2.
  const double bent = 0.75 * 0.019 / i;
  const auto last = [&](const char* column) { return t[column].back(); };
  EXPECT_NEAR(last("top.ply_stress.1") / bent, 1.0, 1e-4);
  EXPECT_NEAR(last("top.ply_strain.1") / (bent / 210e9), 1.0, 1e-4);
  EXPECT_NEAR(last("top.ply_strain.2") / (-nu * bent / 210e9), 1.0, 1e-4);
  // Torsion: along b2 at the top -T x3/J; the force makes nothing along b2 on the line x2 = 0, and Q3 along b3 there
  // is that of Timoshenko and Goodier.
  const double torsion = 0.5 * 0.019 / (2 * i);
  const double q3 = -(3 + 2 * nu) / (8 * (1 + nu)) / i * (r * r - 0.019 * 0.019);
  EXPECT_NEAR(last("top.ply_shear_stress.3"), -torsion, 1e-4 * torsion);
  EXPECT_NEAR(last("top.ply_shear_stress.2"), q3, 1e-4 * torsion);
  const double mises = std::sqrt(bent * bent + 3 * (torsion * torsion + q3 * q3));
  EXPECT_NEAR(last("top.von_mises") / mises, 1.0, 1e-4);
  EXPECT_NEAR(last("top.yield_index") / (mises / 355e6), 1.0, 1e-4);
  const double middle =
      -(3 + 2 * nu) / (8 * (1 + nu)) / i * (r * r - (1 - 2 * nu) / (3 + 2 * nu) * 0.012 * 0.012);
  EXPECT_NEAR(last("side.ply_shear_stress.2") / (0.5 * 0.012 / (2 * i) + middle), 1.0, 1e-3);
  EXPECT_NEAR(last("side.ply_stress.1"), 0.0, 1e-4 * bent);
  EXPECT_NEAR(last("R.moment.2"), 0.75, 1e-4);
}

// All of a laminate's indices at a point, from its stresses there; nothing else of the run changes.
TEST(RecordedStresses, IndicesOfAPly) {
  const std::string tube =
      plies + R"xml(<layup name="wall"><ply material="ud" thickness="1 mm" angle="20 deg"/>
      <ply material="ud" thickness="1 mm" angle="-70 deg"/></layup><section name="s"><tube radius="20 mm" layup="wall"/></section>)xml";
  const std::string tip = R"xml(<record name="tip" at="b.end" quantities="displacement"/>)xml";
  const Table with =
      run_to_table(read(cantilever(tube, "force=\"0 30 -40\"",
                                   R"xml(<record name="p" at="b.start" section_point="0 18.5 mm"
              quantities="ply_stress ply_shear_stress max_stress tsai_hill tsai_wu hashin"/>)xml" +
                                       tip)))
          .table;
  Vec6 s;
  for (int i = 0; i < 3; ++i) {
    s(i) = with["p.ply_stress." + std::to_string(i + 1)].back();
    s(3 + i) = with["p.ply_shear_stress." + std::to_string(i + 1)].back();
  }
  const section::Strengths strengths{1500e6, 1200e6, 50e6, 200e6, 50e6, 200e6, 70e6, 70e6, 40e6};
  EXPECT_GT(s.cwiseAbs().minCoeff(), 1.0);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(with["p." + std::string(section::criterion_names[k])].back() /
                    section::failure_index(static_cast<section::Criterion>(k), s, strengths),
                1.0, 1e-12);
  const Table without = run_to_table(read(cantilever(tube, "force=\"0 30 -40\"", tip))).table;
  for (const char* const column :
       {"tip.displacement.1", "tip.displacement.2", "tip.displacement.3"})
    EXPECT_EQ(without[column].back(), with[column].back());
}

TEST(RecordedStresses, Refused) {
  const auto record = [](const std::string& rest) {
    return cantilever(bar, "force=\"0 0 -1\"", "\n<record name=\"p\" " + rest + "/>");
  };
  struct Bad {
    std::string inside, part;
  };
  const std::string matrices =
      R"xml(<section name="s"><stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="1" EI2="1" EI3="1"/></section>)xml";
  const Bad all[] = {
      {record("at=\"b@0.5\" quantities=\"ply_stress\""),
       "quantities: \"ply_stress\" is of a point of a section; give section_point=\"x2 x3\""},
      {record("at=\"b@0.5\" section_point=\"0 0\" quantities=\"force\""),
       "section_point is of stresses and strains, of which quantities hold none"},
      {record("section_point=\"0 0\" quantities=\"strain_energy\""),
       "section_point is of a place of a beam"},
      {record("at=\"b@0.5\" section_point=\"0 21 mm\" quantities=\"ply_stress\""),
       "record \"p\": section_point: x2 = 0, x3 = 0.021 lies outside the section"},
      {record("at=\"b@0.5\" section_point=\"0 0\" quantities=\"tsai_wu\""),
       "tsai_wu needs strengths Xt Xc Yt Yc SLT STN of material \"steel\", which is isotropic: "
       "record yield_index"},
      {cantilever(
           matrices, "force=\"0 0 -1\"",
           "<record name=\"p\" at=\"b@0.5\" section_point=\"0 0\" quantities=\"ply_stress\"/>"),
       "section \"s\" is stated by matrices, which know no stresses"},
      {cantilever(
           plies + "<section name=\"s\"><rectangle width=\"20 mm\" height=\"10 mm\" "
                   "material=\"ud\"/></section>",
           "force=\"0 0 -1\"",
           "<record name=\"p\" at=\"b@0.5\" section_point=\"0 0\" quantities=\"yield_index\"/>"),
       "yield_index needs the yield stress of material \"ud\", an isotropic one"},
      {R"xml(<material name="m" E="1e9" nu="0.3" Xt="1e6"/>)xml",
       "Xt is of a material with axes, this one is isotropic; give yield"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" GLT="1e9" nuLT="0.3" nuTN="0.3" yield="1e6"/>)xml",
       "yield is of an isotropic material"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" GLT="1e9" nuLT="0.3" nuTN="0.3" Xt="1e6" Xc="1e6"/>)xml",
       "attribute \"Yt\" is missing: strengths are given by Xt Xc Yt Yc SLT STN at least"}};
  for (const Bad& bad : all) {
    const std::string said = message(bad.inside);
    EXPECT_TRUE(said.starts_with("test.xml:")) << said;
    EXPECT_NE(said.find(bad.part), std::string::npos) << said << "\nwanted: " << bad.part;
  }
}

// ---- over a section ---------------------------------------------------------------------------

StressReport over(const std::string& inside, const Vec6& resultants) {
  const SectionLoad load{{}, resultants};
  return describe_stress(read(inside), "s", {}, std::span(&load, 1));
}
const StressReport::Largest& largest(const StressReport& report, const std::string& quantity) {
  for (const StressReport::Largest& x : report.largest)
    if (x.quantity == quantity) return x;
  throw Error("nothing of " + quantity);
}
Vec6 resultants(double n, double q2, double q3, double m1, double m2, double m3) {
  return (Vec6() << n, q2, q3, m1, m2, m3).finished();
}

// Without contraction the shear of a rectangle is the parabola of Jourawski, whatever its width; N is b3. Bending about b2 and b3 by M/W.
TEST(SectionStresses, RectangleInShearAndBending) {
  const std::string inside =
      R"xml(<material name="m" E="70 GPa" nu="0" yield="100 MPa"/>
    <section name="s"><rectangle width="10 mm" height="20 mm" material="m"/></section>)xml";
  const StressReport shear = over(inside, resultants(0, 0, 1000, 0, 0, 0));
  const StressReport::Largest& ln = largest(shear, "LN");
  EXPECT_NEAR(ln.value / 7.5e6, 1.0, 1e-6);
  EXPECT_NEAR(ln.point[1], 0.0, 1e-9);
  EXPECT_NEAR(largest(shear, "yield_index").value / (std::sqrt(3.0) * 7.5e6 / 100e6), 1.0, 1e-6);
  const PointStress at =
      describe_point(read(inside), "s", {}, {{}, resultants(0, 0, 1000, 0, 0, 0)}, {1e-3, 5e-3});
  EXPECT_NEAR(at.stress(4) / (0.75 * 7.5e6), 1.0, 1e-6);
  EXPECT_NEAR(at.strain(4) / (0.75 * 7.5e6 / 35e9), 1.0, 1e-6);
  EXPECT_NEAR(at.stress(3) / 7.5e6, 0.0, 1e-6);
  // M2 presses below and pulls above; M3 pulls at the side of -b2.
  const PointStress bent =
      describe_point(read(inside), "s", {}, {{}, resultants(200, 0, 0, 0, 3, 5)}, {1e-3, 5e-3});
  EXPECT_NEAR(bent.stress(0),
              200 / 2e-4 + 3 * 5e-3 * 12 / (1e-2 * 8e-6) - 5 * 1e-3 * 12 / (2e-2 * 1e-6), 10.0);
}

// A thin tube in torsion: T r/J at its outer side, nearly Bredt's T/(2 A t); its ply's T lies round it.
TEST(SectionStresses, ThinTubeInTorsion) {
  const StressReport report = over(
      steel +
          R"xml(<section name="s"><tube radius="50 mm" material="steel" thickness="0.5 mm"/></section>)xml",
      resultants(0, 0, 0, 300, 0, 0));
  const double r = 0.05, polar = pi / 2 * (std::pow(r, 4) - std::pow(0.0495, 4));
  const StressReport::Largest& lt = largest(report, "LT");
  EXPECT_NEAR(lt.value / (300 * r / polar), 1.0, 1e-6);
  EXPECT_NEAR(std::hypot(lt.point[0], lt.point[1]), r, 1e-9);
  EXPECT_NEAR(lt.value / (300 / (2 * pi * 0.04975 * 0.04975 * 0.0005)), 1.0, 0.01);
  EXPECT_NEAR(largest(report, "von_mises").value / lt.value, std::sqrt(3.0), 1e-6);
}

// Stretched along its fibres a bar fails at Xt by all criteria, pressed at Xc; and in proportion.
TEST(SectionStresses, IndicesOfABarAlongItsFibres) {
  const std::string inside =
      plies +
      R"xml(<section name="s"><rectangle width="10 mm" height="5 mm" material="ud"/></section>)xml";
  for (const auto& [force, strength] : {std::pair{30e3, 1500e6}, {15e3, 1500e6}, {-30e3, 1200e6}}) {
    const StressReport report = over(inside, resultants(force, 0, 0, 0, 0, 0));
    for (const std::string_view name : section::criterion_names)
      EXPECT_NEAR(largest(report, std::string(name)).value / (std::abs(force) / 5e-5 / strength),
                  1.0, 1e-6)
          << name << " " << force;
  }
}

// At the re-entrant corners of a box stresses grow with the mesh, which is said; on its sides they do not. Mutation: the mesh before
// is the same.
TEST(SectionStresses, SingularCornersAreSaid) {
  const std::string inside =
      steel +
      R"xml(<section name="s"><box width="60 mm" height="40 mm" thickness="4 mm" material="steel" tolerance="1e-3"/></section>)xml";
  const StressReport twisted = over(inside, resultants(0, 0, 0, 100, 0, 0));
  const StressReport::Largest& worst = largest(twisted, "von_mises");
  EXPECT_NEAR(std::abs(worst.point[0]), 0.026, 1e-6);
  EXPECT_NEAR(std::abs(worst.point[1]), 0.016, 1e-6);
  EXPECT_LT(worst.before, 0.95 * worst.value);
  EXPECT_NE(to_text(twisted).find("stresses are singular"), std::string::npos);
  const StressReport pulled = over(inside, resultants(100, 0, 0, 0, 0, 0));
  EXPECT_NEAR(largest(pulled, "LL").before, largest(pulled, "LL").value,
              1e-6 * largest(pulled, "LL").value);
  EXPECT_EQ(to_text(pulled).find("stresses are singular"), std::string::npos);
}

// Found by a reviewer: across the wall of a tube in bending, and of a bar that is pulled, there is no stress, and what the mesh made of it
// was called singular. Mutation: errors that become less taken for what is singular.
TEST(SectionStresses, NothingIsSingularInATube) {
  const StressReport tube = over(
      steel +
          R"xml(<section name="s"><tube radius="50 mm" material="steel" thickness="1 mm"/></section>)xml",
      resultants(0, 0, 0, 0, 100, 50));
  EXPECT_EQ(to_text(tube).find("singular"), std::string::npos) << to_text(tube);
  EXPECT_SAYS(to_text(tube), "of the mesh, not resolved");
  const StressReport pulled = over(
      steel +
          R"xml(<section name="s"><bar radius="20 mm" material="steel" x2="30 mm"/></section>)xml",
      resultants(1000, 0, 0, 0, 0, 0));
  EXPECT_EQ(to_text(pulled).find("singular"), std::string::npos) << to_text(pulled);
}

// In tonnes, millimetres and seconds: stresses in MPa; and what a run records of the same model in other units.
TEST(SectionStresses, InOtherUnits) {
  const StressReport in_m = over(bar, resultants(100, 20, -30, 4, 5, 6));
  const StressReport in_mm = over(
      R"xml(<material name="steel" E="210000" nu="0.3" rho="7.85e-9" yield="355"/>
      <section name="s"><bar radius="20" material="steel"/></section>)xml",
      resultants(100, 20, -30, 4000, 5000, 6000));
  ASSERT_EQ(in_m.largest.size(), in_mm.largest.size());
  for (std::size_t i = 0; i < in_m.largest.size(); ++i) {
    const StressReport::Largest &a = in_m.largest[i], &b = in_mm.largest[i];
    EXPECT_EQ(a.quantity, b.quantity);
    EXPECT_NEAR(b.value, a.value * (a.unit.empty() ? 1.0 : 1e-6), 1e-6) << a.quantity;
  }
  const Scene scene = read(cantilever(
      bar, "force=\"0 3 -4\"",
      R"xml(<record name="p" at="b@0.25" section_point="5 11 mm" quantities="ply_stress ply_strain yield_index"/>)xml"));
  const UnitChange units{1e3, 1e-3, 1.0};
  const Table there = run_to_table(rescaled(scene, units).scene).table,
              here = run_to_table(scene).table;
  for (const auto& [column, factor] :
       {std::pair{"p.ply_stress.1", 1e-6}, {"p.ply_strain.1", 1.0}, {"p.yield_index", 1.0}})
    EXPECT_NEAR(there[column].back() / (factor * here[column].back()), 1.0, 1e-7) << column;
}

// ---- mbd section --stress ---------------------------------------------------------------------

class StressCommand : public testing::Test {
 protected:
  void SetUp() override {
    test::write_text(
        model_, "<mbd name=\"m\">\n" +
                    cantilever(bar, "force=\"0 0 -100\"",
                               "<record name=\"R\" at=\"b.start\" quantities=\"force moment\"/>") +
                    "\n</mbd>\n");
  }
  Output call(const std::string& arguments) const {
    return shell(quote(test::mbd_program) + " " + arguments);
  }
  const TemporaryDirectory directory_;
  const std::filesystem::path model_ = directory_.path() / "m.xml";
};

TEST_F(StressCommand, LargestOverTheSection) {
  const Output run = call("section " + model_.string() + " --stress '0 0 0 0 100 0' --json");
  ASSERT_EQ(run.status, 0) << run.text;
  const auto json = nlohmann::json::parse(run.text);
  const double expected = 100 * 4 / (pi * std::pow(0.02, 3));
  bool seen = false;
  for (const auto& x : json["largest"]) {
    if (x["quantity"] == "yield_index") {
      EXPECT_NEAR(x["value"].get<double>() / (expected / 355e6), 1.0, 1e-4);
    }
    if (x["quantity"] != "LL") continue;
    seen = true;
    EXPECT_NEAR(x["value"].get<double>() / expected, 1.0, 1e-4);
    EXPECT_NEAR(std::abs(x["point"][1].get<double>()), 0.02, 1e-9);
    EXPECT_NEAR(x["mesh_before"].get<double>() / expected, 1.0, 1e-2);
  }
  EXPECT_TRUE(seen);
  const Output point =
      call("section " + model_.string() + " --stress '0 0 0 0 100 0' --point '0 0.01'");
  EXPECT_EQ(point.status, 0);
  EXPECT_NE(point.text.find("yield_index"), std::string::npos) << point.text;
  EXPECT_NE(point.text.find("0 1 0 along b1 b2 b3"), std::string::npos) << point.text;
}

TEST_F(StressCommand, OfARun) {
  const std::filesystem::path out = directory_.path() / "out", csv = directory_.path() / "s.csv";

  ASSERT_EQ(call("run " + model_.string() + " -o " + out.string()).status, 0);
  const Output run = call("section " + model_.string() + " s --run " + out.string() +
                          " --record R --out " + csv.string());
  ASSERT_EQ(run.status, 0) << run.text;
  EXPECT_NE(run.text.find("load_factor 1"), std::string::npos) << run.text;
  const std::string table = test::read_text(csv);
  EXPECT_TRUE(table.starts_with("load_factor,yield_index,von_mises,LL,TT,NN,TN,LN,LT\n0,"))
      << table;
  // The last row: at full load M2 = 100 N 1 m; the bar bends by 1.3 mm.
  std::istringstream last(table.substr(table.rfind('\n', table.size() - 2) + 1));
  std::vector<double> numbers;
  for (std::string x; std::getline(last, x, ',');) numbers.push_back(std::stod(x));
  ASSERT_EQ(numbers.size(), 9u);
  EXPECT_EQ(numbers[0], 1.0);
  EXPECT_NEAR(numbers[3] / (100 * 4 / (pi * std::pow(0.02, 3))), 1.0, 1e-3);
}

// Under M2 the stress along the line is M2 x3/I: every cell of the picture has the colour of its middle on the scale of
// the legend, within two of 255 levels; and cells cover the section.
TEST_F(StressCommand, PicturesHaveTheStresses) {
  const std::filesystem::path file = directory_.path() / "s.svg";
  const Output run = call("section " + model_.string() +
                          " --stress '0 0 0 0 100 0' --colour LL --image " + file.string());
  ASSERT_EQ(run.status, 0) << run.text;
  const std::string svg = test::read_text(file);
  EXPECT_NE(svg.find("section &quot;s&quot;: LL [Pa]"), std::string::npos) << svg.substr(0, 600);
  struct Cell {
    double x, y, area;
    std::array<int, 3> colour;
  };
  std::vector<Cell> cells;
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  const std::regex polygon("<polygon fill=\"#(..)(..)(..)\"[^>]* points=\"([^\"]*)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), polygon), end; it != end; ++it) {
    Cell cell{0, 0, 0, {}};
    for (std::size_t i = 0; i < 3; ++i) cell.colour[i] = std::stoi((*it)[i + 1], nullptr, 16);
    std::istringstream numbers((*it)[4].str());
    std::vector<std::array<double, 2>> corners;
    char comma = ',';
    for (double x = 0, y = 0; numbers >> x >> comma >> y;) corners.push_back({x, y});
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto& [x, y] = corners[k];
      const auto& [u, v] = corners[(k + 1) % corners.size()];
      cell.x += x / static_cast<double>(corners.size());
      cell.y += y / static_cast<double>(corners.size());
      cell.area += 0.5 * (x * v - u * y);
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    cells.push_back(cell);
  }
  ASSERT_GT(cells.size(), 100U);
  const double scale = (right - left) / 0.04, middle = 0.5 * (top + bottom);
  double area = 0.0, high = 0.0;
  for (const Cell& cell : cells) {
    area += std::abs(cell.area) / (scale * scale);
    high = std::max(high, (middle - cell.y) / scale);
  }
  EXPECT_NEAR(area / (pi * 4e-4), 1.0, 2e-2);  // of straight sides
  for (const Cell& cell : cells) {
    const double share =
        0.5 + 0.5 * (middle - cell.y) / scale / high;  // M2 presses b3: N1 = M2 x3/I
    const Colour expected = Stage::shade(share);
    EXPECT_NEAR(cell.colour[0], 255 * expected.r, 3.0) << cell.y;
    EXPECT_NEAR(cell.colour[1], 255 * expected.g, 3.0) << cell.y;
    EXPECT_NEAR(cell.colour[2], 255 * expected.b, 3.0) << cell.y;
  }
  for (const auto& [rest, part] :
       {std::pair{"--stress '1 0 0 0 0 0' --image s.png", ".svg"},
        {"--stress '1 0 0 0 0 0' --colour LL", "give --image"},
        {"--stress '1 0 0 0 0 0' --colour LM --image s.svg", "there is no such quantity"},
        {"--stress '1 0 0 0 0 0' --colour tsai_wu --image s.svg", "none of its materials"},
        {"--image s.svg", "give --stress"}}) {
    const Output wrong = call("section " + model_.string() + " " + rest);
    EXPECT_EQ(wrong.status, 1) << rest;
    EXPECT_NE(wrong.text.find(part), std::string::npos) << rest << ": " << wrong.text;
  }
}

TEST_F(StressCommand, RefusesWrongUse) {
  for (const auto& [rest, part] :
       {std::pair{"--stress '1 2 3'", "give 6 numbers, N Q2 Q3 M1 M2 M3"},
        {"--point '0 0'", "give --stress"},
        {"--record R", "give one of both"},
        {"--stress '1 0 0 0 0 0' --point '1 0'", "lies outside the section"},
        {"--stress '1 0 0 0 0 0' --station 0.5", "it has no stations"}}) {
    const Output run = call("section " + model_.string() + " " + rest);
    EXPECT_EQ(run.status, 1) << rest;
    EXPECT_NE(run.text.find(part), std::string::npos) << rest << ": " << run.text;
  }
}

// ---- meshes in models -------------------------------------------------------------------------

// Of 20 x 10 mm in two triangles and a quadrilateral.
const std::string block =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"left\"\n2 2 "
    "\"right\"\n$EndPhysicalNames\n"
    "$Nodes\n6\n1 -10 -5 0\n2 0 -5 0\n3 10 -5 0\n4 -10 5 0\n5 0 5 0\n6 10 5 0\n$EndNodes\n"
    "$Elements\n3\n1 3 2 1 1 1 2 5 4\n2 2 2 2 1 2 3 6\n3 2 2 2 1 2 6 5\n$EndElements\n";

// Rows of a sweep are of the meshes too. Mutation: files of a model are its own and those it includes.
TEST(MeshedSections, AreOfTheModelForStudies) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "m.xml";
  test::write_text(directory.path() / "block.msh", block);
  test::write_text(file,
                   "<mbd name=\"m\"><parameter name=\"q\" value=\"1\"/>" + steel +
                       R"(<section name="s"><mesh file="block.msh" unit="1 mm" material="steel"/>
      </section><beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="1"/>
      <fixed name="w" between="ground b.start"/><load at="b.end" force="0 0 -q"/><static/>
      <record name="t" at="b.end" quantities="displacement"/></mbd>)");
  EXPECT_EQ(files_of(read_model(file)),
            (std::vector<std::string>{file.string(), (directory.path() / "block.msh").string()}));
  const auto sweep = [&] {
    return shell(quote(test::mbd_program) + " sweep " + quote(file.string()) +
                 " --vary q=1,2 -Q t.displacement.3 --out " +
                 quote((directory.path() / "out").string()))
        .text;
  };
  sweep();
  EXPECT_NE(sweep().find("2 rows found"), std::string::npos);
  std::string higher = block;
  for (const char* y : {" -5 0", " 5 0"})
    for (std::size_t i = higher.find(y); i != std::string::npos; i = higher.find(y, i + 4))
      higher.replace(i, 3, y[1] == '-' ? " -15" : " 15");
  test::write_text(directory.path() / "block.msh", higher);
  const std::string again = sweep();
  EXPECT_EQ(again.find("rows found"), std::string::npos) << again;
}

TEST(MeshedSections, InAModel) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "m.xml";
  test::write_text(directory.path() / "block.msh", block);
  const auto with = [&](const std::string& inside) {
    test::write_text(file, "<mbd name=\"m\">\n" + steel + plies + "\n<section name=\"s\">" +
                               inside + "</section>\n</mbd>\n");
    return read_model(file).sections.at(0);
  };
  const auto message_of = [&](const std::string& inside) -> std::string {
    try {
      with(inside);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string mesh = "<mesh file=\"block.msh\" unit=\"1 mm\"";
  const Section s = with(mesh + " material=\"steel\"/>");
  EXPECT_NEAR(s.stiffness(0, 0) / (210e9 * 2e-4), 1.0, 1e-10);
  EXPECT_NEAR(s.stiffness(4, 4) / (210e9 * 0.02 * 1e-6 / 12), 1.0, 1e-10);
  EXPECT_NEAR((*s.mass)(0, 0) / (7850 * 2e-4), 1.0, 1e-12);
  // Of a rectangle twice as wide as high, Saint-Venant.
  EXPECT_NEAR(s.stiffness(3, 3) / (210e9 / 2.6 * 0.228682 * 0.02 * 1e-6), 1.0, 1e-3);
  EXPECT_LT(s.found->error.maxCoeff(), 1e-3);
  // Placed as shapes are; other materials by their names.
  EXPECT_NEAR(
      with(mesh + " material=\"steel\" x2=\"1 mm\"/>").stiffness(0, 5) / (-210e9 * 2e-4 * 1e-3),
      1.0, 1e-9);
  const Section two =
      with(mesh +
           " tolerance=\"0.05\"><region name=\"left\" material=\"steel\"/><region name=\"right\" "
           "material=\"ud\" angle=\"0\"/></mesh>");
  EXPECT_NEAR((*two.mass)(0, 0) / ((7850 + 1600) * 1e-4), 1.0, 1e-12);
  const auto expect = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said << "\nwanted: " << part;
  };
  expect(message_of(mesh + "/>"),
         "m.xml:4: section \"s\": physical surface \"left\" has no material: give <region "
         "name=\"left\"");
  expect(message_of(mesh + "><region name=\"lift\" material=\"steel\"/></mesh>"),
         "has no physical surface \"lift\"; did you mean \"left\"");
  expect(message_of(mesh + "><region name=\"left\" material=\"stel\"/></mesh>"),
         "material \"stel\" is not in the model; did you mean \"steel\"");
  expect(message_of(mesh + " material=\"steel\"><region name=\"left\" material=\"ud\"/><region "
                           "name=\"left\" material=\"ud\"/></mesh>"),
         "has been stated before");
  expect(message_of("<mesh file=\"none.msh\" material=\"steel\"/>"), "there is no such file");
  expect(message_of(mesh + " material=\"steel\" tolerance=\"1e-10\"/>"),
         "tolerance 1e-10 is not reached");
  expect(message_of(mesh + " material=\"steel\" curvature=\"0 0 101\"/>"),
         "curvature is too strong");
}

}  // namespace
}  // namespace mbd::test::test_recorded_stresses
