#include "libmbd/section/stress.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/section/shape_functions.hpp"

namespace mbd::section {
namespace {

std::string name_of(const Mesh& mesh, int e) {
  const Element& element = mesh.elements[static_cast<std::size_t>(e)];
  return element.name.empty() ? fmt::format("element {}", e + 1) : element.name;
}

double normal_at(const Element& element, const Eigen::MatrixX3d& shapes) {
  if (element.normals.size() == 1) return element.normals.front();
  double normal = 0.0;
  for (std::size_t a = 0; a < element.normals.size(); ++a)
    normal += shapes(static_cast<Index>(a), 0) * element.normals[a];
  return normal;
}

// How far a place lies outside its element, in its own coordinates.
double outside(Shape shape, const ElementPoint& p) {
  if (shape == Shape::triangle) return std::max({-p.xi, -p.eta, p.xi + p.eta - 1.0, 0.0});
  return std::max({std::abs(p.xi) - 1.0, std::abs(p.eta) - 1.0, 0.0});
}

}  // namespace

StressField::StressField(Mesh mesh, const Vec3& curvature, const Analysis& analysis)
    : mesh_(std::move(mesh)), k_(curvature), w_(analysis.warping), g_(analysis.gamma) {
  dw_ = w_ * transport_of(k_);
  ShapeTables tables;
  for (const Element& element : mesh_.elements) {
    if (std::ranges::any_of(kinds_, [&](const Kind& kind) {
          return kind.shape == element.shape && kind.order == element.order;
        }))
      continue;
    Kind& kind = kinds_.emplace_back();
    kind.shape = element.shape;
    kind.order = element.order;
    const Eigen::MatrixX2d places = node_places(kind.shape, kind.order);
    for (Index i = 0; i < places.rows(); ++i)
      kind.nodes.push_back(shape_functions(kind.shape, kind.order, places(i, 0), places(i, 1)));
    const ShapeTable& table = tables.of(kind.shape, kind.order);
    kind.weights = table.weights;
    for (Index i = 0; i < table.n.rows(); ++i) {
      Eigen::MatrixX3d& shapes = kind.points.emplace_back(table.nodes, 3);
      shapes << table.n.row(i).transpose(), table.d1.row(i).transpose(),
          table.d2.row(i).transpose();
    }
  }
}

const StressField::Kind& StressField::kind_of(const Element& element) const {
  return *std::ranges::find_if(kinds_, [&](const Kind& kind) {
    return kind.shape == element.shape && kind.order == element.order;
  });
}

StressField::Gathered StressField::gather(const Element& element) const {
  const auto nodes = static_cast<Index>(element.nodes.size());
  Gathered of{Eigen::MatrixX2d(nodes, 2), Eigen::MatrixXd(nodes, 18), Eigen::MatrixXd(nodes, 18)};
  for (Index a = 0; a < nodes; ++a) {
    const int node = element.nodes[static_cast<std::size_t>(a)];
    of.x.row(a) = mesh_.nodes[static_cast<std::size_t>(node)].transpose();
    for (Index c = 0; c < 6; ++c) {
      of.w.block<1, 3>(a, 3 * c) = w_.block<3, 1>(3 * node, c).transpose();
      of.dw.block<1, 3>(a, 3 * c) = dw_.block<3, 1>(3 * node, c).transpose();
    }
  }
  return of;
}

// The strains of (4) in NOTATION.md 8, turned to the axes of the ply.
Influence StressField::influence(const Element& element, const Gathered& of,
                                 const Eigen::MatrixX3d& shapes, double* determinant) const {
  const Eigen::Vector2d x = of.x.transpose() * shapes.col(0);
  const Eigen::Matrix2d jacobian = shapes.rightCols<2>().transpose() * of.x;
  const Eigen::MatrixX2d d = shapes.rightCols<2>() * jacobian.inverse().transpose();
  if (determinant != nullptr) *determinant = jacobian.determinant();
  const Eigen::RowVectorXd u = shapes.col(0).transpose() * of.w, u2 = d.col(0).transpose() * of.w,
                           u3 = d.col(1).transpose() * of.w, ds = shapes.col(0).transpose() * of.dw;
  const double metric = 1.0 + k_(1) * x(1) - k_(2) * x(0);
  const Vec3 arm(0.0, x(0), x(1));
  Mat6 strain;
  for (Index c = 0; c < 6; ++c) {
    const Vec3 here = u.segment<3>(3 * c).transpose(), along2 = u2.segment<3>(3 * c).transpose(),
               along3 = u3.segment<3>(3 * c).transpose();
    const Vec3 along1 = (ds.segment<3>(3 * c).transpose() + k_.cross(here) +
                         k_(0) * (x(1) * along2 - x(0) * along3) + g_.block<3, 1>(0, c) +
                         Vec3(g_.block<3, 1>(3, c)).cross(arm)) /
                        metric;
    strain.col(c) << along1(0), along2(1), along3(2), along2(2) + along3(1), along1(2) + along3(0),
        along1(1) + along2(0);
  }
  Influence result;
  result.axes = ply_axes(element.angle, normal_at(element, shapes));
  result.strain = strain_turned(result.axes) * strain;
  result.stress =
      mesh_.materials[static_cast<std::size_t>(element.material)].stiffness * result.strain;
  return result;
}

Influence StressField::at(const ElementPoint& p) const {
  const Element& element = mesh_.elements[static_cast<std::size_t>(p.element)];
  return influence(element, gather(element),
                   shape_functions(element.shape, element.order, p.xi, p.eta));
}

Eigen::Matrix<double, 3, 6> StressField::warping(const ElementPoint& p) const {
  const Element& element = mesh_.elements[static_cast<std::size_t>(p.element)];
  const Eigen::MatrixX3d shapes = shape_functions(element.shape, element.order, p.xi, p.eta);
  Eigen::Matrix<double, 3, 6> u = Eigen::Matrix<double, 3, 6>::Zero();
  for (std::size_t a = 0; a < element.nodes.size(); ++a)
    u += shapes(static_cast<Index>(a), 0) * w_.middleRows<3>(3 * element.nodes[a]);
  return u;
}

Point StressField::position(const ElementPoint& p) const {
  const Element& element = mesh_.elements[static_cast<std::size_t>(p.element)];
  const Eigen::MatrixX3d shapes = shape_functions(element.shape, element.order, p.xi, p.eta);
  Point x = Point::Zero();
  for (std::size_t a = 0; a < element.nodes.size(); ++a)
    x += shapes(static_cast<Index>(a), 0) * mesh_.nodes[static_cast<std::size_t>(element.nodes[a])];
  return x;
}

void StressField::each_node(const Visit& f) const {
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const Element& element = mesh_.elements[e];
    const Kind& kind = kind_of(element);
    const Gathered of = gather(element);
    for (std::size_t i = 0; i < kind.nodes.size(); ++i)
      f(static_cast<int>(e), mesh_.nodes[static_cast<std::size_t>(element.nodes[i])],
        influence(element, of, kind.nodes[i]));
  }
}

void StressField::each_integration_point(const VisitArea& f) const {
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const Element& element = mesh_.elements[e];
    const Kind& kind = kind_of(element);
    const Gathered of = gather(element);
    for (std::size_t i = 0; i < kind.points.size(); ++i) {
      double determinant = 0.0;
      const Influence here = influence(element, of, kind.points[i], &determinant);
      f(static_cast<int>(e), Point(of.x.transpose() * kind.points[i].col(0)), here,
        determinant * kind.weights[i]);
    }
  }
}

// Newton's iterations on the element's own coordinates.
std::optional<ElementPoint> StressField::locate(int e, const Point& point, double beyond) const {
  const Element& element = mesh_.elements[static_cast<std::size_t>(e)];
  const auto nodes = static_cast<Index>(element.nodes.size());
  Eigen::MatrixX2d x(nodes, 2);
  for (Index a = 0; a < nodes; ++a)
    x.row(a) = mesh_.nodes[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(a)])]
                   .transpose();
  // Sides of order p may bulge beyond their nodes.
  const Eigen::RowVector2d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
  const double room = (0.2 + beyond) * (high - low).maxCoeff();
  for (Index i = 0; i < 2; ++i)
    if (point(i) < low(i) - room || point(i) > high(i) + room) return std::nullopt;
  const bool triangle = element.shape == Shape::triangle;
  ElementPoint p{e, triangle ? 1.0 / 3.0 : 0.0, triangle ? 1.0 / 3.0 : 0.0};
  for (int i = 0; i < 30; ++i) {
    const Eigen::MatrixX3d shapes = shape_functions(element.shape, element.order, p.xi, p.eta);
    const Eigen::Vector2d off = Eigen::Vector2d(point) - x.transpose() * shapes.col(0);
    const Eigen::Matrix2d jacobian = x.transpose() * shapes.rightCols<2>();
    const Eigen::Vector2d step = jacobian.inverse() * off;
    if (!step.allFinite()) return std::nullopt;
    p.xi = std::clamp(p.xi + step(0), -1.5, 1.5);
    p.eta = std::clamp(p.eta + step(1), -1.5, 1.5);
    if (step.cwiseAbs().maxCoeff() < 1e-13) break;
    if (i == 29 && step.cwiseAbs().maxCoeff() > 1e-9) return std::nullopt;
  }
  if (outside(element.shape, p) > beyond) return std::nullopt;
  return p;
}

std::vector<ElementPoint> StressField::find(const Point& point) const {
  std::vector<ElementPoint> found;
  for (const double beyond : {1e-7, 1e-3}) {
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
      if (const auto place = locate(static_cast<int>(e), point, beyond)) found.push_back(*place);
    if (!found.empty()) break;
  }
  return found;
}

StressField::At StressField::recover(const Point& point) const {
  const std::vector<ElementPoint> all = find(point);
  if (all.empty()) {
    const Point& nearest = *std::ranges::min_element(
        mesh_.nodes, {}, [&](const Point& x) { return (x - point).squaredNorm(); });
    throw Error(
        fmt::format("x2 = {:g}, x3 = {:g} lies outside the section; the nearest of its "
                    "nodes is at x2 = {:g}, x3 = {:g}",
                    point(0), point(1), nearest(0), nearest(1)));
  }
  At result{at(all.front()), all.front().element};
  const auto material = [&](const ElementPoint& p) {
    return mesh_.elements[static_cast<std::size_t>(p.element)].material;
  };
  for (std::size_t i = 1; i < all.size(); ++i) {
    const Influence here = at(all[i]);
    if (material(all[i]) != material(all.front()) ||
        (here.axes - result.influence.axes).cwiseAbs().maxCoeff() > 1e-6)
      throw Error(fmt::format(
          "x2 = {:g}, x3 = {:g} lies where {} and {} meet, between which "
          "stresses jump; move it into one of them",
          point(0), point(1), name_of(mesh_, all.front().element), name_of(mesh_, all[i].element)));
    result.influence.strain += here.strain;
    result.influence.stress += here.stress;
  }
  const double share = 1.0 / static_cast<double>(all.size());
  result.influence.strain *= share;
  result.influence.stress *= share;
  return result;
}

}  // namespace mbd::section
