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
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/scene/laws.hpp"

namespace mbd {
namespace {

using field::About;
using Moved = schema::Quantity::Moved;

Expression scaled_law(const Expression& e, double factor, double stretch = 1.0) {
  const Expression::Term one[] = {{factor, &e}};
  return Expression::sum(one, stretch);
}

LawVector scaled_law(const LawVector& laws, double factor, double stretch = 1.0) {
  return {scaled_law(laws[0], factor, stretch), scaled_law(laws[1], factor, stretch),
          scaled_law(laws[2], factor, stretch)};
}

FieldVector scaled_law(const FieldVector& fields, double factor, double stretch) {
  FieldVector result;
  for (std::size_t i = 0; i < 3; ++i) {
    const FieldExpression::Term one[] = {{factor, &fields[i]}};
    result[i] = FieldExpression::sum(one, stretch);
  }
  return result;
}

FieldVector turned_law(const FieldVector& fields, const Mat3& R) {
  FieldVector result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Index>(i);
    const FieldExpression::Term terms[] = {
        {R(row, 0), &fields[0]}, {R(row, 1), &fields[1]}, {R(row, 2), &fields[2]}};
    result[i] = FieldExpression::sum(terms);
  }
  return result;
}

// change(value, about) for every value of the scene's items that one of the functions takes.
template <class... F>
void change_values(Scene& scene, const F&... change) {
  const field::Overloaded changes{change...};
  each_item(scene, [&changes](auto& item) {
    field::each_value(item, [&changes](auto& value, const About& about) {
      if constexpr (requires { changes(value, about); }) changes(value, about);
    });
  });
}

// Its components turn with the scene.
bool turns(const schema::Recorded& column) {
  return column.quantity != nullptr && column.quantity->turns();
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
  static constexpr Dimension known[] = {{"m", 1, 0, 0},    {"kg", 0, 1, 0},  {"s", 0, 0, 1},
                                        {"N", 1, 1, -2},   {"J", 2, 1, -2},  {"W", 2, 1, -3},
                                        {"Pa", -1, 1, -2}, {"Hz", 0, 0, -1}, {"rad", 0, 0, 0},
                                        {"", 0, 0, 0},     {"1", 0, 0, 0}};
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
    return turns(schema::recorded_in(scene, mark.quantity));
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
  Transformed result{without_inertial_marks(scene), {}};
  Scene& s = result.scene;
  if (scene.path)
    for (const PathMarkScene& mark : scene.path->marks)
      if (turns(schema::recorded_in(scene, mark.quantity)))
        result.left_out.push_back(fmt::format("{} at {} = {:g}, along an inertial axis",
                                              mark.stops ? "stop" : "mark", mark.quantity,
                                              mark.value));
  if (s.modes &&
      s.modes->rate) {  // where it is not stated, the axis is the first of inertial space
    s.modes->axis = s.modes->direction();
    s.modes->through = s.modes->point_of_axis();
  }
  change_values(
      s,
      [&](Vec3& x, const About& about) {
        if (about.has(field::point)) x = point(x);
        if (about.has(field::inertial)) x = direction(x);
      },
      [&](Mat3& turn, const About& about) {
        if (about.has(field::rotation)) turn = R * turn;
      },
      [&](LawVector& laws, const About& about) {
        if (about.has(field::inertial)) laws = turned_law(laws, R);
      },
      [&](FieldVector& fields, const About& about) {
        if (about.has(field::inertial)) fields = turned_law(fields, R);
      });
  // Without axes a bushing has the inertial ones.
  for (BushingScene& bushing : s.bushings) {
    const Mat3 frame = bushing.axis ? frame_with_third(*bushing.axis, bushing.second_axis)
                                    : Mat3(Mat3::Identity());
    bushing.axis = direction(frame.col(2));
    bushing.second_axis = direction(frame.col(0));
  }
  return result;
}

Transformed rescaled(const Scene& scene, const UnitChange& units) {
  const double time = units.factor("s");
  Transformed result{bare_scene(scene), {}};
  Scene& s = result.scene;
  const auto factor = [&units](const About& about) {
    const std::string_view unit = about.attribute.unit;
    return unit == any_unit ? 1.0 : units.factor(unit);
  };
  change_values(
      s, [&](double& x, const About& about) { x *= factor(about); },
      [&](Vec3& x, const About& about) { x *= factor(about); },
      [&](std::array<double, 2>& x, const About& about) {
        for (double& component : x) component *= factor(about);
      },
      [&](Mat3& M, const About& about) { M *= factor(about); },
      [&](Mat6& M, const About& about) {
        const double mixed = units.factor(about.blocks[1]);
        M.topLeftCorner<3, 3>() *= units.factor(about.blocks[0]);
        M.topRightCorner<3, 3>() *= mixed;
        M.bottomLeftCorner<3, 3>() *= mixed;
        M.bottomRightCorner<3, 3>() *= units.factor(about.blocks[2]);
      },
      [&](Expression& law, const About& about) { law = scaled_law(law, factor(about), time); },
      [&](LawVector& laws, const About& about) { laws = scaled_law(laws, factor(about), time); },
      [&](FieldVector& fields, const About& about) {
        fields = scaled_law(fields, factor(about), time);
      },
      [&](LawScene& law, const About& about) {
        // Of a length, or of an angle, or of their rates.
        const double of = about.attribute.unit == "N.m" ? 1.0 : units.factor("m");
        law = scaled_law(law, factor(about), about.has(field::of_rate) ? of / time : of);
      });
  for (JointScene& j : s.joints)
    if (const schema::JointKind* const kind = schema::find_joint_kind(j.kind); j.parameter && kind)
      j.parameter = *j.parameter * units.factor(kind->traits.parameter.unit);
  if (s.path)
    for (PathMarkScene& mark : s.path->marks)
      if (const auto meaning = schema::recorded_in(scene, mark.quantity);
          meaning.quantity != nullptr)
        mark.value *= units.factor(meaning.quantity->unit);
  return result;
}

Scene reordered(const Scene& scene, std::uint64_t seed) {
  Scene s = bare_scene(scene);
  TransformRandom random(seed);
  each_kind(s, [&random]<class Items>(Items& items) {
    using Item = typename Items::value_type;
    // The order of records is that of columns, which are compared; laws know inputs by their place; controllers see what those
    // before them give.
    if constexpr (requires { items.size(); } && !std::is_same_v<Item, RecordScene> &&
                  !std::is_same_v<Item, InputScene> && !std::is_same_v<Item, FunctionScene> &&
                  !std::is_same_v<Item, ControllerScene>)
      random.shuffle(items);
  });
  return s;
}

namespace {

// One factor for all stations of each.
void perturb(std::vector<Section>& sections, const auto& factor) {
  for (Section& section : sections) {
    const double D = factor(), M = factor();
    section.stiffness *= D;
    if (section.damping) section.damping->viscous *= D;
    if (section.mass) *section.mass *= M;
    for (Station& station : section.stations) {
      station.stiffness *= D;
      if (station.mass) *station.mass *= M;
    }
  }
}

}  // namespace

Scene perturbed(const Scene& scene, double relative, std::uint64_t seed) {
  Scene s = bare_scene(scene);
  TransformRandom random(seed);
  const auto factor = [&] { return 1.0 + relative * random.in(-1.0, 1.0); };
  // Forces, stiffnesses, masses, and what says so of itself.
  const auto varies = [](const About& about) {
    constexpr UnitChange kilograms{1.0, 2.0, 1.0};
    const std::string_view unit = about.blocks[0].empty() ? about.attribute.unit : about.blocks[0];
    return about.has(field::varied) || (unit != any_unit && kilograms.factor(unit) != 1.0);
  };
  const auto scale = [&](auto& x, const About& about) {
    if (varies(about)) x *= factor();
  };
  const auto scale_law = [&](auto& law, const About& about) {
    if (varies(about)) law = scaled_law(law, factor(), 1.0);
  };
  std::vector<Section> sections;
  sections.swap(s.sections);
  change_values(
      s, [&](double& x, const About& about) { scale(x, about); },
      [&](Vec3& x, const About& about) {
        for (double& component : x) scale(component, about);
      },
      [&](Mat3& M, const About& about) {
        if (!varies(about)) return;  // a rotation
        for (Index i = 0; i < 3; ++i)
          for (Index k = i; k < 3; ++k) {
            scale(M(i, k), about);
            M(k, i) = M(i, k);
          }
      },
      [&](Mat6& M, const About& about) { scale(M, about); },
      [&](Expression& law, const About& about) { scale_law(law, about); },
      [&](LawVector& laws, const About& about) { scale_law(laws, about); },
      [&](FieldVector& fields, const About& about) { scale_law(fields, about); },
      [&](LawScene& law, const About& about) { scale_law(law, about); });
  perturb(sections, factor);
  s.sections.swap(sections);
  Vec3 first = Vec3::Zero();
  double size = 0.0;  // of the distances between bodies
  for (const BodyScene& body : s.bodies)
    if (!body.attached_to) first = body.at;
  for (const BodyScene& body : s.bodies)
    if (!body.attached_to) size = std::max(size, (body.at - first).norm());
  for (BodyScene& body : s.bodies) {
    if (body.attached_to) continue;
    body.at += relative * size * random.in(0.0, 1.0) * random.direction();
    const Vec3 turn = relative * random.in(0.0, 1.0) * random.direction();
    body.orientation = body.orientation * exp_so3<double>(turn).toRotationMatrix();
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

namespace {

double potential_of(const Scene& scene) {
  const Model model = compile(scene);
  return model.system->energies(model.initial).potential;
}

void drop(Findings& findings, const std::vector<std::size_t>& columns) {
  for (std::size_t n = columns.size(); n > 0; --n) {
    const auto at = static_cast<std::ptrdiff_t>(columns[n - 1]);
    findings.columns.erase(findings.columns.begin() + at);
    findings.units.erase(findings.units.begin() + at);
    for (std::vector<double>& row : findings.rows) row.erase(row.begin() + at);
  }
}

}  // namespace

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
    if (!raised) raised = potential_of(moved(scene, motion).scene) - potential_of(scene);
    return *raised;
  };
  for (std::size_t c = 0; c < findings.columns.size(); ++c) {
    const schema::Recorded meaning = schema::recorded_in(scene, findings.columns[c]);
    if (meaning.quantity == nullptr) continue;
    if (meaning.quantity->moved == Moved::as_potential) {
      if (!scene.gravity) continue;
      for (std::vector<double>& row : findings.rows) row[c] -= potential_raised();
      continue;
    }
    if (!turns(meaning) || !findings.columns[c].ends_with(".1")) continue;
    const Mat3 back = (meaning.quantity->axes == schema::Quantity::Axes::of_joint
                           ? turn_of_reactions(scene, *meaning.record->joint, motion.R)
                           : motion.R)
                          .transpose();
    // L about the moved origin is R L + shift x R p. Momenta turn back after it, and p stands before L or after.
    std::size_t p = findings.columns.size();
    bool turned_before = false;
    if (meaning.quantity->moved == Moved::as_momentum) {
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
      if (meaning.quantity->moved == Moved::as_point) x -= motion.shift;
      if (p < row.size()) {
        const Vec3 momentum(row[p], row[p + 1], row[p + 2]);
        x -= motion.shift.cross(turned_before ? Vec3(motion.R * momentum) : momentum);
      }
      x = back * x;
      for (std::size_t i = 0; i < 3; ++i) row[c + i] = x(static_cast<Index>(i));
    }
  }
  drop(findings, dropped);
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
