// What an analysis of a section costs, in counts that do not depend on the machine: matrices factorised, right-hand sides
// that went through the factors, entries and multiplications of the factors over unknowns.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libmbd/section/analysis.hpp"
#include "libmbd/section/cells.hpp"
#include "libmbd/section/factors.hpp"

namespace mbd::test::test_section_costs {
namespace {

using namespace section;
using section::Mesh;  // and not how elements lie along a beam

// n x n equal squares over .1 m x .1 m, one element each.
Mesh squares(int n, int order) {
  std::vector<Cell> cells;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      Cell cell;
      cell.map = [i, j, n](double xi, double eta) {
        return Point(0.1 * (i + xi) / n, 0.1 * (j + eta) / n);
      };
      cell.normal = [](double, double) { return 0.5 * std::numbers::pi; };
      cell.marked = {false, false, false, false};
      cells.push_back(cell);
    }
  const std::vector<MeshMaterial> steel{{stiffness_of(isotropic(210e9, 0.3)), 7800.0, "steel"}};
  return mesh_of(cells, {order, 1}, steel, 1e-8);
}

struct Work {
  double unknowns = 0.0, entries = 0.0, products = 0.0;
};
Work work_of(const Mesh& mesh) {
  Work work;
  for (const Front& front : dissect(mesh)) {
    const auto own = 3.0 * static_cast<double>(front.own.size()),
               border = 3.0 * static_cast<double>(front.border.size());
    work.unknowns += own;
    work.entries += own * (0.5 * own + border);
    work.products += own * (own * own / 6.0 + 0.5 * own * border + 0.5 * border * border);
  }
  return work;
}

// Nested dissection of n unknowns has n log n entries and n^1.5 multiplications (George 1973); columns one after the other
// along the mesh n^1.5 and n^2.
TEST(SectionCosts, FactorsOfTenThousandQuadraticElements) {
  const Work coarse = work_of(squares(25, 2)), fine = work_of(squares(100, 2));
  ASSERT_EQ(fine.unknowns, 3 * 201 * 201);
  const double size = std::log(fine.unknowns / coarse.unknowns);
  EXPECT_LT(std::log(fine.entries / coarse.entries) / size, 1.2);
  EXPECT_LT(std::log(fine.products / coarse.products) / size, 1.55);
  EXPECT_LT(fine.entries / fine.unknowns, 160.0);
  EXPECT_LT(fine.products / fine.unknowns, 23e3);
}

// The border's 18, and two refinements of six solutions; of a curved beam two borders, and four columns (two more are
// conjugate) refined once or twice.
TEST(SectionCosts, OneFactorisationAndFewSolutionsAtAnySize) {
  for (const int n : {5, 20}) {
    const Mesh mesh = squares(n, 2);
    const Analysis straight = analyse(mesh);
    EXPECT_EQ(straight.factorisations, 1) << n;
    EXPECT_EQ(straight.solutions, 18 + 2 * 6) << n;
    const Analysis curved = analyse(mesh, Vec3(0.3, 0.2, -0.5));
    EXPECT_EQ(curved.factorisations, 2) << n;
    EXPECT_LE(curved.solutions, 2 * 18 + 4 * 2) << n;
  }
}

}  // namespace
}  // namespace mbd::test::test_section_costs
