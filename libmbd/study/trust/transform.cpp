#include "libmbd/study/trust/transform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>

#include "libmbd/compile/joints.hpp"
#include "libmbd/compile/loads.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/scene/laws.hpp"

namespace mbd {
namespace {

using LawVector = std::array<Expression, 3>;
using FieldVector = std::array<FieldExpression, 3>;

Expression scaled_law(const Expression& e, double factor, double stretch = 1.0) {
  const Expression::Term one[] = {{factor, &e}};
  return Expression::sum(one, stretch);
}

LawVector scaled_law(const LawVector& laws, double factor, double stretch = 1.0) {
  return {scaled_law(laws[0], factor, stretch), scaled_law(laws[1], factor, stretch),
          scaled_law(laws[2], factor, stretch)};
}

// The text with numbers in place of parameters, and t/stretch in place of t.
std::string self_contained(const FieldExpression& field, double stretch) {
  return field.reworded([&](std::string_view word) {
    const auto parameter = field.parameters.find(word);
    if (parameter != field.parameters.end()) return fmt::format("({})", parameter->second);
    return word == "t" && stretch != 1.0 ? fmt::format("(t/{})", stretch) : std::string(word);
  });
}

FieldVector scaled_law(const FieldVector& fields, double factor, double stretch) {
  FieldVector result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i].text = fmt::format("{}*({})", factor, self_contained(fields[i], stretch));
  return result;
}

FieldVector turned_law(const FieldVector& fields, const Mat3& R) {
  FieldVector result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      result[i].text += fmt::format("{}({})*({})", k == 0 ? "" : " + ",
                                    R(static_cast<Index>(i), static_cast<Index>(k)),
                                    self_contained(fields[k], 1.0));
  return result;
}

template <class T, class F>
void change_if(std::optional<T>& value, const F& to) {
  if (value) value = to(*value);
}

// What a column of a run is.
struct Meaning {
  const RecordScene* record = nullptr;
  const schema::Quantity* quantity = nullptr;  // nullptr: one of a path, or of no record
};

Meaning meaning_of(const Scene& scene, std::string_view column) {
  for (const RecordScene& record : scene.records) {
    if (record_of(column) != record.name || column.size() <= record.name.size()) continue;
    std::string_view name = column.substr(record.name.size() + 1);
    if (const std::size_t dot = name.find('.'); dot != std::string_view::npos)
      name = name.substr(0, dot);
    const auto known = record.joint    ? schema::joint_quantities()
                       : record.at     ? schema::place_quantities()
                       : record.spring ? schema::spring_quantities()
                                       : schema::system_quantities();
    return {&record, schema::find_quantity(known, name)};
  }
  return {};
}

// Of three components along inertial axes.
bool is_inertial(const Meaning& meaning) {
  if (meaning.quantity == nullptr || meaning.quantity->components != 3) return false;
  const std::string_view name = meaning.quantity->name;
  if (meaning.record->spring) return false;  // in axes that move with it
  if (meaning.record->joint)
    return true;  // in axes that started along inertial ones, or their like
  if (meaning.record->at) return !name.ends_with("_local") && name != "force" && name != "moment";
  return true;
}

// How reactions of a joint turn: R, but about an axis whose other two directions depend on the inertial ones.
Mat3 turn_of_reactions(const Scene& scene, const std::string& joint, const Mat3& R) {
  for (const JointScene& j : scene.joints) {
    if (j.name != joint || !j.axis) continue;
    const std::optional<Vec3> moved_second =
        j.second_axis ? std::optional<Vec3>(R * *j.second_axis) : std::nullopt;
    return frame_with_third(Vec3(R * *j.axis), moved_second).transpose() * R *
           frame_with_third(*j.axis, j.second_axis);
  }
  return R;
}

class TransformRandom {
 public:
  explicit TransformRandom(std::uint64_t seed) : engine_(seed) {}
  double in(double low, double high) {
    // Not by uniform_real_distribution, whose numbers differ from library to library.
    const double u = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return low + (high - low) * u;
  }
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t n = items.size(); n > 1; --n)
      std::swap(items[n - 1], items[static_cast<std::size_t>(in(0.0, static_cast<double>(n)))]);
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 x(in(-1.0, 1.0), in(-1.0, 1.0), in(-1.0, 1.0));
      if (x.norm() > 0.1 && x.norm() < 1.0) return x.normalized();
    }
  }

 private:
  std::mt19937_64 engine_;
};

Scene bare_scene(const Scene& scene) {
  Scene result = scene;
  result.expects.clear();
  result.plots.clear();
  return result;
}

}  // namespace

double UnitChange::factor(std::string_view unit) const {
  struct Dimension {
    std::string_view name;
    int length, mass, time;
  };
  static constexpr Dimension known[] = {{"m", 1, 0, 0},   {"kg", 0, 1, 0}, {"s", 0, 0, 1},
                                        {"N", 1, 1, -2},  {"J", 2, 1, -2}, {"W", 2, 1, -3},
                                        {"rad", 0, 0, 0}, {"", 0, 0, 0},   {"1", 0, 0, 0}};
  double factor = 1.0;
  int sign = 1;
  for (std::size_t at = 0; at <= unit.size();) {
    const std::size_t end = std::min(unit.find_first_of("./", at), unit.size());
    std::string_view name = unit.substr(at, end - at);
    int power = 1;
    if (name.size() > 1 && name.back() >= '2' && name.back() <= '9') {
      power = name.back() - '0';
      name.remove_suffix(1);
    }
    const auto* const found =
        std::find_if(std::begin(known), std::end(known),
                     [&](const Dimension& dimension) { return dimension.name == name; });
    if (found == std::end(known)) throw std::logic_error("no unit: " + std::string(unit));
    const int n = sign * power;
    factor *= std::pow(length, n * found->length) * std::pow(mass, n * found->mass) *
              std::pow(time, n * found->time);
    if (end < unit.size() && unit[end] == '/') sign = -1;
    at = end + 1;
  }
  return factor;
}

Scene without_inertial_marks(const Scene& scene) {
  Scene result = bare_scene(scene);
  if (!result.path) return result;
  constexpr int points_without_stop = 40;
  const auto uncarried = [&](const PathMarkScene& mark) {
    return is_inertial(meaning_of(scene, mark.quantity));
  };
  for (const PathMarkScene& mark : result.path->marks)
    if (mark.stops && uncarried(mark))
      result.path->points = std::min(result.path->points, points_without_stop);
  std::erase_if(result.path->marks, uncarried);
  return result;
}

Transformed moved(const Scene& scene, const RigidMotion& motion) {
  const Mat3& R = motion.R;
  const auto point = [&](const Vec3& x) { return Vec3(R * x + motion.shift); };
  const auto direction = [&](const Vec3& x) { return Vec3(R * x); };
  const auto laws = [&](const LawVector& e) { return turned_law(e, R); };
  const auto fields = [&](const FieldVector& e) { return turned_law(e, R); };
  Transformed result{without_inertial_marks(scene), {}};
  Scene& s = result.scene;
  if (scene.path)
    for (const PathMarkScene& mark : scene.path->marks)
      if (is_inertial(meaning_of(scene, mark.quantity)))
        result.left_out.push_back(fmt::format("{} at {} = {:g}, along an inertial axis",
                                              mark.stops ? "stop" : "mark", mark.quantity,
                                              mark.value));
  for (BeamScene& beam : s.beams) {
    beam.normal = direction(beam.normal);
    if (auto* const line = std::get_if<Straight>(&beam.line)) {
      line->from = point(line->from);
      line->to = point(line->to);
    } else if (auto* const arc = std::get_if<Arc>(&beam.line)) {
      arc->from = point(arc->from);
      arc->center = point(arc->center);
      arc->axis = direction(arc->axis);
    } else {
      for (CurvePoint& p : std::get<Curve>(beam.line).points) {
        p.at = point(p.at);
        change_if(p.normal, direction);
      }
    }
  }
  for (BodyScene& body : s.bodies) {
    if (body.attached_to) continue;
    body.at = point(body.at);
    body.orientation = R * body.orientation;
    body.velocity = direction(body.velocity);
  }
  for (JointScene& j : s.joints) {
    change_if(j.at, point);
    change_if(j.at_a, point);
    change_if(j.at_b, point);
    change_if(j.axis, direction);
    change_if(j.second_axis, direction);
  }
  for (SpringScene& spring : s.springs) {
    change_if(spring.at_a, point);
    change_if(spring.at_b, point);
  }
  for (BushingScene& bushing : s.bushings) {
    const Mat3 frame = bushing.axis ? frame_with_third(*bushing.axis, bushing.second_axis)
                                    : Mat3(Mat3::Identity());
    bushing.axis = direction(frame.col(2));
    bushing.second_axis = direction(frame.col(0));
    change_if(bushing.at, point);
  }
  for (MotionScene& m : s.motions) {
    change_if(m.displacement, laws);
    change_if(m.velocity, laws);
    change_if(m.rotation, laws);
    change_if(m.axis, direction);
  }
  for (LoadScene& load : s.loads) {
    change_if(load.force, laws);
    change_if(load.moment, laws);
  }
  for (DistributedLoadScene& load : s.distributed_loads) {
    change_if(load.force, fields);
    change_if(load.moment, fields);
  }
  for (DragScene& drag : s.drags) change_if(drag.flow, laws);
  if (s.base_motion) {
    change_if(s.base_motion->acceleration, laws);
    change_if(s.base_motion->velocity, laws);
    change_if(s.base_motion->displacement, laws);
  }
  if (s.gravity) s.gravity->acceleration = direction(s.gravity->acceleration);
  return result;
}

Transformed rescaled(const Scene& scene, const UnitChange& units) {
  const double length = units.factor("m"), time = units.factor("s");
  const auto by = [&](std::string_view unit) {
    return [factor = units.factor(unit)](const auto& x) {
      return std::decay_t<decltype(x)>(x * factor);
    };
  };
  const auto law = [&](std::string_view unit) {
    return
        [factor = units.factor(unit), time](const auto& e) { return scaled_law(e, factor, time); };
  };
  const auto point = by("m");
  const auto stiffness = [&](Mat6& D) {
    D.topLeftCorner<3, 3>() *= units.factor("N");
    D.topRightCorner<3, 3>() *= units.factor("N.m");
    D.bottomLeftCorner<3, 3>() *= units.factor("N.m");
    D.bottomRightCorner<3, 3>() *= units.factor("N.m2");
  };
  const auto mass = [&](std::optional<Mat6>& M) {
    if (!M) return;
    M->topLeftCorner<3, 3>() *= units.factor("kg/m");
    M->topRightCorner<3, 3>() *= units.factor("kg");
    M->bottomLeftCorner<3, 3>() *= units.factor("kg");
    M->bottomRightCorner<3, 3>() *= units.factor("kg.m");
  };
  Transformed result{bare_scene(scene), {}};
  Scene& s = result.scene;
  for (Section& section : s.sections) {
    stiffness(section.stiffness);
    mass(section.mass);
    if (section.damping) {
      section.damping->stiffness_proportional *= time;
      section.damping->mass_proportional /= time;
      stiffness(section.damping->viscous);
      section.damping->viscous *= time;
    }
    for (Station& station : section.stations) {
      stiffness(station.stiffness);
      mass(station.mass);
    }
  }
  for (BeamScene& beam : s.beams) {
    if (auto* const line = std::get_if<Straight>(&beam.line)) {
      line->from *= length;
      line->to *= length;
    } else if (auto* const arc = std::get_if<Arc>(&beam.line)) {
      arc->from *= length;
      arc->center *= length;
    } else {
      for (CurvePoint& p : std::get<Curve>(beam.line).points) p.at *= length;
    }
  }
  for (BodyScene& body : s.bodies) {
    body.at *= length;
    body.center *= length;
    body.mass *= units.factor("kg");
    body.inertia *= units.factor("kg.m2");
    body.velocity *= units.factor("m/s");
    body.angular_velocity *= units.factor("rad/s");
  }
  for (JointScene& j : s.joints) {
    change_if(j.at, point);
    change_if(j.at_a, point);
    change_if(j.at_b, point);
    if (j.parameter) {
      const schema::JointKind* const kind = schema::find_joint_kind(j.kind);
      if (kind != nullptr) j.parameter = *j.parameter * units.factor(kind->traits.parameter.unit);
    }
  }
  for (DriveScene& d : s.drives) {
    change_if(d.rate, law("rad/s"));
    change_if(d.angle, law("rad"));
    change_if(d.speed, law("m/s"));
    change_if(d.displacement, law("m"));
  }
  for (MotionScene& m : s.motions) {
    change_if(m.displacement, law("m"));
    change_if(m.velocity, law("m/s"));
    change_if(m.rotation, law("rad"));
    change_if(m.angle, law("rad"));
    change_if(m.rate, law("rad/s"));
  }
  for (LoadScene& load : s.loads) {
    change_if(load.force, law("N"));
    change_if(load.moment, law("N.m"));
    change_if(load.follower_force, law("N"));
    change_if(load.follower_moment, law("N.m"));
    load.offset *= length;
  }
  for (DistributedLoadScene& load : s.distributed_loads) {
    change_if(load.force, law("N/m"));
    change_if(load.moment, law("N"));
    change_if(load.follower_force, law("N/m"));
    change_if(load.follower_moment, law("N"));
  }
  for (PointMassScene& m : s.point_masses) {
    m.mass *= units.factor("kg");
    m.offset *= length;
  }
  const auto elastic = [&](std::string_view force, std::string_view of) {
    return [f = units.factor(force), x = units.factor(of)](const LawScene& e) {
      return scaled_law(e, f, x);
    };
  };
  for (SpringScene& spring : s.springs) {
    change_if(spring.at_a, point);
    change_if(spring.at_b, point);
    change_if(spring.length, point);
    spring.stiffness *= units.factor("N/m");
    spring.damping *= units.factor("N.s/m");
    change_if(spring.force, elastic("N", "m"));
    change_if(spring.damping_force, elastic("N", "m/s"));
  }
  const auto blocks = [&](Mat6& M, std::string_view of_lengths, std::string_view mixed,
                          std::string_view of_angles) {
    M.topLeftCorner<3, 3>() *= units.factor(of_lengths);
    M.topRightCorner<3, 3>() *= units.factor(mixed);
    M.bottomLeftCorner<3, 3>() *= units.factor(mixed);
    M.bottomRightCorner<3, 3>() *= units.factor(of_angles);
  };
  for (BushingScene& bushing : s.bushings) {
    change_if(bushing.at, point);
    blocks(bushing.stiffness, "N/m", "N", "N.m");
    blocks(bushing.damping, "N.s/m", "N.s", "N.m.s");
    for (BushingLawScene& l : bushing.laws)
      l.force = l.component <= 3 ? elastic("N", "m")(l.force) : elastic("N.m", "rad")(l.force);
  }
  for (JointSpringScene& spring : s.joint_springs) {
    const bool turns = spring.coordinate == JointSpringScene::Coordinate::angle;
    const std::string_view force = turns ? "N.m" : "N";
    spring.stiffness *= units.factor(turns ? "N.m" : "N/m");
    spring.damping *= units.factor(turns ? "N.m.s" : "N.s/m");
    spring.rest *= units.factor(turns ? "rad" : "m");
    change_if(spring.force, elastic(force, turns ? "rad" : "m"));
    change_if(spring.damping_force, elastic(force, turns ? "rad/s" : "m/s"));
  }
  for (JointTorqueScene& torque : s.joint_torques) {
    change_if(torque.moment, law("N.m"));
    change_if(torque.force, law("N"));
  }
  for (DragScene& drag : s.drags) {
    drag.density *= units.factor("kg/m3");
    change_if(drag.flow, law("m/s"));
    change_if(drag.diameter, by("m"));
    change_if(drag.area, by("m2"));
    change_if(drag.offset, by("m"));
  }
  for (AddedMassScene& m : s.added_masses) {
    change_if(m.density, by("kg/m3"));
    change_if(m.diameter, by("m"));
    if (!m.matrix) continue;
    m.matrix->topLeftCorner<3, 3>() *= units.factor("kg");
    m.matrix->topRightCorner<3, 3>() *= units.factor("kg.m");
    m.matrix->bottomLeftCorner<3, 3>() *= units.factor("kg.m");
    m.matrix->bottomRightCorner<3, 3>() *= units.factor("kg.m2");
  }
  if (s.base_motion) {
    change_if(s.base_motion->acceleration, law("m/s2"));
    change_if(s.base_motion->velocity, law("m/s"));
    change_if(s.base_motion->displacement, law("m"));
  }
  if (s.gravity) s.gravity->acceleration *= units.factor("m/s2");
  if (s.transient) {
    TransientScene& t = *s.transient;
    t.duration *= time;
    change_if(t.step, by("s"));
    change_if(t.max_step, by("s"));
    change_if(t.output, by("s"));
    change_if(t.position_tolerance, by("m"));
    change_if(t.velocity_tolerance, by("m/s"));
    change_if(t.angular_velocity_tolerance, by("rad/s"));
  }
  if (s.path)
    for (PathMarkScene& mark : s.path->marks)
      if (const Meaning meaning = meaning_of(scene, mark.quantity); meaning.quantity != nullptr)
        mark.value *= units.factor(meaning.quantity->unit);
  return result;
}

Scene reordered(const Scene& scene, std::uint64_t seed) {
  Scene s = bare_scene(scene);
  TransformRandom random(seed);
  random.shuffle(s.sections);
  random.shuffle(s.beams);
  random.shuffle(s.bodies);
  random.shuffle(s.rigids);
  random.shuffle(s.joints);
  random.shuffle(s.drives);
  random.shuffle(s.motions);
  random.shuffle(s.loads);
  random.shuffle(s.distributed_loads);
  random.shuffle(s.point_masses);
  random.shuffle(s.springs);
  random.shuffle(s.bushings);
  random.shuffle(s.joint_springs);
  random.shuffle(s.joint_torques);
  random.shuffle(s.drags);
  random.shuffle(s.added_masses);
  return s;
}

Scene perturbed(const Scene& scene, double relative, std::uint64_t seed) {
  Scene s = bare_scene(scene);
  TransformRandom random(seed);
  const auto factor = [&] { return 1.0 + relative * random.in(-1.0, 1.0); };
  const auto each = [&](auto& matrix) {
    for (Index i = 0; i < matrix.size(); ++i) matrix(i) *= factor();
  };
  for (Section& section : s.sections) {
    const double D = factor(), M = factor();
    section.stiffness *= D;
    if (section.damping) section.damping->viscous *= D;
    if (section.mass) *section.mass *= M;
    for (Station& station : section.stations) {
      station.stiffness *= D;
      if (station.mass) *station.mass *= M;
    }
  }
  Vec3 first = Vec3::Zero();
  double size = 0.0;  // of the distances between bodies
  for (const BodyScene& body : s.bodies)
    if (!body.attached_to) first = body.at;
  for (const BodyScene& body : s.bodies)
    if (!body.attached_to) size = std::max(size, (body.at - first).norm());
  for (BodyScene& body : s.bodies) {
    body.mass *= factor();
    const Mat3 old = body.inertia;
    for (Index i = 0; i < 3; ++i)
      for (Index k = i; k < 3; ++k) body.inertia(i, k) = body.inertia(k, i) = old(i, k) * factor();
    each(body.center);
    if (body.attached_to) continue;
    body.at += relative * size * random.in(0.0, 1.0) * random.direction();
    const Vec3 turn = relative * random.in(0.0, 1.0) * random.direction();
    body.orientation = body.orientation * exp_so3<double>(turn).toRotationMatrix();
    each(body.velocity);
    each(body.angular_velocity);
  }
  const auto law = [&](const LawVector& e) { return scaled_law(e, factor()); };
  const auto field = [&](const FieldVector& e) { return scaled_law(e, factor(), 1.0); };
  for (LoadScene& load : s.loads) {
    change_if(load.force, law);
    change_if(load.moment, law);
    change_if(load.follower_force, law);
    change_if(load.follower_moment, law);
  }
  for (DistributedLoadScene& load : s.distributed_loads) {
    change_if(load.force, field);
    change_if(load.moment, field);
    change_if(load.follower_force, field);
    change_if(load.follower_moment, field);
  }
  for (PointMassScene& m : s.point_masses) m.mass *= factor();
  for (SpringScene& spring : s.springs) {
    spring.stiffness *= factor();
    spring.damping *= factor();
    const auto one = [&](const LawScene& e) { return scaled_law(e, factor(), 1.0); };
    change_if(spring.force, one);
    change_if(spring.damping_force, one);
  }
  for (BushingScene& bushing : s.bushings) {
    bushing.stiffness *= factor();
    bushing.damping *= factor();
    for (BushingLawScene& l : bushing.laws) l.force = scaled_law(l.force, factor(), 1.0);
  }
  for (JointSpringScene& spring : s.joint_springs) {
    spring.stiffness *= factor();
    spring.damping *= factor();
    const auto one = [&](const LawScene& e) { return scaled_law(e, factor(), 1.0); };
    change_if(spring.force, one);
    change_if(spring.damping_force, one);
  }
  for (JointTorqueScene& torque : s.joint_torques) {
    const auto one = [&](const Expression& e) { return scaled_law(e, factor()); };
    change_if(torque.moment, one);
    change_if(torque.force, one);
  }
  if (s.gravity) each(s.gravity->acceleration);
  for (DragScene& drag : s.drags) {
    drag.density *= factor();
    change_if(drag.flow, law);
  }
  for (AddedMassScene& m : s.added_masses) {
    const double f = factor();
    if (m.density) *m.density *= f;
    if (m.matrix) *m.matrix *= f;
  }
  if (s.base_motion) {
    change_if(s.base_motion->acceleration, law);
    change_if(s.base_motion->velocity, law);
    change_if(s.base_motion->displacement, law);
  }
  return s;
}

RigidMotion random_motion(std::uint64_t seed, double distance) {
  TransformRandom random(seed);
  const Vec3 turn = random.in(0.5, 3.0) * random.direction();
  RigidMotion motion;
  motion.R = exp_so3<double>(turn).toRotationMatrix();
  motion.shift = distance * random.direction();
  return motion;
}

Findings moved_back(Findings findings, const Scene& scene, const RigidMotion& motion,
                    std::vector<std::string>& not_compared) {
  std::vector<std::size_t> dropped;
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::find(findings.columns.begin(), findings.columns.end(), name) -
        findings.columns.begin());
  };
  // What the place adds to potential energies: the zero of gravity's lies at the inertial origin.
  std::optional<double> raised;
  const auto potential_raised = [&]() -> double {
    if (!raised) {
      const auto potential = [](const Scene& s) {
        const Model model = compile(s);
        return model.system->energies(model.initial).potential;
      };
      raised = potential(moved(scene, motion).scene) - potential(scene);
    }
    return *raised;
  };
  for (std::size_t c = 0; c < findings.columns.size(); ++c) {
    const Meaning meaning = meaning_of(scene, findings.columns[c]);
    if (meaning.quantity == nullptr) continue;
    const std::string_view name = meaning.quantity->name;
    if (name == "potential_energy" || name == "total_energy") {
      if (!scene.gravity) continue;
      for (std::vector<double>& row : findings.rows) row[c] -= potential_raised();
      continue;
    }
    if (!is_inertial(meaning) || !findings.columns[c].ends_with(".1")) continue;
    const Mat3 back =
        (meaning.record->joint ? turn_of_reactions(scene, *meaning.record->joint, motion.R)
                               : motion.R)
            .transpose();
    // L about the moved origin is R L + shift x R p. Momenta turn back after it, and p stands before L or after.
    std::size_t p = findings.columns.size();
    bool turned_before = false;
    if (name == "angular_momentum") {
      p = column(meaning.record->name + ".linear_momentum.1");
      turned_before = p < c;
      if (p == findings.columns.size()) {
        not_compared.push_back(meaning.record->name +
                               ".angular_momentum, about an origin that has moved: linear_momentum "
                               "is not recorded with it");
        for (std::size_t i = 0; i < 3; ++i) dropped.push_back(c + i);
        continue;
      }
    }
    for (std::vector<double>& row : findings.rows) {
      Vec3 x(row[c], row[c + 1], row[c + 2]);
      if (name == "position") x -= motion.shift;
      if (p < row.size()) {
        const Vec3 momentum(row[p], row[p + 1], row[p + 2]);
        x -= motion.shift.cross(turned_before ? Vec3(motion.R * momentum) : momentum);
      }
      x = back * x;
      for (std::size_t i = 0; i < 3; ++i) row[c + i] = x(static_cast<Index>(i));
    }
  }
  for (std::size_t n = dropped.size(); n > 0; --n) {
    const auto at = static_cast<std::ptrdiff_t>(dropped[n - 1]);
    findings.columns.erase(findings.columns.begin() + at);
    findings.units.erase(findings.units.begin() + at);
    for (std::vector<double>& row : findings.rows) row.erase(row.begin() + at);
  }
  return findings;
}

Findings rescaled_back(Findings findings, const Scene& scene, const UnitChange& units) {
  for (std::size_t c = 0; c < findings.columns.size(); ++c) {
    const double factor = units.factor(findings.units[c]);
    for (std::vector<double>& row : findings.rows) row[c] /= factor;
  }
  if (scene.transient)
    for (double& t : findings.at) t /= units.factor("s");
  findings.energy /= units.factor("J");
  return findings;
}

}  // namespace mbd
