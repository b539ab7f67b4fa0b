// The reference line of a beam: its length, and the section frame at a fraction of the length.
//
// Straight lines and arcs are what they say. A curve is the interpolating B-spline of degree p through its
// points, x(u), with the vectors n(u) of the normals and the twist theta(u) interpolated by the same spline:
//   s(u) = int |x'| du,   b1 = x'/|x'|,   b3 = exp(theta b1~) (n - b1 b1.n)/|n - b1 b1.n|,   b2 = b3 x b1.   (1)
// Knots are means of p neighbouring parameters of the points. These are first the chord lengths, which
// resolves a curve to the fourth order only if the points are unevenly spaced; so the arc lengths of the
// spline take their place, and the spline is made again, (p - 1)/2 times: then its error is of order p + 1,
// and b1 is smooth in s to the same order.
//
// s(u) is integrated by Gauss's rule on panels halved until it is resolved to round-off, and inverted by
// Newton's iteration. Beams take their nodes at equal fractions of s, as on straight lines and arcs, so
// that ds/dxi is constant in an element.
//
// p = 2 N + 1 by default: the error of the line, h^(2N+2), stays below that of the elements, h^(2N).
// Not used: curvature and twist of the spline in the place of those of the element's own interpolation
// (K0, beam_motion.hpp): the reference would not be free of stress to round-off.
#pragma once

#include <functional>

#include "libmbd/core/se3.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// Two parameters of a beam closer than this are one.
inline constexpr double same_parameter = 1e-9;

struct ReferenceLine {
  double length = 0.0;                     // [m]
  std::function<Pose<double>(double)> at;  // section frame at a fraction of the length, 0 … 1
};

// Throws Error, naming the beam and the point or place, for a line without length, coincident points, a
// normal along the line, a curve whose direction is not defined.
ReferenceLine make_reference_line(const BeamScene& beam);

// The same rotation R (columns: the axes in inertial ones) and position as a Pose.
Pose<double> make_pose(const Mat3& R, const Vec3& r);

}  // namespace mbd
