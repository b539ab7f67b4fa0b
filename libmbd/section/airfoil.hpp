// Aerofoils and other sections of walls along a closed curve, with webs between them.
//
// Walls lie inside the contour, sector by sector; interfaces of plies are curves at a constant distance from it. Let X(u) be
// the contour, n its outward normal, kappa its curvature. The interface at the depth d below the contour is
//   (1)  x(u, d) = X(u) - d n(u),   dx/du = X'(u) (1 - kappa d),
// so the walls exist where kappa d < 1: thinner than the contour's radius. At a corner between the curves 1 and 2 the
// interfaces d1 and d2 meet where
//   (2)  x1(u1, d1) = x2(u2, d2),
// solved by Newton's method: mitred corners have d1 = d2 on their line; in butt ones the wall of the sector that is
// listed first (of one sector, the wall before the corner as points are listed) goes through to d2 = 0, and the other one
// stands on d1 = its thickness. Curves go on along their
// tangents beyond corners, which (2) needs of those that point inward; these are always mitred.
//
// A web is straight, between two places of the contour; its plies lie about that line, their normal n to the right of
// who goes from its first end to its second (b2 to the right, b3 up). Its foot is where its interfaces meet the inner
// surface of the wall; the wall has a line of elements there from each, so all meet by nodes.
//
// Lines of elements run through all walls at the depths of all plies of all sectors. Where walls end, plies change, at
// corners and feet, meshes are finer (cells.hpp). Elements end at points of the contour whose jump in the third
// derivative matters at that fineness, else where size, turn and slenderness ask for it.
#pragma once

#include <optional>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/section/shapes.hpp"

namespace mbd::section {

// On the contour: the point of that number, from 1 on, or a fraction of its length from the first point on as listed.
struct ContourPlace {
  std::optional<int> point;
  double fraction = 0.0;
};

struct AirfoilSector {
  Source source;
  ContourPlace from,
      to;  // as points are listed; from 0 to 1, all of it; else through the first point where to <= from
  bool bare = false;  // without wall
  Layup layup;        // unless bare, from the inside
};
struct AirfoilWeb {
  Source source;
  ContourPlace from, to;
  Layup layup;  // towards its normal
};
struct Airfoil {
  std::vector<Point> points;  // of the outer surface, all round, either way [m]
  double corner_angle = 0.0;  // [rad], see Contour
  Corners corners = Corners::mitred;
  std::vector<AirfoilSector> sectors;
  std::vector<AirfoilWeb> webs;
};

// What is wrong with a sector or web, and where that was stated.
class PartError : public Error {
 public:
  PartError(Source where, const std::string& what) : Error(what), source(std::move(where)) {}
  Source source;
};

// Throws PartError, or Error of what is of all: contours as Contour does; sectors that overlap, leave a hole, or are
// joined to nothing; places that are not on the contour; plies that are thicker than the contour's radius or than what
// is between two corners; webs that end where there is no wall, on a corner, or on another's foot, that are too steep or
// cross others; surfaces that cross.
Mesher airfoil(const Airfoil& stated, const std::vector<MeshMaterial>& materials);

}  // namespace mbd::section
