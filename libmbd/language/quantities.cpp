#include "libmbd/language/quantities.hpp"

#include <algorithm>

namespace mbd::schema {
namespace {

using Of = Quantity::Of;
using Axes = Quantity::Axes;
using Moved = Quantity::Moved;
using From = Quantity::From;
using Place = PlaceReading;
using Joint = JointReading;
using Spring = SpringReading;
using Whole = SystemReading;
using Out = std::span<double>;

void put(const Vec3& x, Out out) { std::copy(x.data(), x.data() + 3, out.begin()); }

Vec6 momentum(const Whole& whole, const State& s) {
  return whole.rates ? whole.system->momentum(s) : Vec6(Vec6::Zero());
}

Vec6 ply_stress(const Place& at) { return at.section_point->stress * at.resultants; }
Vec6 ply_strain(const Place& at) { return at.section_point->strain * at.resultants; }
template <section::Criterion criterion>
void failure(const Place& at, const State&, Out out) {
  out[0] = section::failure_index(criterion, ply_stress(at), at.section_point->strengths);
}

constexpr Quantity of_places[] = {
    {"position", "m", 3, "inertial axes", Of::any_place, Axes::inertial, Moved::as_point,
     From::pose, [](const Place& at, const State&, Out out) { put(at.H.r, out); }},
    {"displacement", "m", 3, "from the reference configuration, inertial axes", Of::any_place,
     Axes::inertial, Moved::as_vector, From::pose,
     [](const Place& at, const State&, Out out) { put(at.H.r - at.start.r, out); }},
    {"displacement_local", "m", 3, "the same, in the present axes of the section or body",
     Of::any_place, Axes::own, Moved::unchanged, From::pose,
     [](const Place& at, const State&, Out out) {
       put(at.H.p.conjugate() * Vec3(at.H.r - at.start.r), out);
     }},
    {"rotation", "rad", 3, "rotation vector from the reference configuration, inertial axes",
     Of::any_place, Axes::inertial, Moved::as_vector, From::pose,
     [](const Place& at, const State&, Out out) {
       put(log_so3<double>(at.H.p * at.start.p.conjugate()), out);
     }},
    {"velocity", "m/s", 3, "inertial axes", Of::any_place, Axes::inertial, Moved::as_vector,
     From::velocity,
     [](const Place& at, const State&, Out out) { put(at.H.p * linear(at.V), out); }},
    {"velocity_local", "m/s", 3, "the same, in the present axes of the section or body",
     Of::any_place, Axes::own, Moved::unchanged, From::velocity,
     [](const Place& at, const State&, Out out) { put(linear(at.V), out); }},
    {"angular_velocity", "rad/s", 3, "inertial axes", Of::any_place, Axes::inertial,
     Moved::as_vector, From::velocity,
     [](const Place& at, const State&, Out out) { put(at.H.p * angular(at.V), out); }},
    {"angular_velocity_local", "rad/s", 3, "the same, in the present axes of the section or body",
     Of::any_place, Axes::own, Moved::unchanged, From::velocity,
     [](const Place& at, const State&, Out out) { put(angular(at.V), out); }},
    {"acceleration", "m/s2", 3, "inertial axes", Of::any_place, Axes::inertial, Moved::as_vector,
     From::acceleration,
     [](const Place& at, const State&, Out out) {
       put(at.H.p * Vec3(linear(at.Vdot) + angular(at.V).cross(linear(at.V))), out);
     }},
    {"force", "N", 3,
     "resultants N1 Q2 Q3 of a beam, section axes; where elements meet under a load or mass, the "
     "mean of both sides",
     Of::beam_place, Axes::own, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(linear(at.resultants), out); }},
    {"moment", "N.m", 3, "resultants M1 M2 M3 of a beam, section axes; as of force", Of::beam_place,
     Axes::own, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(angular(at.resultants), out); }},
    {"ply_stress", "Pa", 3, "normal stresses LL TT NN at the record's point, axes of its ply",
     Of::section_point, Axes::of_ply, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(ply_stress(at).head<3>(), out); }},
    {"ply_shear_stress", "Pa", 3, "shear stresses TN LN LT there, axes of its ply",
     Of::section_point, Axes::of_ply, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(ply_stress(at).tail<3>(), out); }},
    {"ply_strain", "", 3, "strains LL TT NN there, axes of its ply", Of::section_point,
     Axes::of_ply, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(ply_strain(at).head<3>(), out); }},
    {"ply_shear_strain", "", 3,
     "shear strains there, axes of its ply: changes of the angles TN LN LT", Of::section_point,
     Axes::of_ply, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { put(ply_strain(at).tail<3>(), out); }},
    {"von_mises", "Pa", 1, "stress of von Mises there", Of::section_point, Axes::none,
     Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) { out[0] = section::von_mises(ply_stress(at)); }},
    {"yield_index", "", 1, "that over the yield stress of an isotropic material",
     Of::section_point_that_yields, Axes::none, Moved::unchanged, From::strain,
     [](const Place& at, const State&, Out out) {
       out[0] = section::von_mises(ply_stress(at)) / at.section_point->yield;
     }},
    {"max_stress", "", 1,
     "failure index there, the largest of the stresses over their strengths; of this and the next "
     "three: 1 is failure, and it grows in proportion to the load",
     Of::section_point_of_plies, Axes::none, Moved::unchanged, From::strain,
     failure<section::Criterion::max_stress>},
    {"tsai_hill", "", 1, "failure index of Tsai and Hill there", Of::section_point_of_plies,
     Axes::none, Moved::unchanged, From::strain, failure<section::Criterion::tsai_hill>},
    {"tsai_wu", "", 1, "failure index of Tsai and Wu there", Of::section_point_of_plies, Axes::none,
     Moved::unchanged, From::strain, failure<section::Criterion::tsai_wu>},
    {"hashin", "", 1, "failure index of Hashin there, of fibres and matrix the larger one",
     Of::section_point_of_plies, Axes::none, Moved::unchanged, From::strain,
     failure<section::Criterion::hashin>},
};

constexpr Quantity of_joints[] = {
    {"angle", "rad", 1, "rotation of b relative to a, unwrapped", Of::joint_with_angle, Axes::none,
     Moved::unchanged, From::pose,
     [](const Joint& joint, const State& s, Out out) { out[0] = joint.angle(s); }},
    {"rate", "rad/s", 1, "rotation rate of b relative to a", Of::joint_with_angle, Axes::none,
     Moved::unchanged, From::velocity,
     [](const Joint& joint, const State& s, Out out) {
       out[0] = joint.rates ? joint.relative_velocity(s)(5) : 0.0;
     }},
    {"displacement", "m", 1, "of b relative to a along the axis", Of::joint_with_displacement,
     Axes::none, Moved::unchanged, From::pose,
     [](const Joint& joint, const State& s, Out out) { out[0] = joint.displacement(s); }},
    {"speed", "m/s", 1, "of b relative to a along the axis", Of::joint_with_displacement,
     Axes::none, Moved::unchanged, From::velocity,
     [](const Joint& joint, const State& s, Out out) {
       out[0] = joint.rates ? joint.relative_velocity(s)(2) : 0.0;
     }},
    {"reaction_force", "N", 3,
     "of the joint (with its drives) or motion on b, joint axes that move with b", Of::any_joint,
     Axes::of_joint, Moved::as_vector, From::acceleration,
     [](const Joint& joint, const State& s, Out out) { put(linear(joint.reaction(s)), out); }},
    {"reaction_moment", "N.m", 3,
     "the same, about the joint's point of b, joint axes that move with b", Of::any_joint,
     Axes::of_joint, Moved::as_vector, From::acceleration,
     [](const Joint& joint, const State& s, Out out) { put(angular(joint.reaction(s)), out); }},
};

constexpr auto effort = [](const Spring& spring, const State& s, Out out) {
  out[0] = spring.effort(s);
};
constexpr Quantity of_springs[] = {
    {"tension", "N", 1, "of a spring with its damper, positive where it pulls", Of::spring,
     Axes::none, Moved::unchanged, From::velocity, effort},
    {"length", "m", 1, "of a spring: the distance of its points", Of::spring, Axes::none,
     Moved::unchanged, From::pose,
     [](const Spring& spring, const State& s, Out out) { out[0] = spring.length(s).length; }},
    {"length_rate", "m/s", 1, "of a spring: the rate of the length", Of::spring, Axes::none,
     Moved::unchanged, From::velocity,
     [](const Spring& spring, const State& s, Out out) { out[0] = spring.length(s).rate; }},
    {"force", "N", 3, "of a bushing with its damping on b, axes of its frame on b", Of::bushing,
     Axes::of_bushing, Moved::unchanged, From::velocity,
     [](const Spring& spring, const State& s, Out out) { put(linear(spring.wrench(s)), out); }},
    {"moment", "N.m", 3, "the same, about the bushing's point of b", Of::bushing, Axes::of_bushing,
     Moved::unchanged, From::velocity,
     [](const Spring& spring, const State& s, Out out) { put(angular(spring.wrench(s)), out); }},
    {"joint_moment", "N.m", 1, "of a joint spring with its damper on b about the axis",
     Of::spring_of_angle, Axes::none, Moved::unchanged, From::velocity, effort},
    {"joint_force", "N", 1, "of a joint spring with its damper on b along the axis",
     Of::spring_of_displacement, Axes::none, Moved::unchanged, From::velocity, effort},
};

constexpr Quantity of_system[] = {
    {"linear_momentum", "N.s", 3, "of everything, added mass included, inertial axes",
     Of::whole_system, Axes::inertial, Moved::as_vector, From::velocity,
     [](const Whole& all, const State& s, Out out) { put(linear(momentum(all, s)), out); }},
    {"angular_momentum", "N.m.s", 3, "the same about the inertial origin, inertial axes",
     Of::whole_system, Axes::inertial, Moved::as_momentum, From::velocity,
     [](const Whole& all, const State& s, Out out) { put(angular(momentum(all, s)), out); }},
    {"kinetic_energy", "J", 1, "of everything, added mass included", Of::whole_system, Axes::none,
     Moved::unchanged, From::velocity,
     [](const Whole& all, const State& s, Out out) { out[0] = all.system->energies(s).kinetic; }},
    {"strain_energy", "J", 1, "of all beams, springs and bushings", Of::whole_system, Axes::none,
     Moved::unchanged, From::pose,
     [](const Whole& all, const State& s, Out out) { out[0] = all.system->energies(s).strain; }},
    {"potential_energy", "J", 1, "of gravity, zero at the inertial origin", Of::whole_system,
     Axes::none, Moved::as_potential, From::pose,
     [](const Whole& all, const State& s, Out out) { out[0] = all.system->energies(s).potential; }},
    {"total_energy", "J", 1, "kinetic, strain and potential", Of::whole_system, Axes::none,
     Moved::as_potential, From::velocity,
     [](const Whole& all, const State& s, Out out) { out[0] = all.system->energies(s).total(); }},
    {"work_of_loads", "J", 1, "since the start of the <transient>, gravity excepted; 0 without",
     Of::whole_system, Axes::none, Moved::unchanged, From::velocity,
     [](const Whole&, const State& s, Out out) { out[0] = s.work.loads; }, true},
    {"work_of_drives", "J", 1, "of drives and motions since the start of the <transient>",
     Of::whole_system, Axes::none, Moved::unchanged, From::velocity,
     [](const Whole&, const State& s, Out out) { out[0] = s.work.drives; }, true},
    {"work_of_damping", "J", 1,
     "of damping, dampers and drag since the start: negative, or 0; of drag in a flow, of either "
     "sign",
     Of::whole_system, Axes::none, Moved::unchanged, From::velocity,
     [](const Whole&, const State& s, Out out) { out[0] = s.work.damping; }, true},
};

// Each table reads what its records are of, and has three components where they have axes.
template <class Reading, std::size_t n>
constexpr bool is_whole(const Quantity (&table)[n]) {
  for (const Quantity& q : table)
    if (!std::holds_alternative<SampleOf<Reading>>(q.sample) ||
        std::get<SampleOf<Reading>>(q.sample) == nullptr ||
        (q.components == 3) != (q.axes != Axes::none) || (q.turns() && q.components != 3))
      return false;
  return true;
}
static_assert(is_whole<Place>(of_places) && is_whole<Joint>(of_joints) &&
              is_whole<Spring>(of_springs) && is_whole<Whole>(of_system));

}  // namespace

std::string_view in_words(Quantity::Axes axes) {
  switch (axes) {
    case Axes::inertial:
      return "inertial axes";
    case Axes::own:
      return "axes of the section or body";
    case Axes::of_joint:
      return "axes of the joint on b";
    case Axes::of_bushing:
      return "axes of the bushing on b";
    case Axes::of_ply:
      return "axes of the ply";
    case Axes::none:
      break;
  }
  return {};
}

std::span<const Quantity> place_quantities() { return of_places; }
std::span<const Quantity> joint_quantities() { return of_joints; }
std::span<const Quantity> spring_quantities() { return of_springs; }
std::span<const Quantity> system_quantities() { return of_system; }

std::span<const Quantity> quantities_of(const RecordScene& record) {
  if (record.joint) return of_joints;
  if (record.at) return of_places;
  if (record.spring) return of_springs;
  return of_system;
}

bool needs_beam(const RecordScene& record, const Quantity& quantity) {
  return quantity.of == Quantity::Of::beam_place &&
         !(record.at && record.at->kind == mbd::Place::Kind::beam);
}

const Quantity* find_quantity(std::span<const Quantity> quantities, std::string_view name) {
  const auto it = std::find_if(quantities.begin(), quantities.end(),
                               [name](const Quantity& q) { return q.name == name; });
  return it == quantities.end() ? nullptr : &*it;
}

Recorded recorded_in(const Scene& scene, std::string_view column) {
  const auto cut = [&column] {  // up to the next dot
    const std::string_view part = column.substr(0, column.find('.'));
    column.remove_prefix(std::min(part.size() + 1, column.size()));
    return part;
  };
  const std::string_view name = cut();
  for (const RecordScene& record : scene.records)
    if (record.name == name && !column.empty())
      return {&record, find_quantity(quantities_of(record), cut())};
  return {};
}

std::vector<std::string_view> names(std::span<const Quantity> quantities) {
  std::vector<std::string_view> result;
  for (const Quantity& q : quantities) result.push_back(q.name);
  return result;
}

}  // namespace mbd::schema
