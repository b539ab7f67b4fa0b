// A closed curve through points: straight, or cubic splines between its corners.
//
// Its parameter u is the length of the chords from the first point, counter-clockwise whichever way the points were listed
// (b2 to the right, b3 up). Between corners it is the interpolating cubic spline of u: periodic where there are none, else
// without a knot next to its ends (a parabola through three points, a line through two), so it does not depend on where or
// which way round the list begins. Beyond its ends a piece goes on along its tangent, for plies that meet outside it.
#pragma once

#include <vector>

#include "libmbd/section/mesh.hpp"

namespace mbd::section {

class Contour {
 public:
  // `points` [m]: three or more, the last not the first again. At points where the chords turn by more than `corner_angle`
  // [rad] there are corners; 0 makes straight lines. Throws Error, by the numbers of the points, counted from 1: too few or
  // not finite, two in one place, no area, a corner too sharp for walls with a thickness, or a curve that crosses itself.
  Contour(std::vector<Point> points, double corner_angle);

  struct At {
    Point x;           // [m]
    Point tangent;     // counter-clockwise, of length 1
    Point normal;      // outward, of length 1
    double speed;      // dx/du along the tangent
    double curvature;  // of the curve, positive where its centre lies inside [1/m]
  };
  // Pieces stand between corners; without corners there is one, which is closed.
  struct Piece {
    std::vector<double> u;  // of its points, rising; those beyond the first point are u + period()
    std::vector<Point> x, second;  // points, and second derivatives there
    bool closed = false;
  };

  double period() const { return period_; }  // of u: length of all chords [m]
  bool reversed() const { return reversed_; }
  // Where the curve has run through so much of its length, from the first point on as they were listed, in [0, 1].
  double at_fraction(double fraction) const;
  double at_point(int number) const;   // from 1 on, as they were listed; in [0, period)
  double fraction_at(double u) const;  // what at_fraction() turns into u; for messages
  int points() const { return static_cast<int>(points_.size()); }
  int number_at(std::size_t i) const;  // of the i-th counter-clockwise, as listed

  const std::vector<Piece>& pieces() const { return pieces_; }
  // u of corners, in [0, period), rising; piece i begins at the i-th.
  const std::vector<double>& corners() const { return corners_; }
  // The piece that has u, and u as that piece counts it.
  struct Place {
    int piece;
    double u;
  };
  Place place_of(double u) const;
  At at(int piece, double u) const;
  // What would be left of a ply's interface at that depth [m] below the curve.
  Point inside(int piece, double u, double depth) const;

 private:
  void find_corners(double corner_angle);
  void add_piece(std::size_t first, std::size_t count, bool closed);
  void measure();
  void check_crossings() const;
  std::string name_of(std::size_t i) const;

  std::vector<Point> points_;   // counter-clockwise
  std::vector<double> u_;       // of points, and the period
  std::vector<double> length_;  // of the curve up to points, and all of it
  std::vector<Piece> pieces_;
  std::vector<double> corners_;
  double period_ = 0.0;
  bool reversed_ = false;
};

}  // namespace mbd::section
