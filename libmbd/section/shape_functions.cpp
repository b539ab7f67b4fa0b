#include "libmbd/section/shape_functions.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd::section {
namespace {

Eigen::MatrixX3d grid(int order, double xi, double eta) {
  const std::vector<double> nodes = gauss_lobatto_rule(order + 1).points;
  const VecX a = lagrange(nodes, xi), b = lagrange(nodes, eta);
  const VecX da = lagrange_derivative(nodes, xi), db = lagrange_derivative(nodes, eta);
  const Index n = order + 1;
  Eigen::MatrixX3d s(n * n, 3);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) s.row(i + n * j) << a(i) * b(j), da(i) * b(j), a(i) * db(j);
  return s;
}

Eigen::MatrixX3d serendipity(double x, double y) {
  constexpr std::array<std::array<double, 2>, 4> corners{
      {{{-1, -1}}, {{1, -1}}, {{1, 1}}, {{-1, 1}}}};
  Eigen::MatrixX3d s(8, 3);
  for (Index i = 0; i < 4; ++i) {
    const auto [a, b] = corners[static_cast<std::size_t>(i)];
    s.row(i) << 0.25 * (1 + a * x) * (1 + b * y) * (a * x + b * y - 1),
        0.25 * a * (1 + b * y) * (2 * a * x + b * y), 0.25 * b * (1 + a * x) * (a * x + 2 * b * y);
  }
  const auto along_x = [&](Index i, double b) {
    s.row(i) << 0.5 * (1 - x * x) * (1 + b * y), -x * (1 + b * y), 0.5 * b * (1 - x * x);
  };
  const auto along_y = [&](Index i, double a) {
    s.row(i) << 0.5 * (1 + a * x) * (1 - y * y), 0.5 * a * (1 - y * y), -y * (1 + a * x);
  };
  along_x(4, -1);
  along_y(5, 1);
  along_x(6, 1);
  along_y(7, -1);
  return s;
}

constexpr int most_of_triangle = 8;  // beyond, Bernstein's polynomials are too much alike

int factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

// Bernstein's polynomials of a triangle, all of an order: columns value, d/dx, d/dy.
Eigen::MatrixX3d bernstein(int order, double x, double y) {
  const std::array<double, 3> l{1 - x - y, x, y};
  const auto power = [](double base, int n) { return n < 0 ? 0.0 : std::pow(base, n); };
  Eigen::MatrixX3d s((order + 1) * (order + 2) / 2, 3);
  Index row = 0;
  for (int a = 0; a <= order; ++a)
    for (int b = 0; a + b <= order; ++b) {
      const int c = order - a - b;
      const double n =
          static_cast<double>(factorial(order)) / (factorial(a) * factorial(b) * factorial(c));
      const double la = power(l[0], a), lb = power(l[1], b), lc = power(l[2], c);
      const double da = a * power(l[0], a - 1) * lb * lc, db = la * b * power(l[1], b - 1) * lc,
                   dc = la * lb * c * power(l[2], c - 1);
      s.row(row++) << n * la * lb * lc, n * (db - da), n * (dc - da);
    }
  return s;
}

// Nodes inside as Blyth and Pozrikidis (2006) place them.
Eigen::MatrixX2d triangle_places(int order) {
  std::vector<double> g = gauss_lobatto_rule(order + 1).points;
  for (double& x : g) x = 0.5 * (1.0 + x);
  const auto at = [&g](int i) { return g[static_cast<std::size_t>(i)]; };
  Eigen::MatrixX2d places((order + 1) * (order + 2) / 2, 2);
  const std::array<Eigen::RowVector2d, 3> corners{{{0, 0}, {1, 0}, {0, 1}}};
  Index row = 0;
  for (const Eigen::RowVector2d& corner : corners) places.row(row++) = corner;
  for (std::size_t side = 0; side < 3; ++side)
    for (int k = 1; k < order; ++k)
      places.row(row++) = (1.0 - at(k)) * corners[side] + at(k) * corners[(side + 1) % 3];
  for (int j = 1; j < order; ++j)
    for (int i = 1; i + j < order; ++i) {
      const double a = at(i), b = at(j), c = at(order - i - j);
      places.row(row++) << (1.0 + 2.0 * a - b - c) / 3.0, (1.0 + 2.0 * b - a - c) / 3.0;
    }
  return places;
}

Eigen::MatrixX3d high_triangle(int order, double x, double y) {
  // From Bernstein's to those that are 1 at one node.
  static const auto to_nodes = [] {
    std::array<Eigen::MatrixXd, most_of_triangle + 1> all;
    for (int p = 3; p <= most_of_triangle; ++p) {
      const Eigen::MatrixX2d places = triangle_places(p);
      Eigen::MatrixXd values(places.rows(), places.rows());  // (polynomial, node)
      for (Index i = 0; i < places.rows(); ++i)
        values.col(i) = bernstein(p, places(i, 0), places(i, 1)).col(0);
      all[static_cast<std::size_t>(p)] = values.inverse();
    }
    return all;
  }();
  return to_nodes[static_cast<std::size_t>(order)] * bernstein(order, x, y);
}

// On the triangle (0, 0), (1, 0), (0, 1).
Eigen::MatrixX3d triangle(int order, double x, double y) {
  if (order > 2) return high_triangle(order, x, y);
  const std::array<double, 3> l{1 - x - y, x, y}, dx{-1, 1, 0}, dy{-1, 0, 1};
  Eigen::MatrixX3d s(order == 1 ? 3 : 6, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Index>(i);
    if (order == 1) {
      s.row(row) << l[i], dx[i], dy[i];
      continue;
    }
    const std::size_t j = (i + 1) % 3;
    s.row(row) << l[i] * (2 * l[i] - 1), dx[i] * (4 * l[i] - 1), dy[i] * (4 * l[i] - 1);
    s.row(row + 3) << 4 * l[i] * l[j], 4 * (dx[i] * l[j] + l[i] * dx[j]),
        4 * (dy[i] * l[j] + l[i] * dy[j]);
  }
  return s;
}

struct Place {
  double xi, eta, weight;
};

std::vector<Place> rule_of(Shape shape, int order) {
  std::vector<Place> places;
  if (shape != Shape::triangle) {
    const Quadrature gauss = gauss_rule(order + 1);
    for (std::size_t j = 0; j < gauss.points.size(); ++j)
      for (std::size_t i = 0; i < gauss.points.size(); ++i)
        places.push_back({gauss.points[i], gauss.points[j], gauss.weights[i] * gauss.weights[j]});
  } else if (order == 1) {
    const double a = 1.0 / 6.0, b = 2.0 / 3.0;
    places = {{a, a, a}, {b, a, a}, {a, b, a}};
  } else if (order > 2) {  // a square, one side of it drawn together
    const Quadrature gauss = gauss_rule(order + 1);
    for (std::size_t i = 0; i < gauss.points.size(); ++i)
      for (std::size_t j = 0; j < gauss.points.size(); ++j) {
        const double u = 0.5 * (1.0 + gauss.points[i]), v = 0.5 * (1.0 + gauss.points[j]);
        places.push_back(
            {u, v * (1.0 - u), 0.25 * gauss.weights[i] * gauss.weights[j] * (1.0 - u)});
      }
  } else {  // Radon's seven points, of degree 5
    const double root = std::sqrt(15.0);
    const double a = (6.0 - root) / 21.0, b = (6.0 + root) / 21.0;
    const double wa = (155.0 - root) / 2400.0, wb = (155.0 + root) / 2400.0;
    places = {{1.0 / 3.0, 1.0 / 3.0, 9.0 / 80.0}};
    for (const auto& [p, w] : {std::pair{a, wa}, std::pair{b, wb}}) {
      places.push_back({p, p, w});
      places.push_back({1 - 2 * p, p, w});
      places.push_back({p, 1 - 2 * p, w});
    }
  }
  return places;
}

}  // namespace

int nodes_of(Shape shape, int order) {
  const bool is_there = shape == Shape::grid          ? order >= 1 && order <= 16
                        : shape == Shape::serendipity ? order == 2
                                                      : order >= 1 && order <= most_of_triangle;
  if (!is_there)
    throw Error(fmt::format("there is no {} of order {}",
                            shape == Shape::triangle ? "triangle" : "quadrilateral", order));
  if (shape == Shape::grid) return (order + 1) * (order + 1);
  return shape == Shape::serendipity ? 8 : (order + 1) * (order + 2) / 2;
}

Eigen::MatrixX2d node_places(Shape shape, int order) {
  Eigen::MatrixX2d places(nodes_of(shape, order), 2);
  switch (shape) {
    case Shape::grid: {
      const std::vector<double> nodes = gauss_lobatto_rule(order + 1).points;
      for (Index i = 0; i < places.rows(); ++i)
        places.row(i) << nodes[static_cast<std::size_t>(i % (order + 1))],
            nodes[static_cast<std::size_t>(i / (order + 1))];
      break;
    }
    case Shape::serendipity:
      places << -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0;
      break;
    case Shape::triangle:
      return triangle_places(order);
  }
  return places;
}

Eigen::MatrixX3d shape_functions(Shape shape, int order, double xi, double eta) {
  nodes_of(shape, order);
  switch (shape) {
    case Shape::grid:
      return grid(order, xi, eta);
    case Shape::serendipity:
      return serendipity(xi, eta);
    case Shape::triangle:
      break;
  }
  return triangle(order, xi, eta);
}

const ShapeTable& ShapeTables::of(Shape shape, int order) {
  for (const Entry& entry : entries_)
    if (entry.shape == shape && entry.order == order) return entry.table;
  ShapeTable table;
  table.nodes = nodes_of(shape, order);
  const std::vector<Place> places = rule_of(shape, order);
  const auto points = static_cast<Index>(places.size());
  table.n.resize(points, table.nodes);
  table.d1.resize(points, table.nodes);
  table.d2.resize(points, table.nodes);
  for (Index i = 0; i < points; ++i) {
    const Place& place = places[static_cast<std::size_t>(i)];
    const Eigen::MatrixX3d s = shape_functions(shape, order, place.xi, place.eta);
    table.n.row(i) = s.col(0).transpose();
    table.d1.row(i) = s.col(1).transpose();
    table.d2.row(i) = s.col(2).transpose();
    table.weights.push_back(place.weight);
  }
  entries_.push_back({shape, order, std::move(table)});
  return entries_.back().table;
}

}  // namespace mbd::section
