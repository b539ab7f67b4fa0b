#include "libmbd/scene/reference_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "libmbd/core/spectral.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/spline.hpp"

namespace mbd {
namespace {

std::string in_words(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x(0), x(1), x(2)); }

// Axes b1 b2 b3 from the tangent and a normal; false if the normal is along the tangent or zero.
bool section_axes(const Vec3& tangent, const Vec3& normal, Mat3& R) {
  const Vec3 b3 = normal - normal.dot(tangent) * tangent;
  if (!(b3.norm() > 1e-9 * normal.norm()) || !(normal.norm() > 0.0)) return false;
  R << tangent, b3.normalized().cross(tangent), b3.normalized();
  return true;
}

Mat3 axes_at_start(const BeamScene& beam, const Vec3& tangent) {
  Mat3 R;
  if (!section_axes(tangent, beam.normal, R))
    throw Error(beam.source,
                fmt::format("{}: the normal {} is along the beam or zero; give a direction "
                            "across it",
                            label(beam), in_words(beam.normal)));
  return R;
}

ReferenceLine straight_line(const BeamScene& beam, const Straight& line) {
  const Vec3 chord = line.to - line.from;
  const double length = chord.norm();
  if (!(length > 0.0))
    throw Error(beam.source,
                fmt::format("{}: it has no length: from and to are the same point; give two points",
                            label(beam)));
  const Mat3 R = axes_at_start(beam, chord / length);
  return {length,
          [R, chord, from = line.from](double s) { return make_pose(R, from + s * chord); }};
}

ReferenceLine arc_line(const BeamScene& beam, const Arc& arc) {
  const double size = arc.axis.norm();
  if (!(size > 0.0))
    throw Error(beam.source,
                fmt::format("{}: the axis has zero length; give a direction", label(beam)));
  const Vec3 axis = arc.axis / size, radius = arc.from - arc.center;
  if (!(radius.norm() > 0.0))
    throw Error(beam.source,
                fmt::format("{}: `from` is its center; it has no radius", label(beam)));
  if (std::abs(radius.dot(axis)) > 1e-9 * radius.norm())
    throw Error(beam.source,
                fmt::format("{}: the axis must be perpendicular to from - center", label(beam)));
  if (!(arc.angle > 0.0))
    throw Error(
        beam.source,
        fmt::format("{}: the angle must be positive; turn the axis round to go the other way",
                    label(beam)));
  const Mat3 R = axes_at_start(beam, axis.cross(radius).normalized());
  return {radius.norm() * arc.angle,
          [R, axis, radius, center = arc.center, angle = arc.angle](double s) {
            const Mat3 turn =
                Eigen::AngleAxisd(s * angle, Eigen::Vector3d(axis)).toRotationMatrix();
            return make_pose(turn * R, center + turn * radius);
          }};
}

// --- curves ---

// For messages.
struct Who {
  Source source;
  std::string item;
  Vec3 origin;  // of the spline's coordinates
};

// A spline of [x; n; theta] together with its arc length.
class ArcLength {
 public:
  // `who` is for messages; `size` the length of the chords, the speed of a good parameter in [0, 1].
  ArcLength(Who who, Spline spline, double size)
      : who_(std::move(who)), spline_(std::move(spline)), size_(size) {
    const std::vector<double>& knots = spline_.breaks();
    panels_.push_back({0.0, 0.0});
    for (std::size_t i = 0; i + 1 < knots.size(); ++i)
      add(knots[i], knots[i + 1], integral(knots[i], knots[i + 1]), 0);
  }

  double length() const { return panels_.back().s; }

  // s at a parameter of the spline.
  double operator()(double u) const {
    const auto panel = std::upper_bound(panels_.begin(), panels_.end() - 1, u,
                                        [](double x, const Panel& p) { return x < p.u; });
    const Panel& start = *(panel - 1);
    return start.s + integral(start.u, u);
  }

  // The parameter at which the length is s.
  double parameter_at(double s) const {
    const auto end = std::upper_bound(panels_.begin() + 1, panels_.end() - 1, s,
                                      [](double x, const Panel& p) { return x < p.s; });
    const Panel &a = *(end - 1), &b = *end;
    double u = a.u + (b.u - a.u) * (s - a.s) / (b.s - a.s);
    for (int i = 0; i < 20; ++i) {
      const double du = (s - a.s - integral(a.u, u)) / speed(u);
      u = std::clamp(u + du, a.u, b.u);
      if (std::abs(du) < 1e-9) break;  // the next would be round-off
    }
    return u;
  }

 private:
  struct Panel {
    double u, s;  // where it ends
  };

  double speed(double u) const {
    const double v = spline_.derivative(u).head<3>().norm();
    // A parameter close to the arc length has a speed of about `size`; NaN is refused too.
    if (!(v > 0.01 * size_ && v < 10.0 * size_)) {
      const Vec3 x = who_.origin + Vec3(spline_.value(u).head<3>());
      throw Error(
          who_.source,
          fmt::format("{}: the curve {}{}; give more points, to more digits, or a "
                      "lower degree",
                      who_.item,
                      v <= 0.01 * size_ ? "turns back or stops" : "swings out between its points",
                      v <= 0.01 * size_ ? " near " + in_words(x) : ""));
    }
    return v;
  }
  double integral(double a, double b) const {
    static const Quadrature rule = gauss_rule(16);
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.points.size(); ++i)
      sum += rule.weights[i] * speed(a + 0.5 * (b - a) * (1.0 + rule.points[i]));
    return 0.5 * (b - a) * sum;
  }
  void add(double a, double b, double whole, int depth) {
    const double middle = 0.5 * (a + b), left = integral(a, middle), right = integral(middle, b);
    // The error of a smooth integrand falls by 2^-32 from panel to halves: those are exact to round-off.
    if (std::abs(left + right - whole) > 1e-9 * size_ && depth < 12) {
      add(a, middle, left, depth + 1);
      add(middle, b, right, depth + 1);
    } else {
      panels_.push_back({middle, panels_.back().s + left});
      panels_.push_back({b, panels_.back().s + right});
    }
  }

  Who who_;
  Spline spline_;
  double size_;
  std::vector<Panel> panels_;
};

int degree_of(const BeamScene& beam, const Curve& curve) {
  const int points = static_cast<int>(curve.points.size());
  if (points < 2)
    throw Error(beam.source, fmt::format("{}: has {} <point>s; a curve needs two at least",
                                         label(beam), points));
  if (curve.degree == 0) return std::min(points - 1, 2 * beam.order + 1);
  if (curve.degree < 0 || curve.degree > points - 1)
    throw Error(beam.source, fmt::format("{}: degree {} is out of range; {} points allow 1 "
                                         "to {}",
                                         label(beam), curve.degree, points, points - 1));
  if (curve.degree == 1 && points > 2)
    throw Error(beam.source,
                fmt::format("{}: a curve of degree 1 has corners; give a degree of 2 or "
                            "more, or join straight beams by <fixed>",
                            label(beam)));
  return curve.degree;
}

constexpr Index most_points = 2000;  // the spline through them is solved densely

ReferenceLine curve_line(const BeamScene& beam, const Curve& curve) {
  const int degree = degree_of(beam, curve);
  const auto count = static_cast<Index>(curve.points.size());
  if (count > most_points)
    throw Error(beam.source, fmt::format("{}: {} points, a curve may have {}; leave some out, or "
                                         "join several curves",
                                         label(beam), count, most_points));
  const Vec3 origin = curve.points[0].at;  // far from the inertial one, digits would be lost
  const Who who{beam.source, label(beam), origin};
  Eigen::MatrixXd data(7, count);
  VecX chord(count);
  double size = 0.0;
  for (Index i = 0; i < count; ++i) {
    const CurvePoint& point = curve.points[static_cast<std::size_t>(i)];
    const Vec3 normal = point.normal ? *point.normal : beam.normal;
    if (!(normal.norm() > 0.0))
      throw Error(point.source, fmt::format("{}: point {}: the normal is zero; give a "
                                            "direction across the beam",
                                            label(beam), i + 1));
    data.col(i) << point.at - origin, normal.normalized(), point.twist;
    if (i > 0) {
      const double step = (data.col(i) - data.col(i - 1)).head<3>().norm();
      if (!(step > 0.0))
        throw Error(point.source, fmt::format("{}: points {} and {} are the same; leave one out",
                                              label(beam), i, i + 1));
      size += step;
    }
    chord(i) = size;
  }
  chord /= size;

  VecX u = chord;
  for (int round = 0; round < (degree - 1) / 2; ++round) {
    const ArcLength s(who, Spline(data, u, degree), size);
    VecX next = u;
    for (Index i = 1; i + 1 < count; ++i) next(i) = s(u(i)) / s.length();
    u = next;
  }
  auto spline = std::make_shared<const Spline>(data, u, degree);
  auto s_of_u = std::make_shared<const ArcLength>(who, *spline, size);
  const double length = s_of_u->length();
  return {length, [who, spline, s_of_u, length](double s) {
            const double at = s_of_u->parameter_at(s * length);
            const VecX x = spline->value(at);
            const Vec3 tangent = spline->derivative(at).head<3>().normalized();
            Mat3 R;
            if (!section_axes(tangent, x.segment<3>(3), R))
              throw Error(who.source,
                          fmt::format("{}: the normal is along the curve at {:.3g} of its "
                                      "length; give the points normals of their own, across it",
                                      who.item, s));
            const Mat3 turn = Eigen::AngleAxisd(x(6), Eigen::Vector3d::UnitX()).toRotationMatrix();
            return make_pose(R * turn, who.origin + Vec3(x.head<3>()));
          }};
}

}  // namespace

Pose<double> make_pose(const Mat3& R, const Vec3& r) {
  return {Quaternion<double>(Eigen::Quaterniond(Eigen::Matrix3d(R)).normalized()), r};
}

ReferenceLine make_reference_line(const BeamScene& beam) {
  if (const auto* straight = std::get_if<Straight>(&beam.line))
    return straight_line(beam, *straight);
  if (const auto* arc = std::get_if<Arc>(&beam.line)) return arc_line(beam, *arc);
  return curve_line(beam, std::get<Curve>(beam.line));
}

}  // namespace mbd
