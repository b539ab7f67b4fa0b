// Meshes of Gmsh: both formats, as text and bytes, of all five kinds of elements, give the same section as the program's own meshes and
// closed forms; groups are materials; what is no section is refused by name and place; triangles of all orders.
// Mutations have not been tried yet.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "libmbd/core/error.hpp"
#include "libmbd/section/gmsh.hpp"
#include "libmbd/section/shape_functions.hpp"
#include "libmbd/section/stress.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_gmsh {
namespace {

using namespace section;
using section::Element, section::Mesh;
constexpr double pi = std::numbers::pi;

// A rectangle of unequal cells, as numbers of Gmsh: nodes, and elements of a type with a physical surface.
struct Model {
  std::vector<std::array<double, 3>> nodes;
  struct Cell {
    int type, physical;
    std::vector<int> nodes;  // from 1
  };
  std::vector<Cell> cells;
  std::vector<std::pair<int, std::string>> names;
};

int add(Model& model, double x, double y) {
  model.nodes.push_back({x, y, 0.0});
  return static_cast<int>(model.nodes.size());
}

// columns x rows quadrilaterals over width x height about 0, each one cell of type 3, 16, 10, or two of 2, 9. Left half of
// physical surface 1, right half of 2. `bend` moves what is inside.
Model grid(int type, int columns, int rows, double width, double height, double bend = 0.0) {
  Model model;
  const int nx = 2 * columns + 1, ny = 2 * rows + 1;
  std::vector<int> known(static_cast<std::size_t>(nx * ny), 0);
  const auto at = [&](int i, int j) {
    int& n = known[static_cast<std::size_t>(i + nx * j)];
    if (n == 0) {
      const double u = static_cast<double>(i) / (nx - 1), v = static_cast<double>(j) / (ny - 1);
      const double off = bend * std::sin(pi * u) * std::sin(pi * v);
      n = add(model, width * (u - 0.5) + off, height * (v - 0.5) + off);
    }
    return n;
  };
  for (int j = 0; j < 2 * rows; j += 2)
    for (int i = 0; i < 2 * columns; i += 2) {
      const int physical = i < columns ? 1 : 2;
      const int a = at(i, j), b = at(i + 2, j), c = at(i + 2, j + 2), d = at(i, j + 2);
      if (type == 2) {
        model.cells.push_back({type, physical, {a, b, c}});
        model.cells.push_back({type, physical, {a, c, d}});
      } else if (type == 9) {
        const int m = at(i + 1, j + 1);
        model.cells.push_back({type, physical, {a, b, c, at(i + 1, j), at(i + 2, j + 1), m}});
        model.cells.push_back({type, physical, {a, c, d, m, at(i + 1, j + 2), at(i, j + 1)}});
      } else {
        Model::Cell cell{type, physical, {a, b, c, d}};
        if (type != 3)
          for (const int n : {at(i + 1, j), at(i + 2, j + 1), at(i + 1, j + 2), at(i, j + 1)})
            cell.nodes.push_back(n);
        if (type == 10) cell.nodes.push_back(at(i + 1, j + 1));
        model.cells.push_back(cell);
      }
    }
  return model;
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string names_of(const Model& model) {
  if (model.names.empty()) return {};
  std::string text = "$PhysicalNames\n" + std::to_string(model.names.size()) + "\n";
  for (const auto& [tag, name] : model.names)
    text += "2 " + std::to_string(tag) + " \"" + name + "\"\n";
  return text + "$EndPhysicalNames\n";
}

std::string old_format(const Model& model, bool binary) {
  std::ostringstream text;
  text.precision(17);
  std::string bytes;
  const auto n = model.nodes.size();
  if (!binary) {
    text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" << names_of(model) << "$Nodes\n" << n << "\n";
    for (std::size_t i = 0; i < n; ++i)
      text << i + 1 << " " << model.nodes[i][0] << " " << model.nodes[i][1] << " "
           << model.nodes[i][2] << "\n";
    text << "$EndNodes\n$Elements\n"
         << model.cells.size() + 1 << "\n1 1 2 0 7 1 2\n";  // a line, too
    for (std::size_t e = 0; e < model.cells.size(); ++e) {
      text << e + 2 << " " << model.cells[e].type << " 2 " << model.cells[e].physical << " 5";
      for (const int node : model.cells[e].nodes) text << " " << node;
      text << "\n";
    }
    text << "$EndElements\n";
    return text.str();
  }
  bytes = "$MeshFormat\n2.2 1 8\n";
  put(bytes, 1);
  bytes += "\n$EndMeshFormat\n" + names_of(model) + "$Nodes\n" + std::to_string(n) + "\n";
  for (std::size_t i = 0; i < n; ++i) {
    put(bytes, static_cast<int>(i + 1));
    for (const double x : model.nodes[i]) put(bytes, x);
  }
  bytes += "\n$EndNodes\n$Elements\n" + std::to_string(model.cells.size()) + "\n";
  for (std::size_t e = 0; e < model.cells.size(); ++e) {
    for (const int x :
         {model.cells[e].type, 1, 2, static_cast<int>(e + 2), model.cells[e].physical, 5})
      put(bytes, x);
    for (const int node : model.cells[e].nodes) put(bytes, node);
  }
  return bytes + "\n$EndElements\n";
}

// 4.1: surface 10 + p is of physical surface p (none of 0). Numbers by a sink, as text or bytes.
std::string new_format(const Model& model, bool binary) {
  std::string out = std::string("$MeshFormat\n4.1 ") + (binary ? "1" : "0") + " 8\n";
  const auto number = [&](auto x) {
    if (binary) {
      put(out, x);
      return;
    }
    std::ostringstream text;
    text.precision(17);
    text << x << " ";
    out += text.str();
  };
  const auto size = [&](std::size_t x) { number(x); };
  if (binary) {
    put(out, 1);
    out += "\n";
  }
  out += "$EndMeshFormat\n" + names_of(model) + "$Entities\n";
  for (const std::size_t x : {1UL, 1UL, 3UL, 0UL}) size(x);
  number(1);
  for (int i = 0; i < 3; ++i) number(0.0);
  size(0);
  number(7);
  for (int i = 0; i < 6; ++i) number(0.0);
  size(0);
  size(2);
  number(1);
  number(-2);
  for (int p = 0; p < 3; ++p) {
    number(10 + p);
    for (int i = 0; i < 6; ++i) number(0.0);
    size(p == 0 ? 0 : 1);
    if (p > 0) number(p);
    size(1);
    number(7);
  }
  out += "\n$EndEntities\n$Nodes\n";
  const std::size_t n = model.nodes.size();
  for (const std::size_t x : {std::size_t{1}, n, std::size_t{1}, n}) size(x);
  for (const int x : {2, 10, 0}) number(x);
  size(n);
  for (std::size_t i = 0; i < n; ++i) size(i + 1);
  for (const auto& node : model.nodes)
    for (const double x : node) number(x);
  out += "\n$EndNodes\n$Elements\n";
  const std::size_t m = model.cells.size();
  for (const std::size_t x : {m + 1, m + 1, std::size_t{1}, m + 1}) size(x);
  for (const int x : {1, 7, 1}) number(x);  // a line, too
  size(1);
  for (const std::size_t x : {1UL, 1UL, 2UL}) size(x);
  for (std::size_t e = 0; e < m; ++e) {
    for (const int x : {2, 10 + model.cells[e].physical, model.cells[e].type}) number(x);
    size(1);
    size(e + 2);
    for (const int node : model.cells[e].nodes) size(static_cast<std::size_t>(node));
  }
  return out + "\n$EndElements\n";
}

class Gmsh : public testing::Test {
 protected:
  GmshMesh read(const std::string& bytes, double unit = 1.0) const {
    std::ofstream(file_, std::ios::binary) << bytes;
    return read_gmsh(file_, unit);
  }
  std::string message(const std::string& bytes) const {
    try {
      const GmshMesh mesh = read(bytes);
      analyse(mesher_of(mesh, std::vector<MeshPart>(mesh.groups.size()), steel)({2, 1}));
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  }
  const TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_.path() / "m.msh";
  const std::vector<MeshMaterial> steel{{stiffness_of(isotropic(200e9, 0.3)), 7800.0, "steel"}};
};

Mat6 stiffness_of_mesh(const GmshMesh& mesh, const std::vector<MeshMaterial>& materials,
                       int order) {
  std::vector<MeshPart> parts(mesh.groups.size());
  for (std::size_t g = 0; g < parts.size(); ++g)
    parts[g].material = static_cast<int>(std::min(g, materials.size() - 1));
  return analyse(mesher_of(mesh, parts, materials)({order, 1})).stiffness;
}

double difference(const Mat6& a, const Mat6& b) {
  const Vec6 root = b.diagonal().cwiseSqrt();
  return ((a - b).array() / (root * root.transpose()).array()).abs().maxCoeff();
}

TEST_F(Gmsh, KindsOfElements) {
  const Mat6 exact = analyse(rectangle(0.2, {{0, 0.1, 0.0}}, steel)({8, 3})).stiffness;
  for (const int type : {2, 3, 9, 10, 16}) {
    const Model model = grid(type, 4, 2, 0.2, 0.1, type == 2 || type == 3 ? 0.0 : 0.004);
    const std::string text = old_format(model, false);
    const GmshMesh mesh = read(text);
    ASSERT_EQ(mesh.cells.size(), model.cells.size());
    const Mat6 once = stiffness_of_mesh(mesh, steel, 2);
    EXPECT_LT(difference(once, exact), 2e-2) << type;
    EXPECT_LT(difference(stiffness_of_mesh(mesh, steel, 6), exact), 1e-5) << type;
    for (const std::string& other :
         {old_format(model, true), new_format(model, false), new_format(model, true)})
      EXPECT_EQ(difference(stiffness_of_mesh(read(other), steel, 2), once), 0.0) << type;
  }
}

TEST_F(Gmsh, UnitsAndTolerance) {
  Model model = grid(9, 4, 2, 200.0, 100.0);
  const GmshMesh mesh = read(new_format(model, true), 1e-3);
  const Converged c =
      converge_orders(mesher_of(mesh, {{}, {}}, steel), Vec3::Zero(), 1e-4, 100'000);
  ASSERT_TRUE(c.reached);
  const Mat6 exact = analyse(rectangle(0.2, {{0, 0.1, 0.0}}, steel)({8, 3})).stiffness;
  const Vec6 root = exact.diagonal().cwiseSqrt();
  EXPECT_TRUE(((c.analysis.stiffness - exact).cwiseAbs().array() <= c.error.array()).all());
  EXPECT_LT((c.error.array() / (root * root.transpose()).array()).maxCoeff(), 1e-4);
  EXPECT_FALSE(converge_orders(mesher_of(mesh, {{}, {}}, steel), Vec3::Zero(), 1e-9, 1000).reached);
}

TEST_F(Gmsh, GroupsAreMaterials) {
  Model model = grid(3, 4, 2, 0.2, 0.1);
  model.names = {{1, "soft core"}, {2, "shell"}};
  std::vector<MeshMaterial> two = steel;
  two.push_back({stiffness_of(isotropic(20e9, 0.3)), 780.0, "soft"});
  for (const bool binary : {false, true})
    for (const std::string& bytes : {old_format(model, binary), new_format(model, binary)}) {
      const GmshMesh mesh = read(bytes);
      ASSERT_EQ(mesh.groups, (std::vector<std::string>{"soft core", "shell"}));
      std::vector<MeshPart> parts{{1, 0.0, 0.0}, {0, 0.0, 0.0}};
      const Mat6 d = analyse(mesher_of(mesh, parts, two)({2, 1})).stiffness;
      EXPECT_NEAR(d(0, 0) / (110e9 * 0.02), 1.0, 1e-9);
      // The stiff half lies at positive x2: a stretch is a moment -M3.
      EXPECT_NEAR(d(0, 5) / (-90e9 * 0.02 * 0.05), 1.0, 1e-9);
    }
  // Numbers where there are no names; none.
  model.names.clear();
  model.cells.front().physical = 0;
  EXPECT_EQ(read(new_format(model, false)).groups, (std::vector<std::string>{"", "1", "2"}));
}

// A layer of fibres along theta with its normal b3, as the program's own rectangle has it.
TEST_F(Gmsh, PliesLieAsStated) {
  const std::vector<MeshMaterial> ud{
      {stiffness_of(transversely_isotropic(140e9, 10e9, 5e9, 0.3, 0.4)), 1600.0, "ud"}};
  const double theta = 0.5;
  const GmshMesh mesh = read(old_format(grid(10, 4, 4, 0.02, 0.01), false));
  const Mat6 d =
      analyse(mesher_of(mesh, {{0, theta, pi / 2}, {0, theta, pi / 2}}, ud)({6, 1})).stiffness;
  EXPECT_LT(difference(d, analyse(rectangle(0.02, {{0, 0.01, theta}}, ud)({7, 3})).stiffness),
            1e-4);
  EXPECT_GT(difference(d, analyse(rectangle(0.02, {{0, 0.01, -theta}}, ud)({7, 3})).stiffness),
            0.1);
}

TEST_F(Gmsh, SeenFromBelow) {
  for (const int type : {2, 9, 3, 10, 16}) {
    Model model = grid(type, 2, 2, 0.2, 0.1);
    const Mat6 d = stiffness_of_mesh(read(old_format(model, false)), steel, 2);
    for (auto& node : model.nodes) node[0] *= -1.0;  // all are clockwise now
    const Mat6 mirrored = stiffness_of_mesh(read(old_format(model, false)), steel, 2);
    // Couplings that a mesh of triangles makes change their signs.
    EXPECT_LT((mirrored.cwiseAbs() - d.cwiseAbs())
                  .diagonal()
                  .cwiseQuotient(d.diagonal())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-10)
        << type;
    EXPECT_LT(difference(mirrored.cwiseAbs(), d.cwiseAbs()), 1e-10) << type;
  }
}

TEST_F(Gmsh, Refused) {
  const auto expect = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said << "\nwanted: " << part;
  };
  const Model whole = grid(3, 4, 2, 0.2, 0.1);
  const std::string text = old_format(whole, false), bytes = new_format(whole, true);
  EXPECT_EQ(message(text), "nothing");
  expect(message("solid of something else"), "begins with $MeshFormat");
  expect(message("$MeshFormat\n3 0 8\n"), "format 3 is not known; save it as version 2.2 or 4.1");
  expect(message(text.substr(0, text.size() / 2)), "m.msh:");
  expect(message(bytes.substr(0, bytes.size() / 2)), "it ends where");
  std::string letters = text;
  letters.replace(letters.find("\n1 "), 3, "\nx ");
  expect(message(letters), "m.msh:6: a node's number is missing");
  Model broken = whole;
  broken.cells[2].nodes[1] = 999;
  expect(message(old_format(broken, false)), "element 4: there is no node 999");
  broken = whole;
  broken.cells[0].type = 21;
  expect(message(old_format(broken, false)), "elements of type 21");
  broken = whole;
  broken.nodes[4][2] = 0.01;
  expect(message(new_format(broken, false)), "leaves the plane");
  // A corner drawn through the opposite side: the cell is turned, and lies upon its neighbours.
  broken = whole;
  broken.nodes[static_cast<std::size_t>(broken.cells[5].nodes[0] - 1)] = {0.09, 0.049, 0.0};
  const std::string inverted = message(old_format(broken, false));
  EXPECT_TRUE(inverted.find("inverted") != std::string::npos ||
              inverted.find("no area") != std::string::npos)
      << inverted;
  expect(inverted, "near x2 = ");
  // The two halves with nodes of their own, upon each other, or apart.
  broken = whole;
  std::map<int, int> copies;
  for (Model::Cell& cell : broken.cells)
    if (cell.physical == 2)
      for (int& node : cell.nodes) {
        const auto [it, fresh] = copies.emplace(node, static_cast<int>(broken.nodes.size()) + 1);
        if (fresh) broken.nodes.push_back(broken.nodes[static_cast<std::size_t>(node - 1)]);
        node = it->second;
      }
  expect(message(old_format(broken, false)),
         "of 2 near x2 = 0, x3 = -0.05: the section is in pieces");
  // Joined above only: the seam below is open.
  Model slit = broken;
  for (Model::Cell& cell : slit.cells)
    for (int& node : cell.nodes)
      if (slit.nodes[static_cast<std::size_t>(node - 1)][1] > -0.02)
        for (const auto& [old, fresh] : copies)
          if (fresh == node) node = old;
  expect(message(old_format(slit, false)), "is open there");
  // Twice the same.
  broken = whole;
  broken.cells.push_back(broken.cells.front());
  expect(message(old_format(broken, false)), "overlaps");
  // Orders that do not fit.
  broken = grid(10, 2, 2, 0.2, 0.1);
  broken.cells.front().type = 3;
  broken.cells.front().nodes.resize(4);
  expect(message(old_format(broken, false)), "another node in the middle");
}

// Triangles of order p: polynomials of degree p and their derivatives are exact, integrals to degree 2 p.
TEST(SectionTriangles, AreExactToTheirDegree) {
  ShapeTables tables;
  for (int p = 1; p <= 8; ++p) {
    const Eigen::MatrixX2d nodes = node_places(Shape::triangle, p);
    ASSERT_EQ(nodes.rows(), nodes_of(Shape::triangle, p));
    for (int a = 0; a <= p; ++a)
      for (int b = 0; a + b <= p; ++b) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const double x = 0.21, y = 0.37;
        const Eigen::MatrixX3d s = shape_functions(Shape::triangle, p, x, y);
        for (Index i = 0; i < nodes.rows(); ++i)
          sum += std::pow(nodes(i, 0), a) * std::pow(nodes(i, 1), b) * s.row(i).transpose();
        EXPECT_NEAR(sum(0), std::pow(x, a) * std::pow(y, b), 1e-13);
        EXPECT_NEAR(sum(1), a == 0 ? 0.0 : a * std::pow(x, a - 1) * std::pow(y, b), 1e-11);
        EXPECT_NEAR(sum(2), b == 0 ? 0.0 : b * std::pow(x, a) * std::pow(y, b - 1), 1e-11);
      }
    const ShapeTable& table = tables.of(Shape::triangle, p);
    const int degree = p == 1 ? 2 : p == 2 ? 5 : 2 * p;
    for (int a = 0; a <= degree; ++a) {
      // Integral of x^a y^b over the triangle: a! b!/(a + b + 2)!
      const int b = degree - a;
      double sum = 0.0;
      for (std::size_t i = 0; i < table.weights.size(); ++i) {
        const auto row = static_cast<Index>(i);
        const double x = (table.n.row(row) * nodes.col(0)).value(),
                     y = (table.n.row(row) * nodes.col(1)).value();
        sum += table.weights[i] * std::pow(x, a) * std::pow(y, b);
      }
      EXPECT_NEAR(sum / (std::tgamma(a + 1) * std::tgamma(b + 1) / std::tgamma(a + b + 3)), 1.0,
                  1e-11)
          << p << " " << a;
    }
  }
}

}  // namespace
}  // namespace mbd::test::test_gmsh
