// Sections against more of the literature: Golovin's curved bar, Bredt's thin-walled box, BECAS' user guide (two materials;
// an orthotropic one across its axes; its square converged), and corners of a box that butt, of walls and of plies.
//
// BECAS' G is 41.667 and 4.1667, as its input has it, not E/2.4.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "libmbd/core/spectral.hpp"
#include "libmbd/section/places.hpp"
#include "libmbd/section/shapes.hpp"

namespace mbd::test::test_section_references {
namespace {

using namespace section;
using section::Element, section::Mesh;  // and not how elements lie along a beam
constexpr double degree = std::numbers::pi / 180.0;

std::vector<MeshMaterial> one(const EngineeringConstants& constants) {
  return {{stiffness_of(constants), 1.0, "it"}};
}

void expect_near(double value, double expected, double relative, const std::string& what) {
  EXPECT_NEAR(value, expected, relative * std::abs(expected)) << what;
}

// A bar from radius a to b in pure bending in its plane, thickness t: the ends of an arc of one radian turn by
// 8 M (b^2 - a^2)/(E t ((b^2 - a^2)^2 - 4 a^2 b^2 ln(b/a)^2)). Of plane stress; without contraction, of three dimensions.
TEST(SectionReferences, CurvedBarOfGolovin) {
  const double e = 3e9, t = 0.02;
  for (const double a : {0.5, 0.05}) {
    const double b = a + 0.1, radius = 0.5 * (a + b), difference = b * b - a * a;
    const double n = difference * difference - std::pow(2 * a * b * std::log(b / a), 2);
    const double expected =
        8 * difference / (e * t * n) / radius;  // of the length of the middle line
    const Mesh mesh = rectangle(0.1, {{0, t, 0.0}}, one(isotropic(e, 0.0)))({6, 3});
    for (const double sign : {1.0, -1.0}) {
      const Analysis found = analyse(mesh, Vec3(0, 0, sign / radius));
      expect_near(found.compliance(5, 5), expected, a > 0.1 ? 1e-9 : 1e-6, std::to_string(a));
    }
    // Straight it is another one, which the tolerance tells apart.
    EXPECT_GT(std::abs(analyse(mesh).compliance(5, 5) / expected - 1.0), 1e-3);
  }
}

// G 4 A^2 t/length of the middle line; a wall of finite thickness differs in proportion to it.
TEST(SectionReferencesSlow, ThinBoxOfBredt) {
  const double width = 0.2, height = 0.1, e = 70e9, nu = 0.3, g = e / (2 * (1 + nu));
  double off[2];
  for (int i = 0; i < 2; ++i) {
    const double t = height / (i == 0 ? 50 : 100);
    const Converged c =
        converge(box(width + t, height + t, {{0, t, 0.0}}, Corners::mitred, one(isotropic(e, nu))),
                 Vec3::Zero(), 1e-6);
    ASSERT_TRUE(c.reached);
    const double bredt = g * 4 * std::pow(width * height, 2) * t / (2 * (width + height));
    off[i] = c.analysis.stiffness(3, 3) / bredt - 1.0;
  }
  EXPECT_LT(std::abs(off[1]), 0.02);
  EXPECT_GT(std::abs(off[0]), 1e-5);
  // To t = 0.
  EXPECT_LT(std::abs(2 * off[1] - off[0]), 3e-4) << off[0] << " " << off[1];
}

TEST(SectionReferences, SquareOfBecas) {
  EngineeringConstants square = isotropic(100.0, 0.2);
  square.g12 = square.g13 = square.g23 = 41.667;
  const Converged c = converge(rectangle(0.1, {{0, 0.1, 0.0}}, one(square)), Vec3::Zero(), 1e-6);
  ASSERT_TRUE(c.reached);
  expect_near(c.analysis.stiffness(1, 1), .3461095, 1e-6, "shear");
  expect_near(c.analysis.stiffness(3, 3), 5.857422e-4, 1e-6, "torsion");
  expect_near(c.analysis.stiffness(4, 4), 8.333333e-4, 1e-7, "bending");
}

TEST(SectionReferencesSlow, HalvesOfBecas) {
  EngineeringConstants stiff = isotropic(100.0, 0.2), soft = isotropic(10.0, 0.2);
  stiff.g12 = stiff.g13 = stiff.g23 = 41.667;
  soft.g12 = soft.g13 = soft.g23 = 4.1667;
  // Its halves lie side by side along x, ours one upon the other: x is b3, y is -b2.
  const Converged c =
      converge(rectangle(0.1, {{0, 0.05, 0.0}, {1, 0.05, 0.0}},
                         {{stiffness_of(stiff), 1.0, "stiff"}, {stiffness_of(soft), 1.0, "soft"}}),
               Vec3::Zero(), 1e-6);
  ASSERT_TRUE(c.reached);
  const Mat6& d = c.analysis.stiffness;
  expect_near(d(2, 2), .1263187, 1e-6, "shear across");
  expect_near(d(1, 1), .1906157, 1e-6, "shear along");
  expect_near(d(0, 0), .55, 1e-6, "extension");
  expect_near(d(4, 4), 4.583333e-4, 1e-6, "bending");
  expect_near(d(5, 5), 4.583333e-4, 1e-6, "bending");
  expect_near(d(3, 3), 2.739553e-4, 1e-6, "torsion");
  expect_near(std::abs(d(1, 3)), 3.898958e-3, 1e-6, "shear and torsion");
  expect_near(d(0, 4), -1.125e-2, 1e-6, "extension and bending");  // the stiff half below
}

TEST(SectionReferencesSlow, OrthotropicOfBecas) {
  const EngineeringConstants k{480, 120, 120, 60, 50, 60, .19, .26, .19};
  const Converged c =
      converge(rectangle(0.1, {{0, 0.1, 22.5 * degree}}, one(k)), Vec3::Zero(), 1e-5);
  ASSERT_TRUE(c.reached);
  const Mat6& d = c.analysis.stiffness;
  expect_near(d(1, 1), .7531300, 1e-5, "shear");
  expect_near(d(2, 2), .4097929, 1e-5, "shear");
  expect_near(d(0, 0), 3.426845, 1e-6, "extension");
  expect_near(d(4, 4), 2.485878e-3, 1e-6, "bending");
  expect_near(d(5, 5), 2.263929e-3, 1e-6, "bending");
  expect_near(d(3, 3), 9.415514e-4, 1e-5, "torsion");
  expect_near(d(0, 1), .7313142, 1e-6, "extension and shear");
  expect_near(d(3, 4), -4.571389e-4, 1e-5, "torsion and bending");
}

const std::vector<MeshMaterial> graphite =
    one(transversely_isotropic(181e9, 10.3e9, 7.17e9, 0.28, 0.33));

// Of the whole walls: D22 14 % below that of the mitred box.
TEST(SectionReferencesSlow, CornersThatButt) {
  const Layup layup{{0, 1.6e-3, -30 * degree}, {0, 1.6e-3, 30 * degree}};
  const Converged c =
      converge(box(0.016, 0.016, layup, Corners::butt, graphite), Vec3::Zero(), 1e-4);
  ASSERT_TRUE(c.reached);
  EXPECT_NEAR(c.analysis.stiffness(1, 1) / 2516.5e3, 0.86, 0.005);
  EXPECT_LT(c.analysis.stiffness(0, 0), 10660.1e3);
}

// Where the plies of the paper's box butt one by one, those of the sides between those of top and bottom, D11 is 6 % less and
// D33 14 %. (Where whole walls do, D11 is 11 % less.)
TEST(SectionReferences, PliesThatButt) {
  const double lines[] = {-8, -6.4, -4.8, 4.8, 6.4, 8};
  const double parts[] = {0.0, 0.017, 0.09, 0.5, 0.91, 0.983, 1.0};
  constexpr int order = 3;
  const std::vector<double> places = mbd::gauss_lobatto_rule(order + 1).points;
  Mesh mesh;
  mesh.materials = graphite;
  Places nodes(mesh.nodes, 1e-9);
  const auto fill = [&](int i, int j, double normal, double angle) {
    Element element;
    element.order = order;
    element.normals = {normal};
    element.angle = angle;
    const auto at = [&](int line, std::size_t part, double xi) {
      const double f = 0.5 * ((1 - xi) * parts[part] + (1 + xi) * parts[part + 1]);
      return 1e-3 * ((1 - f) * lines[line] + f * lines[line + 1]);
    };
    for (std::size_t a = 0; a + 1 < std::size(parts); ++a)
      for (std::size_t b = 0; b + 1 < std::size(parts); ++b) {
        element.nodes.clear();
        for (const double eta : places)
          for (const double xi : places)
            element.nodes.push_back(nodes.at(Point(at(i, a, xi), at(j, b, eta))));
        mesh.elements.push_back(element);
      }
  };
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const int across = std::abs(i - 2), along = std::abs(j - 2), ply = std::max(across, along);
      if (ply == 0) continue;
      const double half = std::numbers::pi / 2;
      const double normal = along == ply ? (j > 2 ? half : -half) : (i > 2 ? 0.0 : 2 * half);
      fill(i, j, normal, (ply == 2 ? 30 : -30) * degree);
    }
  const Mat6 d = analyse(mesh).stiffness;
  EXPECT_NEAR(d(0, 0) / 10660.1e3, 0.94, 0.002);
  EXPECT_NEAR(d(2, 2) / 2516.5e3, 0.86, 0.005);
}

}  // namespace
}  // namespace mbd::test::test_section_references
