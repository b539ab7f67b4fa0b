#include "libmbd/section/contour.hpp"

#include <fmt/format.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/section/crossing.hpp"

namespace mbd::section {
namespace {

constexpr double sharpest = 175.0 / 180.0 * std::numbers::pi;  // turn at a corner

// Second derivatives at the points of a spline, from the continuity of its first ones.
std::vector<Point> second_derivatives(const std::vector<double>& u, const std::vector<Point>& x,
                                      bool closed) {
  const std::size_t n = u.size();
  if (n < 3) return std::vector<Point>(n, Point::Zero());
  const auto h = [&](std::size_t i) { return u[i + 1] - u[i]; };
  const auto slope = [&](std::size_t i) -> Point { return (x[i + 1] - x[i]) / h(i); };
  if (n == 3 && !closed) return std::vector<Point>(3, 2.0 * (slope(1) - slope(0)) / (u[2] - u[0]));
  // A closed one has its first point again at its end.
  const auto size = static_cast<int>(closed ? n - 1 : n);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(size, 2);
  const auto row = [&](int i, std::size_t before, std::size_t after) {
    const double a = h(before), b = h(after);
    entries.emplace_back(i, (i + size - 1) % size, a);
    entries.emplace_back(i, i, 2.0 * (a + b));
    entries.emplace_back(i, (i + 1) % size, b);
    right.row(i) = 6.0 * (slope(after) - slope(before)).transpose();
  };
  for (int i = closed ? 0 : 1; i < (closed ? size : size - 1); ++i)
    row(i, i == 0 ? n - 2 : static_cast<std::size_t>(i - 1), static_cast<std::size_t>(i));
  if (!closed)
    for (const int end : {0, size - 1}) {  // no knot next to it: one cubic over two intervals
      const int next = end == 0 ? 1 : size - 2, beyond = end == 0 ? 2 : size - 3;
      const double a = h(end == 0 ? 0 : n - 2), b = h(end == 0 ? 1 : n - 3);
      entries.emplace_back(end, end, b);
      entries.emplace_back(end, next, -(a + b));
      entries.emplace_back(end, beyond, a);
    }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(matrix);
  const Eigen::MatrixX2d found = lu.solve(right);
  std::vector<Point> second;
  for (std::size_t i = 0; i < n; ++i)
    second.emplace_back(found.row(static_cast<Index>(i) % size).transpose());
  return second;
}

}  // namespace

Contour::Contour(std::vector<Point> points, double corner_angle) : points_(std::move(points)) {
  const std::size_t n = points_.size();
  if (n < 3) throw Error(fmt::format("its contour has {} points, must have three or more", n));
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!points_[i].allFinite()) throw Error(fmt::format("point {} is not finite", i + 1));
    area += 0.5 * cross(points_[i], points_[(i + 1) % n]);
  }
  reversed_ = area < 0.0;
  if (reversed_) std::reverse(points_.begin() + 1, points_.end());
  u_ = {0.0};
  for (std::size_t i = 0; i < n; ++i)
    u_.push_back(u_.back() + (points_[(i + 1) % n] - points_[i]).norm());
  period_ = u_.back();
  for (std::size_t i = 0; i < n; ++i)
    if (!(u_[i + 1] - u_[i] > 1e-9 * period_)) {
      const auto [a, b] = std::minmax({number_at(i), number_at((i + 1) % n)});
      throw Error(
          fmt::format("points {} and {} are in one place, near x2 = {:g}, x3 = {:g}; leave "
                      "one of them out (the contour closes by itself)",
                      a, b, points_[i](0), points_[i](1)));
    }
  if (!(std::abs(area) > 1e-9 * period_ * period_))
    throw Error("its contour has no area; list the points of the outer surface all round");
  find_corners(corner_angle);
  measure();
  check_crossings();
}

int Contour::number_at(std::size_t i) const {
  const std::size_t n = points_.size();
  return 1 + static_cast<int>(reversed_ ? (n - i % n) % n : i % n);
}

std::string Contour::name_of(std::size_t i) const {
  const std::size_t n = points_.size();
  const int a = number_at(i), b = number_at((i + 1) % n);
  return fmt::format("{} and {}", reversed_ ? b : a, reversed_ ? a : b);
}

void Contour::find_corners(double corner_angle) {
  const std::size_t n = points_.size();
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < n; ++i) {
    const Point before = points_[i] - points_[(i + n - 1) % n],
                after = points_[(i + 1) % n] - points_[i];
    const double turn = std::abs(std::atan2(cross(before, after), before.dot(after)));
    if (turn > sharpest)
      throw Error(
          fmt::format("the contour turns by {:.4g} deg at point {}, x2 = {:g}, x3 = {:g}: "
                      "too sharp for walls with a thickness (175 deg at most); make the "
                      "edge blunt",
                      turn * 180.0 / std::numbers::pi, number_at(i), points_[i](0), points_[i](1)));
    if (turn > std::max(corner_angle, 1e-9)) found.push_back(i);
  }
  for (const std::size_t i : found) corners_.push_back(u_[i]);
  if (found.empty()) add_piece(0, n, true);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::size_t next = k + 1 < found.size() ? found[k + 1] : found[0] + n;
    add_piece(found[k], next - found[k], false);
  }
}

// From point `first` over `count` chords.
void Contour::add_piece(std::size_t first, std::size_t count, bool closed) {
  const std::size_t n = points_.size();
  Piece piece;
  piece.closed = closed;
  for (std::size_t i = first; i <= first + count; ++i) {
    piece.u.push_back(i < n ? u_[i] : u_[i - n] + period_);
    piece.x.push_back(points_[i % n]);
  }
  piece.second = second_derivatives(piece.u, piece.x, closed);
  pieces_.push_back(std::move(piece));
}

Contour::Place Contour::place_of(double u) const {
  u -= period_ * std::floor(u / period_);
  if (corners_.empty()) return {0, u};
  const auto after = std::ranges::upper_bound(corners_, u);
  if (after == corners_.begin()) return {static_cast<int>(corners_.size()) - 1, u + period_};
  return {static_cast<int>(after - corners_.begin()) - 1, u};
}

Contour::At Contour::at(int piece, double u) const {
  const Piece& p = pieces_[static_cast<std::size_t>(piece)];
  if (p.closed) u -= period_ * std::floor(u / period_);
  const double here = std::clamp(u, p.u.front(), p.u.back());
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(p.u, here) - p.u.begin() - 1, 0,
                                 static_cast<std::ptrdiff_t>(p.u.size()) - 2));
  const double h = p.u[i + 1] - p.u[i], b = (here - p.u[i]) / h, a = 1.0 - b;
  Point x = a * p.x[i] + b * p.x[i + 1] +
            h * h / 6.0 * ((a * a - 1.0) * a * p.second[i] + (b * b - 1.0) * b * p.second[i + 1]);
  const Point first =
      (p.x[i + 1] - p.x[i]) / h +
      h / 6.0 * ((3.0 * b * b - 1.0) * p.second[i + 1] - (3.0 * a * a - 1.0) * p.second[i]);
  At result;
  result.speed = first.norm();
  result.tangent = first / result.speed;
  result.normal = Point(result.tangent(1), -result.tangent(0));
  result.x = x + (u - here) * first;
  const Point second = a * p.second[i] + b * p.second[i + 1];
  result.curvature = u == here ? cross(first, second) / std::pow(result.speed, 3) : 0.0;
  return result;
}

Point Contour::inside(int piece, double u, double depth) const {
  const At here = at(piece, u);
  return here.x - depth * here.normal;
}

// Length of the curve from u of a piece on to v, in one interval between points.
namespace {
double length_of(const Contour& contour, int piece, double u, double v) {
  static const auto rule = gauss_rule(8);
  double sum = 0.0;
  for (std::size_t k = 0; k < rule.points.size(); ++k) {
    const double at = 0.5 * ((1.0 - rule.points[k]) * u + (1.0 + rule.points[k]) * v);
    sum += 0.5 * (v - u) * rule.weights[k] * contour.at(piece, at).speed;
  }
  return sum;
}
}  // namespace

void Contour::measure() {
  length_ = {0.0};
  for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
    const Place place = place_of(0.5 * (u_[i] + u_[i + 1]));
    const double half = 0.5 * (u_[i + 1] - u_[i]);
    length_.push_back(length_.back() +
                      length_of(*this, place.piece, place.u - half, place.u + half));
  }
}

double Contour::at_fraction(double fraction) const {
  const double part = reversed_ ? 1.0 - fraction : fraction, goal = part * length_.back();
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(length_, goal) - length_.begin() - 1, 0,
                                 static_cast<std::ptrdiff_t>(u_.size()) - 2));
  const double middle = 0.5 * (u_[i] + u_[i + 1]), h = u_[i + 1] - u_[i];
  const Place place = place_of(middle);
  const double begin = place.u - 0.5 * h;
  double u = begin + h * (goal - length_[i]) / (length_[i + 1] - length_[i]);
  for (int k = 0; k < 20; ++k) {
    const double off = length_[i] + length_of(*this, place.piece, begin, u) - goal;
    u = std::clamp(u - off / at(place.piece, u).speed, begin, begin + h);
    if (std::abs(off) < 1e-14 * length_.back()) break;
  }
  return u_[i] + (u - begin);
}

double Contour::at_point(int number) const {
  const auto n = static_cast<int>(points_.size());
  return u_[static_cast<std::size_t>(reversed_ ? (n + 1 - number) % n : number - 1)];
}

double Contour::fraction_at(double u) const {
  u -= period_ * std::floor(u / period_);
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(u_, u) - u_.begin() - 1, 0,
                                 static_cast<std::ptrdiff_t>(u_.size()) - 2));
  const Place place = place_of(0.5 * (u_[i] + u_[i + 1]));
  const double begin = place.u - 0.5 * (u_[i + 1] - u_[i]);
  const double part =
      (length_[i] + length_of(*this, place.piece, begin, begin + u - u_[i])) / length_.back();
  return reversed_ ? 1.0 - part : part;
}

void Contour::check_crossings() const {
  constexpr int parts = 4;  // of a curved interval
  std::vector<Chord> chords;
  for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
    const double h = u_[i + 1] - u_[i];
    const Place place = place_of(0.5 * (u_[i] + u_[i + 1]));
    for (int k = 0; k < parts; ++k) {
      const double from = place.u + h * (static_cast<double>(k) / parts - 0.5);
      chords.push_back(
          {at(place.piece, from).x, at(place.piece, from + h / parts).x, static_cast<int>(i)});
    }
  }
  // Neighbours in the list have an end in common.
  const auto neighbours = [&](std::size_t a, std::size_t b) {
    return b - a == 1 || (a == 0 && b + 1 == chords.size());
  };
  if (const auto found = first_crossing(chords, neighbours)) {
    const Chord &a = chords[found->first], &b = chords[found->second];
    const Point x = 0.25 * (a.from + a.to + b.from + b.to);
    throw Error(
        fmt::format("its contour crosses itself between points {} and points {}, near x2 = "
                    "{:g}, x3 = {:g}; list the points in their order around",
                    name_of(static_cast<std::size_t>(a.of)),
                    name_of(static_cast<std::size_t>(b.of)), x(0), x(1)));
  }
}

}  // namespace mbd::section
