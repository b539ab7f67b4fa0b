#include "libmbd/section/analysis.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/section/factors.hpp"
#include "libmbd/section/shape_functions.hpp"

namespace mbd::section {
namespace {

template <class Scalar>
using MatrixOf = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <class Scalar>
using Columns6 = Eigen::Matrix<Scalar, 6, Eigen::Dynamic>;
using Complex = std::complex<double>;

Mat3 cross(const Vec3& x) {
  Mat3 m;
  m << 0.0, -x(2), x(1), x(2), 0.0, -x(0), -x(1), x(0), 0.0;
  return m;
}

// Z at a place, and at all nodes: displacements by the motion of the section as a rigid one.
Eigen::Matrix<double, 3, 6> rigid(const Point& x) {
  Eigen::Matrix<double, 3, 6> z;
  z << Mat3::Identity(), -cross(Vec3(0.0, x(0), x(1)));
  return z;
}

// Nodal resultants of stress on the face of the section, P, and of the rest, Q: P' = Q in equilibrium.
template <class Scalar>
struct Resultants {
  MatrixOf<Scalar> p, q;
};

// One element at its integration points.
struct Integrated {
  const ShapeTable* table = nullptr;
  // (node, 3 points): shape functions at all points, then their derivatives along b2, then those along b3.
  Eigen::MatrixXd shapes;
  std::vector<double> area, metric;
  std::vector<Point> at;
  std::vector<Stiffness> stiffness;  // one, or one a point
  const Stiffness& c(std::size_t point) const {
    return stiffness[stiffness.size() == 1 ? 0 : point];
  }
};

std::string of(const Mesh& mesh, std::size_t e, double unit = 1.0) {
  const Element& element = mesh.elements[e];
  std::string text = fmt::format("element {}", e + 1);
  if (!element.name.empty()) text += " (" + element.name + ")";
  const Point& x = mesh.nodes[static_cast<std::size_t>(element.nodes.front())];
  return text + fmt::format(" near x2 = {:g}, x3 = {:g}", x(0) * unit, x(1) * unit);
}

void check(const Mesh& mesh) {
  if (mesh.elements.empty()) throw Error("a section without elements");
  for (const MeshMaterial& material : mesh.materials) {
    const Eigen::LDLT<Mat6> ldlt(material.stiffness);
    const Vec6 d = ldlt.vectorD();
    if (!material.stiffness.allFinite() || ldlt.info() != Eigen::Success ||
        !(d.minCoeff() > 1e-12 * d.maxCoeff()))
      throw Error(
          fmt::format("material \"{}\": its stiffness is not positive definite", material.name));
    if (!(material.density >= 0.0) || !std::isfinite(material.density))
      throw Error(
          fmt::format("material \"{}\": its density is negative or not finite", material.name));
  }
  const std::size_t nodes = mesh.nodes.size();
  DisjointSets joined(static_cast<int>(nodes));
  std::vector<bool> used(nodes, false);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    const auto count = static_cast<std::size_t>(nodes_of(element.shape, element.order));
    if (element.nodes.size() != count)
      throw Error(fmt::format("element {}: it has {} nodes where its kind has {}", e + 1,
                              element.nodes.size(), count));
    for (const int node : element.nodes) {
      if (node < 0 || static_cast<std::size_t>(node) >= nodes)
        throw Error(fmt::format("element {}: there is no node {}", e + 1, node));
      used[static_cast<std::size_t>(node)] = true;
      joined.join(element.nodes.front(), node);
    }
    if (element.material < 0 || static_cast<std::size_t>(element.material) >= mesh.materials.size())
      throw Error(fmt::format("{}: it has no material", of(mesh, e)));
    if (element.normals.size() != 1 && element.normals.size() != count)
      throw Error(fmt::format("{}: normals for one or all of its nodes", of(mesh, e)));
  }
  const int first = mesh.elements.front().nodes.front();
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (joined.root(mesh.elements[e].nodes.front()) != joined.root(first))
      throw Error(fmt::format("the section is in pieces: {} is not joined to element 1 by nodes",
                              of(mesh, e)));
  for (std::size_t n = 0; n < nodes; ++n)
    if (!used[n]) throw Error(fmt::format("node {} is of no element", n + 1));
}

// ---- the operators of a section ---------------------------------------------------------------

class Operators {
 public:
  Operators(const Mesh& mesh, const Vec3& curvature, double unit)
      : mesh_(mesh), k_(curvature), unit_(unit) {
    elements_.reserve(mesh.elements.size());
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) elements_.push_back(integrate(e));
  }

  const Mesh& mesh() const { return mesh_; }
  Index size() const { return 3 * static_cast<Index>(mesh_.nodes.size()); }

  // (4): what a field makes of displacements of nodes w, their derivatives along the line dw and strains of the section as a
  // rigid one g, column by column.
  template <class Scalar>
  Resultants<Scalar> act(const MatrixOf<Scalar>& w, const MatrixOf<Scalar>& dw,
                         const Columns6<Scalar>& g) const {
    const Index columns = g.cols();
    Resultants<Scalar> sum{MatrixOf<Scalar>::Zero(size(), columns),
                           MatrixOf<Scalar>::Zero(size(), columns)};
    MatrixOf<Scalar> nodal, at, along, p, q;  // (3 column + component, node or place among shapes)
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const std::vector<int>& nodes = mesh_.elements[e].nodes;
      const Integrated& element = elements_[e];
      const auto points = static_cast<Index>(element.area.size());
      const auto n = element.shapes.leftCols(points);
      gather(w, nodes, nodal);
      at.noalias() = nodal * element.shapes;
      gather(dw, nodes, nodal);
      along.noalias() = nodal * n;
      for (Index i = 0; i < points; ++i) stress_at(element, i, g, at, along);
      p.noalias() = along * n.transpose();
      q.noalias() = at * element.shapes.transpose();
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const auto node = static_cast<Index>(a);
        for (Index c = 0; c < columns; ++c) {
          sum.p.template block<3, 1>(3 * nodes[a], c) += p.template block<3, 1>(3 * c, node);
          sum.q.template block<3, 1>(3 * nodes[a], c) += q.template block<3, 1>(3 * c, node);
        }
      }
    }
    return sum;
  }

  // (6): the Hermitian matrix of displacements that go as exp(lambda s), lambda 0 or imaginary, of an element.
  template <class Scalar>
  void matrix(std::size_t e, Scalar lambda, MatrixOf<Scalar>& result) const {
    const Integrated& element = elements_[e];
    const auto points = static_cast<Index>(element.area.size());
    const Index nodes = element.shapes.rows();
    MatrixOf<Scalar> strains = MatrixOf<Scalar>::Zero(6 * points, 3 * nodes),
                     stresses(6 * points, 3 * nodes);
    const Matrix3<Scalar> turn =
        cross(k_).template cast<Scalar>() + lambda * Matrix3<Scalar>::Identity();
    for (Index i = 0; i < points; ++i) {
      const auto point = static_cast<std::size_t>(i);
      const Point& x = element.at[point];
      for (Index a = 0; a < nodes; ++a) {
        const double n = element.shapes(a, i), d2 = element.shapes(a, points + i),
                     d3 = element.shapes(a, 2 * points + i);
        Matrix3<Scalar> along1 = turn * n;
        along1.diagonal().array() += k_(0) * (x(1) * d2 - x(0) * d3);
        along1 /= element.metric[point];
        auto b = strains.template block<6, 3>(6 * i, 3 * a);
        b.row(0) = along1.row(0);
        b(1, 1) = d2;
        b(2, 2) = d3;
        b(3, 1) = d3;
        b(3, 2) = d2;
        b.row(4) = along1.row(2);
        b(4, 0) += d3;
        b.row(5) = along1.row(1);
        b(5, 0) += d2;
      }
      const Mat6 weighted = element.area[point] * element.metric[point] * element.c(point);
      stresses.template middleRows<6>(6 * i).noalias() =
          weighted.template cast<Scalar>() * strains.template middleRows<6>(6 * i);
    }
    result.noalias() = strains.adjoint() * stresses;
  }

  Eigen::MatrixX<double> rigid_at_nodes() const {
    Eigen::MatrixXd z(size(), 6);
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i)
      z.middleRows<3>(static_cast<Index>(3 * i)) = rigid(mesh_.nodes[i]);
    return z;
  }

  // Integrals of shape functions times Z: conditions on the gauge are that displacements times it vanish.
  Eigen::MatrixXd gauge() const {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size(), 6);
    each_point([&](std::size_t e, std::size_t point) {
      const Integrated& element = elements_[e];
      const std::vector<int>& nodes = mesh_.elements[e].nodes;
      const Eigen::Matrix<double, 3, 6> z = element.area[point] * rigid(element.at[point]);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        h.middleRows<3>(3 * nodes[a]) +=
            element.table->n(static_cast<Index>(point), static_cast<Index>(a)) * z;
    });
    return h;
  }

  Mat6 mass() const {
    Mat6 m = Mat6::Zero();
    each_point([&](std::size_t e, std::size_t point) {
      const Integrated& element = elements_[e];
      const Eigen::Matrix<double, 3, 6> z = rigid(element.at[point]);
      const double density =
          mesh_.materials[static_cast<std::size_t>(mesh_.elements[e].material)].density;
      m += density * element.area[point] * element.metric[point] * z.transpose() * z;
    });
    return m;
  }

  double area() const {
    double sum = 0.0;
    each_point([&](std::size_t e, std::size_t point) { sum += elements_[e].area[point]; });
    return sum;
  }

 private:
  template <class F>
  void each_point(const F& f) const {
    for (std::size_t e = 0; e < elements_.size(); ++e)
      for (std::size_t point = 0; point < elements_[e].area.size(); ++point) f(e, point);
  }

  // Rows 3 column + component; nodes by columns.
  template <class Scalar>
  static void gather(const MatrixOf<Scalar>& all, const std::vector<int>& nodes,
                     MatrixOf<Scalar>& some) {
    some.resize(3 * all.cols(), static_cast<Index>(nodes.size()));
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (Index c = 0; c < all.cols(); ++c)
        some.template block<3, 1>(3 * c, static_cast<Index>(a)) =
            all.template block<3, 1>(3 * nodes[a], c);
  }

  // Of point i of an element, in place of its displacements, `at` and their derivatives along b2 and b3, and of those along
  // the line, `along`: what shape functions and their derivatives weight in Q, and in P.
  template <class Scalar>
  void stress_at(const Integrated& element, Index i, const Columns6<Scalar>& g,
                 MatrixOf<Scalar>& at, MatrixOf<Scalar>& along) const {
    const auto point = static_cast<std::size_t>(i);
    const auto points = static_cast<Index>(element.area.size());
    const double area = element.area[point], metric = element.metric[point];
    const Point& x = element.at[point];
    const Mat3 turn = cross(k_);
    const Eigen::Matrix<double, 3, 6> z = rigid(x);
    for (Index c = 0; c < g.cols(); ++c) {
      auto here = at.template block<3, 1>(3 * c, i),
           along2 = at.template block<3, 1>(3 * c, points + i),
           along3 = at.template block<3, 1>(3 * c, 2 * points + i),
           along1 = along.template block<3, 1>(3 * c, i);
      const Vector3<Scalar> d1 =
          (along1 + turn * here + k_(0) * (x(1) * along2 - x(0) * along3) + z * g.col(c)) / metric;
      Vector6<Scalar> strain;
      strain << d1(0), along2(1), along3(2), along2(2) + along3(1), d1(2) + along3(0),
          d1(1) + along2(0);
      const Vector6<Scalar> stress = area * (element.c(point) * strain);
      const Vector3<Scalar> face(stress(0), stress(5), stress(4)),
          on2(stress(5), stress(1), stress(3)), on3(stress(4), stress(3), stress(2));
      along1 = face;
      here = turn.transpose() * face;
      along2 = metric * on2 + k_(0) * x(1) * face;
      along3 = metric * on3 - k_(0) * x(0) * face;
    }
  }

  Integrated integrate(std::size_t e) {
    const Element& element = mesh_.elements[e];
    Integrated result;
    result.table = &tables_.of(element.shape, element.order);
    const ShapeTable& table = *result.table;
    const auto nodes = static_cast<Index>(element.nodes.size());
    Eigen::MatrixX2d x(nodes, 2);
    for (Index a = 0; a < nodes; ++a)
      x.row(a) = mesh_.nodes[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(a)])];
    const Index points = table.n.rows();
    const Eigen::MatrixX2d at = table.n * x, dx1 = table.d1 * x, dx2 = table.d2 * x;
    result.shapes.resize(nodes, 3 * points);
    result.shapes.leftCols(points) = table.n.transpose();
    const Stiffness& material =
        mesh_.materials[static_cast<std::size_t>(element.material)].stiffness;
    if (element.normals.size() == 1)
      result.stiffness = {in_section_axes(material, element.angle, element.normals.front())};
    for (Index i = 0; i < points; ++i) {
      const double determinant = dx1(i, 0) * dx2(i, 1) - dx1(i, 1) * dx2(i, 0);
      if (!(determinant > 0.0))
        throw Error(of(mesh_, e, unit_) +
                    ": it is inverted or has no area; its nodes go round counter-clockwise, b2 to "
                    "the right and b3 up");
      const double metric = 1.0 + k_(1) * at(i, 1) - k_(2) * at(i, 0);
      if (!(metric > 0.0))
        throw Error(
            fmt::format("the curvature is too strong for the section: at x2 = {:g}, x3 = "
                        "{:g}, beyond the centre of curvature, 1 + k2 x3 - k3 x2 = {:g} is "
                        "not positive",
                        at(i, 0) * unit_, at(i, 1) * unit_, metric));
      const auto d1 = table.d1.row(i).transpose(), d2 = table.d2.row(i).transpose();
      result.shapes.col(points + i) = (dx2(i, 1) * d1 - dx1(i, 1) * d2) / determinant;
      result.shapes.col(2 * points + i) = (dx1(i, 0) * d2 - dx2(i, 0) * d1) / determinant;
      result.area.push_back(determinant * table.weights[static_cast<std::size_t>(i)]);
      result.metric.push_back(metric);
      result.at.push_back(at.row(i).transpose());
      if (element.normals.size() > 1) {
        double normal = 0.0;
        for (Index a = 0; a < nodes; ++a)
          normal += table.n(i, a) * element.normals[static_cast<std::size_t>(a)];
        result.stiffness.push_back(in_section_axes(material, element.angle, normal));
      }
    }
    return result;
  }

  const Mesh& mesh_;
  Vec3 k_;
  double unit_;  // of its lengths, for messages [m]
  ShapeTables tables_;
  std::vector<Integrated> elements_;
};

// ---- one system (7) ---------------------------------------------------------------------------

// The bordered system for columns v that go with the eigenvalue lambda, strains g and multipliers mu:
//   E(lambda) v + B g + H mu = r1,   B^H v + K g = r2,   H^T v = r3
// where E may be singular. Six displacements are held by springs, which makes it definite, and freed by the border.
template <class Scalar>
class Bordered {
 public:
  using MatrixX = MatrixOf<Scalar>;
  static constexpr int border = 18;  // springs, strains and multipliers

  Bordered(const Operators& operators, const std::vector<Front>& fronts, Scalar lambda,
           const Eigen::MatrixXd& z, const Eigen::MatrixXd& h)
      : h_(h) {
    const Mesh& mesh = operators.mesh();
    const std::array<std::pair<int, Vec3>, 6> pins = pins_of(mesh);
    std::array<int, 6> holders{};  // elements that get the springs
    for (std::size_t p = 0; p < 6; ++p)
      for (std::size_t e = 0; e < mesh.elements.size(); ++e)
        if (std::ranges::count(mesh.elements[e].nodes, pins[p].first) > 0) {
          holders[p] = static_cast<int>(e);
          break;
        }
    MatrixX element;
    factors_.emplace(mesh, fronts, [&](int e) -> const MatrixX& {
      operators.matrix(static_cast<std::size_t>(e), lambda, element);
      for (std::size_t p = 0; p < 6; ++p) {
        if (holders[p] != e) continue;
        const std::vector<int>& nodes = mesh.elements[static_cast<std::size_t>(e)].nodes;
        const auto row = 3 * (std::ranges::find(nodes, pins[p].first) - nodes.begin());
        element.template block<3, 3>(row, row) +=
            (spring * pins[p].second * pins[p].second.transpose()).template cast<Scalar>();
      }
      return element;
    });
    if (!factors_->definite())
      throw Error(
          "the section's matrix is not positive definite to round-off: its parts are too slender, "
          "or "
          "the stiffnesses of its materials too far apart");

    const MatrixX still = MatrixX::Zero(operators.size(), 6);
    const Resultants<Scalar> of_g =
        operators.act<Scalar>(still, still, Columns6<Scalar>::Identity(6, 6));
    border_ = MatrixX::Zero(operators.size(), border);
    for (std::size_t p = 0; p < 6; ++p)
      border_.template block<3, 1>(3 * pins[p].first, static_cast<Index>(p)) =
          pins[p].second.template cast<Scalar>();
    border_.middleCols(6, 6) = of_g.q - lambda * of_g.p;
    border_.rightCols(6) = h.template cast<Scalar>();
    solved_ = border_;
    factors_->solve(solved_);
    MatrixX small = MatrixX::Zero(border, border);
    small.topLeftCorner(6, 6).diagonal().setConstant(Scalar(1.0 / spring));
    small.block(6, 6, 6, 6) = z.transpose().template cast<Scalar>() * of_g.p;
    small_.compute(small - border_.adjoint() * solved_);
  }

  struct Solution {
    MatrixX v;
    Columns6<Scalar> g, mu;
  };
  Solution solve(MatrixX r1, const Columns6<Scalar>& r2, const Columns6<Scalar>& r3) const {
    factors_->solve(r1);
    MatrixX right = -border_.adjoint() * r1;
    right.middleRows(6, 6) += r2;
    right.bottomRows(6) += r3;
    return freed(std::move(r1), right);
  }
  // With r1 and r3 zero, without a pass over the factors.
  Solution solve(const Columns6<Scalar>& r2) const {
    MatrixX right = MatrixX::Zero(border, r2.cols());
    right.middleRows(6, 6) = r2;
    return freed(MatrixX::Zero(border_.rows(), r2.cols()), right);
  }

 private:
  // Of the solution v with springs, and the border's right-hand side less what v makes of it.
  Solution freed(MatrixX v, const MatrixX& right) const {
    const MatrixX y = small_.solve(right);
    v.noalias() -= solved_ * y;
    return {std::move(v), y.middleRows(6, 6), y.bottomRows(6)};
  }

  static constexpr double spring =
      1.0;  // of the order of the material's stiffness, in units of the analysis

  // Six displacements without which no rigid motion is left: of three nodes far from each other.
  static std::array<std::pair<int, Vec3>, 6> pins_of(const Mesh& mesh) {
    const auto farthest = [&](const auto& measure) {
      int best = 0;
      double value = -1.0;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        if (measure(mesh.nodes[i]) > value) {
          best = static_cast<int>(i);
          value = measure(mesh.nodes[i]);
        }
      return best;
    };
    const Point origin = mesh.nodes.front();
    const int a = farthest([&](const Point& x) { return (x - origin).norm(); });
    const Point at = mesh.nodes[static_cast<std::size_t>(a)];
    const int b = farthest([&](const Point& x) { return (x - at).norm(); });
    const Point along = (mesh.nodes[static_cast<std::size_t>(b)] - at).normalized();
    const int c = farthest(
        [&](const Point& x) { return std::abs(along(0) * (x - at)(1) - along(1) * (x - at)(0)); });
    const Vec3 across(0.0, -along(1), along(0));
    return {{{a, Vec3::UnitX()},
             {a, Vec3::UnitY()},
             {a, Vec3::UnitZ()},
             {b, Vec3::UnitX()},
             {b, across},
             {c, Vec3::UnitX()}}};
  }

  const Eigen::MatrixXd& h_;
  std::optional<Factors<Scalar>> factors_;
  MatrixX border_, solved_;
  Eigen::FullPivLU<MatrixX> small_;
};

// ---- central solutions ------------------------------------------------------------------------

// Columns Q of the unitary matrix with Khat Q = Q T, Khat = K~^T of K = [b1; k], T upper triangular (NOTATION.md 8): first the
// three of moments, then those of forces; along k (any direction of a straight beam) and, with eigenvalues -+ i|k|, across.
struct Schur {
  Eigen::Matrix<Complex, 6, 6> q, t;
};

Schur schur_of(const Vec3& k) {
  const double size = k.norm();
  Eigen::Matrix<Complex, 3, 3> v = Eigen::Matrix<Complex, 3, 3>::Identity();
  if (size > 0.0) {
    const Vec3 along = k / size;
    const Vec3 a = along.unitOrthogonal();
    const Vec3 b = along.cross(a);
    v.col(0) = along.cast<Complex>();
    v.col(1) = (a.cast<Complex>() + Complex(0, 1) * b.cast<Complex>()) / std::sqrt(2.0);
    v.col(2) = v.col(1).conjugate();
  }
  Schur schur;
  schur.q.setZero();
  schur.q.bottomLeftCorner<3, 3>() = v;
  schur.q.topRightCorner<3, 3>() = v;
  schur.t = schur.q.adjoint() * transport_of(k).cast<Complex>() * schur.q;
  // Zero but for round-off: what is below the diagonal, and the rest of the blocks on it.
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      if (i > j || (i != j && i / 3 == j / 3)) schur.t(i, j) = 0.0;
  for (const Index first : {0, 3}) {
    schur.t(first, first) = 0.0;
    schur.t(first + 1, first + 1) = Complex(0.0, schur.t(first + 1, first + 1).imag());
    schur.t(first + 2, first + 2) = std::conj(schur.t(first + 1, first + 1));
  }
  return schur;
}

class CentralSolutions {
 public:
  CentralSolutions(const Mesh& mesh, const Vec3& curvature, double unit)
      : operators_(mesh, curvature, unit),
        k_(curvature),
        z_(operators_.rigid_at_nodes()),
        h_(operators_.gauge()),
        fronts_(dissect(mesh)) {}

  const Operators& operators() const { return operators_; }

  // W (3 nodes x 6) and G for unit resultants, and what they make.
  void solve() {
    if (k_.isZero(0.0))
      solve_straight();
    else
      solve_curved();
  }

  // Z^T P - 1, relative to what is summed.
  double imbalance() const {
    const Mat6 z_p = z_.transpose() * resultants_.p;
    return (z_p - Mat6::Identity()).cwiseAbs().maxCoeff();
  }
  double largest_multiplier() const { return largest_multiplier_; }
  int factorisations() const { return factorisations_; }
  int solutions() const { return solutions_; }
  const Eigen::MatrixXd& w() const { return w_; }
  const Mat6& g() const { return g_; }

  // (8)
  Mat6 compliance() const {
    const Mat6 f = w_.transpose() * resultants_.q +
                   (w_ * transport_of(k_)).transpose() * resultants_.p +
                   g_.transpose() * (z_.transpose() * resultants_.p);
    return 0.5 * (f + f.transpose());
  }

 private:
  // Of solutions, at most. One takes errors down by about what it changes, so that after a change of 1e-9 the next would
  // be of round-off.
  static constexpr int most_refinements = 4;
  static constexpr double last_change = 1e-9;

  // Columns whose fields are (v, w', g), and what they make: P' = Q.
  template <class Scalar>
  struct Level {
    MatrixOf<Scalar> v;
    Columns6<Scalar> g;
    Resultants<Scalar> made;
  };

  template <class Scalar>
  Bordered<Scalar> factorise(Scalar lambda) {
    ++factorisations_;
    solutions_ += Bordered<Scalar>::border;
    return Bordered<Scalar>(operators_, fronts_, lambda, z_, h_);
  }

  // By columns, of displacements and of the strains g, which make displacements as large: lengths are over the section's size.
  template <class Scalar>
  static Eigen::ArrayXd sizes(const MatrixOf<Scalar>& v, const Columns6<Scalar>& g) {
    const auto nodes = static_cast<double>(v.rows()) / 3.0;
    return (v.colwise().squaredNorm() / nodes + g.colwise().squaredNorm()).cwiseSqrt().transpose();
  }

  // For the resultants `unit`. `dw_of` and `dp_of` give w' of these columns from their v, and P' from their P.
  template <class Scalar, class DwOf, class DpOf>
  Level<Scalar> solve_level(const Bordered<Scalar>& system, const Columns6<Scalar>& unit,
                            const DwOf& dw_of, const DpOf& dp_of) {
    auto [v, g, mu] = system.solve(unit);
    const MatrixOf<Scalar> h = h_.template cast<Scalar>(), z = z_.template cast<Scalar>();
    bool done = false;
    for (int i = 0;; ++i) {
      stop::check();
      Resultants<Scalar> now = operators_.template act<Scalar>(v, dw_of(v), g);
      if (done || i == most_refinements) {
        const double scale = now.q.cwiseAbs().maxCoeff() + now.p.cwiseAbs().maxCoeff();
        largest_multiplier_ = std::max(largest_multiplier_, (h * mu).cwiseAbs().maxCoeff() / scale);
        return {std::move(v), std::move(g), std::move(now)};
      }
      const auto change = system.solve(dp_of(now.p) - now.q - h * mu, unit - z.transpose() * now.p,
                                       -h.transpose() * v);
      solutions_ += static_cast<int>(v.cols());
      v += change.v;
      g += change.g;
      mu += change.mu;
      done = (sizes(change.v, change.g) <= last_change * sizes(v, g)).all();
    }
  }

  // All at once: forces depend on moments alone, so that they are refined once they have the moments' first solution.
  void solve_straight() {
    const Bordered<double> system = factorise(0.0);
    const auto along = [khat = transport_of(Vec3::Zero())](const Eigen::MatrixXd& x) {
      return Eigen::MatrixXd(x * khat);
    };
    Level<double> level = solve_level<double>(system, Mat6::Identity(), along, along);
    w_ = std::move(level.v);
    g_ = level.g;
    resultants_ = std::move(level.made);
  }

  void solve_curved() {
    const Schur schur = schur_of(k_);
    MatrixOf<Complex> v(operators_.size(), 6), p(operators_.size(), 6), q(operators_.size(), 6);
    Columns6<Complex> g(6, 6);
    const Bordered<double> at_zero = factorise(0.0);
    const Complex lambda = schur.t(1, 1);
    const Bordered<Complex> at_lambda = factorise(lambda);
    const auto column = [&]<class Scalar>(const Bordered<Scalar>& system, Index j) {
      const Scalar own = [&] {
        if constexpr (std::is_same_v<Scalar, double>)
          return 0.0;
        else
          return lambda;
      }();
      const auto as_scalar = [](const MatrixOf<Complex>& m) {
        if constexpr (std::is_same_v<Scalar, double>)
          return MatrixOf<double>(m.real());
        else
          return m;
      };
      MatrixOf<Complex> dv = MatrixOf<Complex>::Zero(operators_.size(), 1), dp = dv;
      for (Index i = 0; i < j; ++i) {
        dv += schur.t(i, j) * v.col(i);
        dp += schur.t(i, j) * p.col(i);
      }
      const MatrixOf<Scalar> others = as_scalar(dv), others_p = as_scalar(dp);
      const Columns6<Scalar> unit = as_scalar(schur.q.col(j));
      const Level<Scalar> level = solve_level<Scalar>(
          system, unit, [&](const MatrixOf<Scalar>& x) { return (own * x + others).eval(); },
          [&](const MatrixOf<Scalar>& x) { return (own * x + others_p).eval(); });
      v.col(j) = level.v.template cast<Complex>();
      g.col(j) = level.g.template cast<Complex>();
      p.col(j) = level.made.p.template cast<Complex>();
      q.col(j) = level.made.q.template cast<Complex>();
    };
    for (const Index first : {0, 3}) {
      column(at_zero, first);
      column(at_lambda, first + 1);
      for (MatrixOf<Complex>* const x : {&v, &p, &q})
        x->col(first + 2) = x->col(first + 1).conjugate();
      g.col(first + 2) = g.col(first + 1).conjugate();
    }
    const MatrixOf<Complex> back = schur.q.adjoint();
    w_ = (v * back).real();
    g_ = (g * back).real();
    resultants_ = {(p * back).real(), (q * back).real()};
  }

  Operators operators_;
  Vec3 k_;
  Eigen::MatrixXd z_, h_;
  std::vector<Front> fronts_;
  Eigen::MatrixXd w_;
  Mat6 g_;
  double largest_multiplier_ = 0.0;
  int factorisations_ = 0, solutions_ = 0;
  Resultants<double> resultants_;
};

}  // namespace

Mat6 transport_of(const Vec3& k) {
  Mat6 result = Mat6::Zero();
  result.topLeftCorner<3, 3>() = result.bottomRightCorner<3, 3>() = -cross(k);
  result.bottomLeftCorner<3, 3>() = -cross(Vec3::UnitX());
  return result;
}

Analysis analyse(const Mesh& mesh, const Vec3& curvature) {
  check(mesh);
  if (!curvature.allFinite()) throw Error("the curvature of a section is not finite");
  for (const Point& x : mesh.nodes) {  // at the surface too, where no point of quadrature lies
    const double metric = 1.0 + curvature(1) * x(1) - curvature(2) * x(0);
    if (!(metric > 1e-9))
      throw Error(
          fmt::format("the curvature is too strong for the section: at x2 = {:g}, x3 = {:g} the "
                      "centre of curvature is reached, 1 + k2 x3 - k3 x2 = {:g} is not positive",
                      x(0), x(1), metric));
  }
  // In units of the section: lengths of its size, stresses of its stiffest material.
  Point low = mesh.nodes.front(), high = low;
  for (const Point& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double size = (high - low).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size)) throw Error("a section without area");
  double modulus = 0.0;
  for (const Element& element :
       mesh.elements) {  // there may be other materials, of which nothing is made
    const MeshMaterial& material = mesh.materials[static_cast<std::size_t>(element.material)];
    modulus = std::max(modulus, material.stiffness.diagonal().maxCoeff());
  }
  Mesh scaled = mesh;
  for (Point& x : scaled.nodes) x /= size;
  for (MeshMaterial& material : scaled.materials) material.stiffness /= modulus;

  CentralSolutions central(scaled, curvature * size, size);
  central.solve();

  // Resultants of 1 in these units: modulus size^2 of forces, modulus size^3 of moments; strains 1 and 1/size.
  Vec6 strain, resultant;
  strain << Vec3::Ones(), Vec3::Constant(1.0 / size);
  resultant << Vec3::Constant(modulus * size * size), Vec3::Constant(modulus * size * size * size);
  const Vec6 inverse = resultant.cwiseInverse();
  Analysis analysis;
  const Mat6 compliance = central.compliance();
  analysis.compliance = strain.asDiagonal() * compliance * inverse.asDiagonal();
  const Mat6 stiffness = compliance.inverse();
  analysis.stiffness = resultant.asDiagonal() * (0.5 * (stiffness + stiffness.transpose())).eval() *
                       strain.cwiseInverse().asDiagonal();
  Vec6 lengths;
  lengths << Vec3::Constant(size), Vec3::Constant(size * size);
  analysis.mass = lengths.asDiagonal() * central.operators().mass() * lengths.asDiagonal();
  analysis.area = central.operators().area() * size * size;
  analysis.warping = size * central.w() * inverse.asDiagonal();
  analysis.gamma = strain.asDiagonal() * central.g() * inverse.asDiagonal();
  analysis.largest_multiplier = central.largest_multiplier();
  analysis.largest_imbalance = central.imbalance();
  analysis.factorisations = central.factorisations();
  analysis.solutions = central.solutions();
  return analysis;
}

}  // namespace mbd::section
