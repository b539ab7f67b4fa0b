#include "libmbd/language/schema.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "joints/joint_list.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd::schema {
namespace {

constexpr std::string_view top = "mbd";
constexpr std::string_view anywhere = "mbd repeat defaults";
constexpr std::string_view once = "mbd defaults";

constexpr Range unit_interval{0.0, 1.0};
constexpr Range error_range{1e-14, 0.1};  // finer is round-off, coarser is no result
constexpr Range at_least_one{1.0, 1e6};
constexpr std::string_view switches = "off on";
constexpr std::string_view law_names = "force damping_force moment damping_moment";
constexpr std::string_view matrices = "stiffness damping";

// --- attributes of each element: name, kind, unit, default, meaning, range, sizes, choices ---

constexpr Attribute mbd_attributes[] = {
    {"name", Kind::name, "", required, "name of the model, for reports"},
    {"version", Kind::count, "", "1",
     "of the format of this file; a newer one than mbd knows is refused", Range{1.0, 1e6}},
    {"xmlns:xsi", Kind::text, "", optional, "for XML editors, not read"},
    {"xsi:noNamespaceSchemaLocation", Kind::text, "", optional,
     "for XML editors, not read: where they find mbd.xsd"},
};

constexpr Attribute include_attributes[] = {
    {"file", Kind::text, "", required, "its name, relative to the file that includes it"},
};

constexpr Attribute parameter_attributes[] = {
    {"name", Kind::name, "", required, "a word that expressions below may use"},
    {"value", Kind::number, any_unit, required,
     "its value, unless --set gives another; with a unit it is converted to SI units and rad"},
};

constexpr Attribute section_attributes[] = {
    {"name", Kind::name, "", required, "name beams refer to"},
    {"interpolation",
     Kind::choice,
     "",
     "linear",
     "between stations, entry by entry: linear (kinks are best placed at ends of elements) or a "
     "cubic "
     "spline",
     any,
     {3, 3},
     words_of<Interpolation>},
};

constexpr Attribute station_attributes[] = {
    {"at", Kind::number, "", required, "fraction of the reference length of the beam",
     unit_interval},
};

constexpr Attribute stiffness_attributes[] = {
    {"EA", Kind::number, "N", optional, "D11, axial", positive},
    {"GA2", Kind::number, "N", optional, "D22, shear along b2", positive},
    {"GA3", Kind::number, "N", optional, "D33, shear along b3", positive},
    {"GJ", Kind::number, "N.m2", optional, "D44, torsion", positive},
    {"EI2", Kind::number, "N.m2", optional, "D55, bending about b2", positive},
    {"EI3", Kind::number, "N.m2", optional, "D66, bending about b3", positive},
    {"D12", Kind::number, "N", "0",
     "coupling of extension and shear along b2; D21 is the same, and so below"},
    {"D13", Kind::number, "N", "0", "coupling of extension and shear along b3"},
    {"D14", Kind::number, "N.m", "0", "coupling of extension and twist"},
    {"D15", Kind::number, "N.m", "0", "coupling of extension and bending about b2"},
    {"D16", Kind::number, "N.m", "0", "coupling of extension and bending about b3"},
    {"D23", Kind::number, "N", "0", "coupling of shear along b2 and shear along b3"},
    {"D24", Kind::number, "N.m", "0", "coupling of shear along b2 and twist"},
    {"D25", Kind::number, "N.m", "0", "coupling of shear along b2 and bending about b2"},
    {"D26", Kind::number, "N.m", "0", "coupling of shear along b2 and bending about b3"},
    {"D34", Kind::number, "N.m", "0", "coupling of shear along b3 and twist"},
    {"D35", Kind::number, "N.m", "0", "coupling of shear along b3 and bending about b2"},
    {"D36", Kind::number, "N.m", "0", "coupling of shear along b3 and bending about b3"},
    {"D45", Kind::number, "N.m2", "0", "coupling of twist and bending about b2"},
    {"D46", Kind::number, "N.m2", "0", "coupling of twist and bending about b3"},
    {"D56", Kind::number, "N.m2", "0", "coupling of bending about b2 and bending about b3"},
};

constexpr Attribute mass_attributes[] = {
    {"per_length", Kind::number, "kg/m", required, "mass per unit length", positive},
    {"inertia",
     Kind::numbers,
     "kg.m",
     required,
     "per length about the reference line: J11 J22 J33 [J12 J13 J23]",
     any,
     {3, 6}},
    {"center", Kind::numbers, "m", "0 0", "mass centre in the section: x2 x3", any, {2, 2}},
};

constexpr Attribute damping_attributes[] = {
    {"stiffness_proportional", Kind::number, "s", "0",
     "beta: viscous forces are beta D times rates of strain; damping ratio beta omega/2",
     not_negative},
    {"mass_proportional", Kind::number, "1/s", "0",
     "alpha: -alpha times the momentum of all masses of the beam, rigid motion too; damping ratio "
     "alpha/(2 omega)",
     not_negative},
    {"EA", Kind::number, "N.s", "0", "D11, axial: viscous, besides beta D; and so below",
     not_negative},
    {"GA2", Kind::number, "N.s", "0", "D22, shear along b2", not_negative},
    {"GA3", Kind::number, "N.s", "0", "D33, shear along b3", not_negative},
    {"GJ", Kind::number, "N.m2.s", "0", "D44, torsion", not_negative},
    {"EI2", Kind::number, "N.m2.s", "0", "D55, bending about b2", not_negative},
    {"EI3", Kind::number, "N.m2.s", "0", "D66, bending about b3", not_negative},
    {"D12", Kind::number, "N.s", "0", "coupling of extension and shear along b2"},
    {"D13", Kind::number, "N.s", "0", "coupling of extension and shear along b3"},
    {"D14", Kind::number, "N.m.s", "0", "coupling of extension and twist"},
    {"D15", Kind::number, "N.m.s", "0", "coupling of extension and bending about b2"},
    {"D16", Kind::number, "N.m.s", "0", "coupling of extension and bending about b3"},
    {"D23", Kind::number, "N.s", "0", "coupling of shear along b2 and shear along b3"},
    {"D24", Kind::number, "N.m.s", "0", "coupling of shear along b2 and twist"},
    {"D25", Kind::number, "N.m.s", "0", "coupling of shear along b2 and bending about b2"},
    {"D26", Kind::number, "N.m.s", "0", "coupling of shear along b2 and bending about b3"},
    {"D34", Kind::number, "N.m.s", "0", "coupling of shear along b3 and twist"},
    {"D35", Kind::number, "N.m.s", "0", "coupling of shear along b3 and bending about b2"},
    {"D36", Kind::number, "N.m.s", "0", "coupling of shear along b3 and bending about b3"},
    {"D45", Kind::number, "N.m2.s", "0", "coupling of twist and bending about b2"},
    {"D46", Kind::number, "N.m2.s", "0", "coupling of twist and bending about b3"},
    {"D56", Kind::number, "N.m2.s", "0", "coupling of bending about b2 and bending about b3"},
};

// Of every beam, after its reference line.
constexpr Attribute mesh_attributes[] = {
    {"normal", Kind::numbers, "", required,
     "b3 at the start (of a curve: everywhere); its part along the reference line does not matter"},
    {"elements", Kind::count, "", "1", "spectral elements of equal length", at_least_one},
    {"order", Kind::count, "", "3", "order N: N + 1 nodes an element", Range{1.0, 8.0}},
    {"kinematics",
     Kind::choice,
     "",
     "motion",
     "what is interpolated: the motion, or (classical) displacement and rotation apart, without "
     "metric and form",
     any,
     {3, 3},
     words_of<Kinematics>},
    {"metric",
     Kind::choice,
     "",
     "geodesic",
     "interpolation of motion",
     any,
     {3, 3},
     words_of<Metric>},
    {"rule",
     Kind::choice,
     "",
     "gauss",
     "quadrature; gauss_lobatto locks",
     any,
     {3, 3},
     words_of<Rule>},
    {"form",
     Kind::choice,
     "",
     "energy",
     "elastic force: gradient of a discrete energy, or the paper's",
     any,
     {3, 3},
     words_of<Form>},
};

constexpr Attribute beam_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among beams and bodies"},
    {"section", Kind::text, "", required, "name of its section"},
    {"from", Kind::numbers, "m", required, "start of the reference line"},
    {"to", Kind::numbers, "m", required, "end of the reference line"},
};

constexpr Attribute arc_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among beams and bodies"},
    {"section", Kind::text, "", required, "name of its section"},
    {"from", Kind::numbers, "m", required, "start of the reference line"},
    {"center", Kind::numbers, "m", required, "centre of the circle"},
    {"axis", Kind::numbers, "", required, "the line runs right-handed about it"},
    {"angle", Kind::number, "rad", required, "subtended angle", positive},
};

constexpr Attribute curve_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among beams and bodies"},
    {"section", Kind::text, "", required, "name of its section"},
    {"degree", Kind::count, "", optional,
     "of the spline (default: 2 order + 1, or what the points allow; lower it for rough points)",
     Range{1.0, 1e3}},
};

constexpr Attribute point_attributes[] = {
    {"at", Kind::numbers, "m", required, "position"},
    {"normal", Kind::numbers, "", optional, "b3 there (default: the normal of the curve)"},
    {"twist", Kind::number, "rad", "0", "turns the section, right-handed about the tangent"},
};

constexpr Attribute body_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among beams and bodies"},
    {"attached_to", Kind::place, "", optional,
     "the place it is fixed to; its axes are those of the place"},
    {"at", Kind::numbers, "m", optional, "reference point of a free body (default 0 0 0)"},
    {"orientation",
     Kind::numbers,
     "rad",
     optional,
     "of a free body: rotation vector, or (without unit) matrix row by row",
     any,
     {3, 9}},
    {"mass", Kind::number, "kg", required, "mass", not_negative},
    {"center", Kind::numbers, "m", "0 0 0", "mass centre from the reference point, body axes"},
    {"inertia",
     Kind::numbers,
     "kg.m2",
     required,
     "matrix xx yy zz [xy xz yz] about the mass centre, body axes",
     any,
     {3, 6}},
    {"velocity", Kind::numbers, "m/s", optional,
     "of the reference point of a free body at the start, inertial axes (default 0 0 0)"},
    {"angular_velocity", Kind::numbers, "rad/s", optional,
     "of a free body at the start, body axes (default 0 0 0)"},
};

constexpr Attribute rigid_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among beams, bodies and rigid ones"},
    {"of", Kind::names, "", required,
     "names of beams and free bodies; its frame is the first one's"},
};

constexpr Attribute joint_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among joints"},
    {"between", Kind::places, "", required, "the two places a and b it joins"},
    {"at", Kind::numbers, "m", optional,
     "its point (default: that of b, or of a when b is the ground)"},
};

// Of the joints that have two points, an axis, two axes.
constexpr Attribute two_points_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among joints"},
    {"between", Kind::places, "", required, "the two places a and b it joins"},
    {"at_a", Kind::numbers, "m", optional, "its point of a (default: that of the place)"},
    {"at_b", Kind::numbers, "m", optional, "its point of b (default: that of the place)"},
};
constexpr Attribute axis_attribute{"axis", Kind::numbers, "", required,
                                   "direction of its axis; angles turn right-handed about it"};
constexpr Attribute second_axis_attribute{
    "second_axis", Kind::numbers, "", required,
    "direction of its second axis, fixed in b, perpendicular to the first, which is fixed in a"};

constexpr Attribute drive_attributes[] = {
    {"joint", Kind::text, "", required, "name of a joint with an angle or a displacement"},
    {"rate", Kind::signal, "rad/s", optional,
     "rotation rate of b relative to a; the angle starts at 0"},
    {"angle", Kind::signal, "rad", optional, "or the rotation of b relative to a, 0 at the start"},
    {"speed", Kind::signal, "m/s", optional,
     "or the speed of b relative to a along the axis; the displacement starts at 0"},
    {"displacement", Kind::signal, "m", optional,
     "or the displacement of b relative to a along the axis, 0 at the start"},
};

constexpr Attribute motion_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among joints and motions"},
    {"of", Kind::place, "", required, "the place that moves"},
    {"displacement", Kind::signals, "m", optional,
     "from the reference configuration, inertial axes, 0 at the start"},
    {"velocity", Kind::signals, "m/s", optional, "or its rate; the displacement starts at 0"},
    {"rotation", Kind::signals, "rad", optional,
     "rotation vector from the reference configuration, inertial axes, of any length"},
    {"axis", Kind::numbers, "", optional, "or an inertial axis, and one of angle and rate"},
    {"angle", Kind::signal, "rad", optional, "rotation about the axis, 0 at the start"},
    {"rate", Kind::signal, "rad/s", optional, "or its rate; the angle starts at 0"},
};

constexpr Attribute load_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"at", Kind::place, "", required, "where it acts"},
    {"force", Kind::signals, "N", optional, "dead force, inertial axes"},
    {"moment", Kind::signals, "N.m", optional, "dead moment, inertial axes"},
    {"follower_force", Kind::signals, "N", optional, "force in the axes of the section or body"},
    {"follower_moment", Kind::signals, "N.m", optional,
     "moment in the axes of the section or body"},
    {"offset", Kind::numbers, "m", "0 0 0",
     "where the forces act, from the place, in the axes of the section or body"},
};

constexpr Attribute distributed_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"beam", Kind::text, "", required, "name of the beam"},
    {"from", Kind::number, "", "0", "where it begins, fraction of the reference length",
     unit_interval},
    {"to", Kind::number, "", "1", "where it ends", unit_interval},
    {"force", Kind::fields, "N/m", optional, "dead force per reference length, inertial axes"},
    {"moment", Kind::fields, "N", optional, "dead moment per reference length, inertial axes"},
    {"follower_force", Kind::fields, "N/m", optional, "force per reference length, section axes"},
    {"follower_moment", Kind::fields, "N", optional, "moment per reference length, section axes"},
};

constexpr Attribute point_mass_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"at", Kind::place, "", required, "what it moves with"},
    {"mass", Kind::number, "kg", required, "mass", not_negative},
    {"offset", Kind::numbers, "m", "0 0 0", "from the place, axes of the section or body"},
};

constexpr Attribute spring_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among springs"},
    {"between", Kind::places, "", required, "the two places a and b it acts on"},
    {"at_a", Kind::numbers, "m", optional, "its point of a (default: that of the place)"},
    {"at_b", Kind::numbers, "m", optional, "its point of b (default: that of the place)"},
    {"stiffness", Kind::number, "N/m", optional, "tension per extension x", not_negative},
    {"damping", Kind::number, "N.s/m", optional, "tension per rate v of the length", not_negative},
    {"length", Kind::number, "m", optional,
     "free length, where x = 0 (default: that of the reference configuration)", not_negative},
    {"force", Kind::law, "N", optional, "or (both add up) the tension at the extension x [m]"},
    {"damping_force", Kind::rate_law, "N", optional,
     "or (both add up) the tension at the rate v [m/s]; 0 at v = 0"},
};

constexpr Attribute bushing_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among springs"},
    {"between", Kind::places, "", required, "the two places a and b it connects"},
    {"at", Kind::numbers, "m", optional,
     "its point (default: that of b, or of a when b is the ground)"},
    {"axis", Kind::numbers, "", optional, "its third axis (default: inertial axes)"},
    {"second_axis", Kind::numbers, "", optional,
     "its first axis, perpendicular to the third (default: any)"},
    {"stiffness", Kind::numbers, "N/m", optional, "along its three axes", not_negative},
    {"angular_stiffness", Kind::numbers, "N.m", optional, "about its three axes, per rad",
     not_negative},
    {"damping", Kind::numbers, "N.s/m", optional, "along its three axes", not_negative},
    {"angular_damping", Kind::numbers, "N.m.s", optional, "about its three axes, per rad",
     not_negative},
};

constexpr Attribute matrix_attributes[] = {
    {"of", Kind::choice, "", "stiffness", "what it is", any, {3, 3}, matrices},
};

constexpr Attribute law_attributes[] = {
    {"component", Kind::count, "", required,
     "of the motion of b relative to a: 1 to 3 along, 4 to 6 about the axes", Range{1.0, 6.0}},
    {"force", Kind::law, "N", optional, "of components 1 to 3: over the displacement x [m]"},
    {"moment", Kind::law, "N.m", optional, "of components 4 to 6: over the rotation x [rad]"},
    {"interpolation",
     Kind::choice,
     "",
     "linear",
     "of a table: linear or a cubic spline; linear beyond the first and the last point",
     any,
     {3, 3},
     words_of<Interpolation>},
};

constexpr Attribute joint_spring_attributes[] = {
    {"name", Kind::name, "", required, "name, unique among springs"},
    {"joint", Kind::text, "", required, "name of a joint with an angle or a displacement"},
    {"angular_stiffness", Kind::number, "N.m", optional,
     "moment per angle of b relative to a, against it", not_negative},
    {"angular_damping", Kind::number, "N.m.s", optional, "moment per rate of the angle",
     not_negative},
    {"rest_angle", Kind::number, "rad", optional, "angle without moment (default 0)"},
    {"moment", Kind::law, "N.m", optional,
     "or (both add up) the moment at x [rad], the angle less rest_angle, against it"},
    {"damping_moment", Kind::rate_law, "N.m", optional,
     "or (both add up) the moment at the rate v [rad/s]; 0 at v = 0"},
    {"stiffness", Kind::number, "N/m", optional,
     "or force per displacement of b relative to a along the axis, against it", not_negative},
    {"damping", Kind::number, "N.s/m", optional, "force per speed", not_negative},
    {"rest_displacement", Kind::number, "m", optional, "displacement without force (default 0)"},
    {"force", Kind::law, "N", optional,
     "or (both add up) the force at x [m], the displacement less rest_displacement, against it"},
    {"damping_force", Kind::rate_law, "N", optional,
     "or (both add up) the force at the speed v [m/s]; 0 at v = 0"},
};

constexpr Attribute joint_torque_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"joint", Kind::text, "", required, "name of a joint with an angle or a displacement"},
    {"moment", Kind::signal, "N.m", optional, "on b about the axis, and its opposite on a"},
    {"force", Kind::signal, "N", optional, "on b along the axis, and its opposite on a"},
};

constexpr Attribute table_attributes[] = {
    {"of",
     Kind::choice,
     "",
     "force",
     "what it gives, as the attribute of that name",
     any,
     {3, 3},
     law_names},
    {"interpolation",
     Kind::choice,
     "",
     "linear",
     "between its points: linear or a cubic spline; linear beyond the first and the last",
     any,
     {3, 3},
     words_of<Interpolation>},
};

constexpr Attribute drag_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"density", Kind::number, "kg/m3", required, "of the fluid", positive},
    {"flow", Kind::signals, "m/s", optional,
     "velocity of the fluid, inertial axes; without it the fluid is still"},
    {"beam", Kind::text, "", optional, "name of the beam (one of beam, at)"},
    {"from", Kind::number, "", optional,
     "of a beam: where it begins, fraction of the reference length (default 0)", unit_interval},
    {"to", Kind::number, "", optional, "of a beam: where it ends (default 1)", unit_interval},
    {"diameter", Kind::number, "m", optional, "of a beam, which needs it", positive},
    {"normal_coefficient", Kind::number, "", optional,
     "of a beam, which needs it: C of 1/2 density C diameter |u| u per length, u across the beam",
     not_negative},
    {"tangential_coefficient", Kind::number, "", optional,
     "of a beam, which needs it: C of 1/2 density C pi diameter |u| u per length, u along the beam",
     not_negative},
    {"at", Kind::place, "", optional, "or what it acts on (one of beam, at)"},
    {"area", Kind::number, "m2", optional, "at a place, which needs it", positive},
    {"coefficient", Kind::number, "", optional,
     "at a place, which needs it: C of 1/2 density C area |u| u, the same in all directions",
     not_negative},
    {"offset", Kind::numbers, "m", optional,
     "at a place: where it acts, from there, axes of the section or body (default 0 0 0)"},
};

constexpr Attribute added_mass_attributes[] = {
    {"name", Kind::name, "", optional, "name, for messages"},
    {"beam", Kind::text, "", optional, "name of the beam (one of beam, at)"},
    {"from", Kind::number, "", optional,
     "of a beam: where it begins, fraction of the reference length (default 0)", unit_interval},
    {"to", Kind::number, "", optional, "of a beam: where it ends (default 1)", unit_interval},
    {"density", Kind::number, "kg/m3", optional, "of a beam, which needs it: of the fluid",
     positive},
    {"diameter", Kind::number, "m", optional, "of a beam, which needs it", positive},
    {"coefficient", Kind::number, "", optional,
     "of a beam, which needs it: C of density C pi diameter^2/4 per length, across the beam; "
     "along it there is none",
     not_negative},
    {"at", Kind::place, "", optional, "or what it moves with (one of beam, at)"},
    {"matrix",
     Kind::numbers,
     "",
     optional,
     "at a place, which needs it, in SI units: m11 m22 m33 [kg] J11 J22 J33 [kg.m2], or the upper "
     "triangle row by row (21 numbers), of velocities v1 v2 v3 and angular velocities w1 w2 w3 in "
     "the axes of the section or body",
     any,
     {6, 21}},
};

constexpr Attribute base_motion_attributes[] = {
    {"acceleration", Kind::signals, "m/s2", optional, "of the base, inertial axes (one of three)"},
    {"velocity", Kind::signals, "m/s", optional, "or its velocity, continuous"},
    {"displacement", Kind::signals, "m", optional, "or its displacement, continuous with its rate"},
};

constexpr Attribute gravity_attributes[] = {
    {"acceleration", Kind::numbers, "m/s2", required, "of free fall, inertial axes"},
};

constexpr Attribute static_attributes[] = {
    {"steps", Kind::count, "", "1", "the first load step is 1/steps of all loads", at_least_one},
    {"tolerance", Kind::number, "", "1e-12", "of Newton's increments, relative", positive},
    {"solver",
     Kind::choice,
     "",
     "newton",
     "of each load step: our Newton iterations, or KINSOL's with its line search",
     any,
     {3, 3},
     words_of<StaticSolver>},
    {"line_search",
     Kind::choice,
     "",
     "on",
     "of Newton's iterations: increments that do not bring equilibrium nearer are shortened",
     any,
     {3, 3},
     switches},
};

constexpr Attribute path_attributes[] = {
    {"method",
     Kind::choice,
     "",
     "bordered",
     "predictor and corrector on the bordered system, or Crisfield's cylindrical arc length",
     any,
     {3, 3},
     words_of<PathMethod>},
    {"direction",
     Kind::choice,
     "",
     "forward",
     "of the load factor at the start: growing, falling, or first one and then the other",
     any,
     {3, 3},
     words_of<PathDirection>},
    {"step", Kind::number, "", "0.05", "first step, of the load factor", positive},
    {"max_step", Kind::number, "", "0.1",
     "longest step: rms over the nodes of displacement (over the scene's size) and rotation [rad]",
     positive},
    {"points", Kind::count, "", "200", "most points of each branch", at_least_one},
    {"length", Kind::number, "", optional, "most arc length of each branch, measured as max_step",
     positive},
    {"branch", Kind::count, "", "0",
     "number of the bifurcation whose other branch is followed too; negative: to its other side; "
     "0: none",
     Range{-1e6, 1e6}},
    {"tolerance", Kind::number, "", "1e-12", "of the corrector's increments, relative",
     Range{1e-15, 1e-8}},
};

constexpr Attribute mark_attributes[] = {
    {"quantity", Kind::text, "", required, "a column of path.csv"},
    {"value", Kind::number, any_unit, required, "the value it passes, from either side"},
};

constexpr Attribute transient_attributes[] = {
    {"duration", Kind::number, "s", required,
     "simulated time; of fixed steps, a whole number of them", positive},
    {"method",
     Kind::choice,
     "",
     "generalized_alpha",
     "integrator: of order 2; Radau IIA, of order 5; or IDA of SUNDIALS, of variable order",
     any,
     {3, 3},
     words_of<TimeMethod>},
    {"step", Kind::number, "s", optional, "time step, of fixed steps (one of step, tolerance)",
     positive},
    {"tolerance", Kind::number, "", optional,
     "or the relative error that steps are chosen for: of lengths of the scene, of radians, and of "
     "the fastest velocities",
     error_range},
    {"position_tolerance", Kind::number, "m", optional,
     "in place of the relative one, of positions", positive},
    {"rotation_tolerance", Kind::number, "rad", optional, "the same, of rotations", positive},
    {"velocity_tolerance", Kind::number, "m/s", optional,
     "the same, of velocities; not of generalized_alpha, which does not estimate them", positive},
    {"angular_velocity_tolerance", Kind::number, "rad/s", optional,
     "the same, of angular velocities", positive},
    {"max_step", Kind::number, "s", optional,
     "longest step that a tolerance may lead to (default: a part of the duration)", positive},
    {"output",
     Kind::number,
     "s",
     optional,
     "time between rows of results, or steps: where steps end, and at the times of expected values "
     "(default: where fixed steps end; with a tolerance, a thousandth of the duration)",
     positive,
     {3, 3},
     "steps"},
    {"rho_infinity", Kind::number, "", "0",
     "of generalized_alpha: spectral radius at infinite frequency; 0 damps most, 1 nothing",
     unit_interval},
    {"balance",
     Kind::choice,
     "",
     "acceleration",
     "of inertia, of generalized_alpha: accelerations in body axes, or momenta in inertial axes, "
     "which keeps those of free systems to round-off",
     any,
     {3, 3},
     words_of<Balance>},
    {"newton_tolerance", Kind::number, "", optional,
     "of Newton's increments, relative (default: the integrator's own)", positive},
    {"inertia",
     Kind::choice,
     "",
     "full",
     "its terms: all, or without the gyroscopic moment w x J w about the mass centre of what moves "
     "with a node",
     any,
     {3, 3},
     words_of<InertiaTerms>},
};

constexpr Attribute record_attributes[] = {
    {"name", Kind::name, "", required, "first part of its columns in history.csv"},
    {"at", Kind::place, "", optional, "a place; without place, joint and spring: the whole system"},
    {"joint", Kind::text, "", optional, "name of a joint or a motion (one of at, joint, spring)"},
    {"spring", Kind::text, "", optional, "name of a spring, a bushing or a joint_spring"},
    {"quantities", Kind::names, "", required, "what to write, separated by blanks"},
};

constexpr Attribute plot_attributes[] = {
    {"x", Kind::text, "", optional,
     "a column of history.csv (default: the first, time or load_factor)"},
    {"y", Kind::names, "", required, "columns of history.csv, one curve each"},
    {"x_scale", Kind::number, "", "1", "factor on x"},
    {"y_scale", Kind::number, "", "1", "factor on y"},
    {"x_label", Kind::text, "", optional, "default: the column and its unit"},
    {"y_label", Kind::text, "", optional, "default: the column and its unit"},
    {"title", Kind::text, "", optional, "written above the panel"},
    {"x_range", Kind::numbers, "", optional, "ends of the x axis, scaled", any, {2, 2}},
};

constexpr Attribute expect_attributes[] = {
    {"quantity", Kind::text, "", required, "a column of history.csv"},
    {"of",
     Kind::choice,
     "",
     "value",
     "its value at one time (of load steps and paths: at the end), an extreme over the run, or its "
     "value at a limit point, bifurcation or mark of a path",
     any,
     {3, 3},
     "value minimum maximum limit bifurcation mark"},
    {"number", Kind::count, "", "1", "of the limit point, bifurcation or mark, in order",
     at_least_one},
    {"at", Kind::number, "s", optional,
     "time of the value, one at which a row of results is written", not_negative},
    {"value", Kind::number, any_unit, required, "what it must be"},
    {"tolerance", Kind::number, any_unit, required, "by how much it may differ", positive},
    {"source", Kind::text, "", required, "where the number comes from"},
    {"when", Kind::names, "", optional,
     "parameter=value: checked only when the parameters have these values, to 12 digits"},
};

constexpr Attribute repeat_attributes[] = {
    {"count", Kind::count, "", required, "how often its contents are read", Range{0.0, 1e6}},
    {"index", Kind::name, "", "i",
     "parameter that counts from 0; {i+1} in names and places becomes its value"},
};

using Of = Quantity::Of;
constexpr Quantity of_places[] = {
    {"position", "m", 3, "inertial axes"},
    {"displacement", "m", 3, "from the reference configuration, inertial axes"},
    {"displacement_local", "m", 3, "the same, in the present axes of the section or body"},
    {"rotation", "rad", 3, "rotation vector from the reference configuration, inertial axes"},
    {"velocity", "m/s", 3, "inertial axes"},
    {"velocity_local", "m/s", 3, "the same, in the present axes of the section or body"},
    {"angular_velocity", "rad/s", 3, "inertial axes"},
    {"angular_velocity_local", "rad/s", 3, "the same, in the present axes of the section or body"},
    {"acceleration", "m/s2", 3, "inertial axes"},
    {"force", "N", 3, "resultants N1 Q2 Q3 of a beam, section axes", Of::beam_place},
    {"moment", "N.m", 3, "resultants M1 M2 M3 of a beam, section axes", Of::beam_place},
};
constexpr Quantity of_joints[] = {
    {"angle", "rad", 1, "rotation of b relative to a, unwrapped", Of::joint_with_angle},
    {"rate", "rad/s", 1, "rotation rate of b relative to a", Of::joint_with_angle},
    {"displacement", "m", 1, "of b relative to a along the axis", Of::joint_with_displacement},
    {"speed", "m/s", 1, "of b relative to a along the axis", Of::joint_with_displacement},
    {"reaction_force", "N", 3,
     "of the joint (with its drives) or motion on b, joint axes that move with b", Of::any_joint},
    {"reaction_moment", "N.m", 3,
     "the same, about the joint's point of b, joint axes that move with b", Of::any_joint},
};

constexpr Quantity of_springs[] = {
    {"tension", "N", 1, "of a spring with its damper, positive where it pulls", Of::spring},
    {"length", "m", 1, "of a spring: the distance of its points", Of::spring},
    {"length_rate", "m/s", 1, "of a spring: the rate of the length", Of::spring},
    {"force", "N", 3, "of a bushing with its damping on b, axes of its frame on b", Of::bushing},
    {"moment", "N.m", 3, "the same, about the bushing's point of b", Of::bushing},
    {"joint_moment", "N.m", 1, "of a joint spring with its damper on b about the axis",
     Of::joint_spring},
    {"joint_force", "N", 1, "of a joint spring with its damper on b along the axis",
     Of::joint_spring},
};

constexpr Quantity of_system[] = {
    {"linear_momentum", "N.s", 3, "of everything, added mass included, inertial axes",
     Of::whole_system},
    {"angular_momentum", "N.m.s", 3, "the same about the inertial origin, inertial axes",
     Of::whole_system},
    {"kinetic_energy", "J", 1, "of everything, added mass included", Of::whole_system},
    {"strain_energy", "J", 1, "of all beams, springs and bushings", Of::whole_system},
    {"potential_energy", "J", 1, "of gravity, zero at the inertial origin", Of::whole_system},
    {"total_energy", "J", 1, "kinetic, strain and potential", Of::whole_system},
    {"work_of_loads", "J", 1, "since the start, gravity excepted", Of::whole_system},
    {"work_of_drives", "J", 1, "of drives and motions since the start", Of::whole_system},
    {"work_of_damping", "J", 1,
     "of damping, dampers and drag since the start: negative, or 0; of drag in a flow, of either "
     "sign",
     Of::whole_system},
};

const std::vector<JointKind>& joints() {
  static const std::vector<JointKind> all = [] {
    std::vector<JointKind> list;
    joint::for_each(joint::Types{}, [&]<class J>() {
      list.push_back({J::name, J::doc, J::traits});
    });
    return list;
  }();
  return all;
}

// Attributes, and more of them.
std::vector<Attribute> of(std::span<const Attribute> first,
                          std::span<const Attribute> second = {}) {
  std::vector<Attribute> result(first.begin(), first.end());
  result.insert(result.end(), second.begin(), second.end());
  return result;
}

std::vector<Attribute> of(const JointKind& kind) {
  const joint::Traits& traits = kind.traits;
  std::vector<Attribute> result =
      traits.points == joint::Points::two ? of(two_points_attributes) : of(joint_attributes);
  if (traits.axis) result.push_back(axis_attribute);
  if (traits.second_axis) result.push_back(second_axis_attribute);
  if (const joint::Parameter& p = traits.parameter; p.name[0] != '\0')
    result.push_back({p.name, Kind::number, p.unit, required, p.doc});
  return result;
}

const std::vector<Element>& table() {
  static const std::vector<Element> all = [] {
    std::vector<Element> list = {
        {"mbd", "", "A model. SI units, inertial axes i1 i2 i3.", of(mbd_attributes)},
        {"parameter", top,
         "A named number. Later expressions may use it; --set replaces its value.",
         of(parameter_attributes)},
        {"include", top,
         "Reads the elements of another model file here, as if they stood in this one. That file's "
         "name "
         "for its model is not used.",
         of(include_attributes)},
        {"defaults",
         top,
         "Elements with some of their attributes, no name and no content: what later elements of "
         "that "
         "kind have when they do not say otherwise.",
         {}},
        {"section", anywhere,
         "Stiffness and mass of a cross-section, axes b1 (along the beam) b2 b3.",
         of(section_attributes)},
        {"station", "section repeat defaults",
         "The section at one place of the beam; two or more, from 0 to 1, in order.",
         of(station_attributes)},
        {"stiffness", "section station defaults",
         "D, from strains [stretch, shears; twist, curvatures] to [N1 Q2 Q3; M1 M2 M3]: its "
         "entries by name, the first six at least, or all of them row by row.",
         of(stiffness_attributes), "36 numbers"},
        {"mass", "section station defaults",
         "M per length about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).",
         of(mass_attributes)},
        {"damping", "section defaults",
         "Resistance to rates of strain and to velocities, at least one kind, in a <transient>; "
         "without it a beam is elastic.",
         of(damping_attributes)},
        {"beam", anywhere, "A straight beam.", of(beam_attributes, mesh_attributes)},
        {"arc", anywhere, "A beam along a circular arc: `from`, turned about the centre.",
         of(arc_attributes, mesh_attributes)},
        {"curve", anywhere, "A beam along a smooth curve through points.",
         of(curve_attributes, mesh_attributes)},
        {"point", "curve repeat defaults", "A point of a curve.", of(point_attributes)},
        {"body", anywhere, "A rigid body, free or fixed to a place.", of(body_attributes)},
        {"drive", anywhere, "Prescribes the angle or the displacement of a joint.",
         of(drive_attributes)},
        {"motion", anywhere, "Prescribes the motion of a place; what is not given is free.",
         of(motion_attributes)},
        {"load", anywhere, "A force and moment at a place.", of(load_attributes)},
        {"distributed", anywhere,
         "Forces and moments per unit of reference length along a beam; expressions of s, the "
         "fraction "
         "of that length, and t.",
         of(distributed_attributes)},
        {"rigid", anywhere,
         "Makes one rigid body of beams and free bodies: one node with the mass of them all. "
         "Places of "
         "its beams stay places; joints between two of them do nothing.",
         of(rigid_attributes)},
        {"point_mass", anywhere, "A mass without inertia of its own that moves with a place.",
         of(point_mass_attributes)},
        {"spring", anywhere,
         "A spring, a damper or both along the line between two points of two places.",
         of(spring_attributes)},
        {"bushing", anywhere,
         "An elastic connection of two frames, which coincide in the reference configuration, in "
         "all six directions.",
         of(bushing_attributes)},
        {"matrix", "bushing",
         "Its stiffness or damping, symmetric, in place of the attributes: row by row, "
         "displacements before rotations, in SI units.",
         of(matrix_attributes), "36 numbers"},
        {"law", "bushing",
         "What one component of its motion adds to the stiffness: an expression, or a table of x "
         "and force in turn, in SI units, x rising.",
         of(law_attributes), "pairs of numbers"},
        {"joint_spring", anywhere,
         "A spring, a damper or both on the free coordinate of a joint: its angle, over any number "
         "of turns, or its displacement.",
         of(joint_spring_attributes)},
        {"joint_torque", anywhere,
         "A moment about or a force along the axis of a joint, of time; the joint turns freely.",
         of(joint_torque_attributes)},
        {"table", "spring joint_spring",
         "A law in place of an expression: x and force (or v and force) in turn, in SI units, x "
         "rising.",
         of(table_attributes), "pairs of numbers"},
        {"drag", anywhere,
         "Quadratic drag of a fluid, still or flowing, along a beam or at a place.",
         of(drag_attributes)},
        {"added_mass", anywhere,
         "Inertia of a fluid that a beam or a body sets in motion: of a fluid at rest, without its "
         "weight.",
         of(added_mass_attributes)},
        {"base_motion", once,
         "Accelerates the ground without turning it; everything else is relative to the ground.",
         of(base_motion_attributes)},
        {"gravity", once, "Uniform gravity on everything that has mass.", of(gravity_attributes)},
        {"static", once, "Static equilibrium at t = 0, before the transient if there is one.",
         of(static_attributes)},
        {"path", once,
         "Follows the equilibria over the load factor, from 0, through limit points and "
         "bifurcations; instead of <static> and <transient>.",
         of(path_attributes)},
        {"mark", "path repeat defaults",
         "A point of the path to be located, shown and drawn: where a column passes a value.",
         of(mark_attributes)},
        {"stop", "path repeat defaults", "A mark at which the path ends.", of(mark_attributes)},
        {"transient", once,
         "Integration in time, in fixed steps or in steps that follow an estimated error.",
         of(transient_attributes)},
        {"record", anywhere, "Columns of history.csv.", of(record_attributes)},
        {"plot", anywhere, "A panel of history.svg.", of(plot_attributes)},
        {"expect", anywhere, "A number the run must give.", of(expect_attributes)},
        {"repeat", "mbd repeat curve section", "Reads its contents several times.",
         of(repeat_attributes)},
    };
    for (const JointKind& kind : joints())
      list.push_back({kind.name, anywhere, kind.doc, of(kind)});
    return list;
  }();
  return all;
}

template <class Range>
auto find(const Range& range, std::string_view name) {
  const auto it = std::find_if(std::begin(range), std::end(range),
                               [&](const auto& entry) { return entry.name == name; });
  return it == std::end(range) ? nullptr : &*it;
}

template <class Range>
std::vector<std::string_view> names_of(const Range& range) {
  std::vector<std::string_view> result;
  for (const auto& entry : range) result.push_back(entry.name);
  return result;
}

}  // namespace

std::span<const Element> elements() { return table(); }
std::span<const JointKind> joint_kinds() { return joints(); }
std::span<const Quantity> place_quantities() { return of_places; }
std::span<const Quantity> joint_quantities() { return of_joints; }
std::span<const Quantity> spring_quantities() { return of_springs; }
std::span<const Quantity> system_quantities() { return of_system; }

const Element* find_element(std::string_view name) { return find(table(), name); }
const Attribute* find_attribute(const Element& element, std::string_view name) {
  return find(element.attributes, name);
}
const JointKind* find_joint_kind(std::string_view name) { return find(joints(), name); }
const Quantity* find_quantity(std::span<const Quantity> quantities, std::string_view name) {
  return find(quantities, name);
}

std::vector<std::string_view> children(std::string_view parent) {
  std::vector<std::string_view> result;
  for (const Element& element : table()) {
    const std::vector<std::string_view> parents = words(element.parents);
    if (std::find(parents.begin(), parents.end(), parent) != parents.end())
      result.push_back(element.name);
  }
  return result;
}

std::vector<std::string_view> attribute_names(const Element& element) {
  return names_of(element.attributes);
}
std::vector<std::string_view> names(std::span<const Quantity> quantities) {
  return names_of(quantities);
}

std::vector<std::string_view> words(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\f\v";
  std::vector<std::string_view> result;
  for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
    result.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(blanks, end);
  }
  return result;
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string fault(const Attribute& attribute, double value) {
  const Range& range = attribute.range;
  const std::string is = "is " + shortest(value) + ", must ";
  if (!std::isfinite(value)) return is + "be a finite number";
  const bool inside = range.open ? value > range.min && value < range.max
                                 : value >= range.min && value <= range.max;
  if (inside) return {};
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above)
    return is + "lie between " + shortest(range.min) + " and " + shortest(range.max);
  if (below && range.min == 0.0) return is + (range.open ? "be positive" : "not be negative");
  return is + (range.open ? "be greater than " : "be at least ") + shortest(range.min);
}

std::string missing(const Attribute& attribute) {
  const bool has_unit = attribute.unit != pure_number && attribute.unit != any_unit;
  return "attribute \"" + std::string(attribute.name) +
         "\" is missing: " + std::string(attribute.doc) +
         (has_unit ? " [" + std::string(attribute.unit) + "]" : "");
}

bool is_of_one_item(const Attribute& a) {
  return a.kind == Kind::name || a.kind == Kind::place || a.kind == Kind::places ||
         (a.kind == Kind::numbers && a.unit == "m");
}

std::string unknown_attribute(const Element& element, std::string_view name) {
  return "unknown attribute \"" + excerpt(name) + "\"" +
         suggest(name, attribute_names(element),
                 "attributes of <" + std::string(element.name) + ">");
}

std::string_view usual_word(std::string_view word) {
  struct Usual {
    std::string_view word, instead;
  };
  static constexpr Usual table[] = {
      {"clamp", "write <fixed between=\"ground beam.start\" …/>"},
      {"weld", "write <fixed …/>"},
      {"hinge", "write <revolute axis=… …/>"},
      {"pin", "write <revolute axis=… …/>, or <spherical …/> for a ball"},
      {"ball", "write <spherical …/>"},
      {"slider", "write <prismatic axis=… …/>"},
      {"roller", "write <point_on_line axis=… …/>: free along the line, free to turn"},
      {"rope", "write <distance …/>, which holds a length also in pressure, or a slender <beam>"},
      {"cable", "write <distance …/>, which holds a length also in pressure, or a slender <beam>"},
      {"damper", "write <spring damping=… …/>, with or without a stiffness"},
      {"dashpot", "write <spring damping=… …/>, with or without a stiffness"},
      {"shaker", "write <base_motion acceleration=…/>, or <motion of=… displacement=…/>"},
      {"contact", "this version has no contact; leave it out"},
      {"force", "write <load at=… force=\"…\"/>"},
      {"moment", "write <load at=… moment=\"…\"/>"},
      {"material", "write <section> with <stiffness EA=… …/> and <mass per_length=… …/>"},
      {"deflection", "write displacement"},
      {"torque",
       "write moment (of a beam) or reaction_moment (of a joint); what turns a joint is "
       "<joint_torque …/>"},
      {"reaction", "write reaction_force and reaction_moment"},
      {"stress", "this version has resultants, force and moment; stress follows from the section"},
      {"strain", "this version has resultants, force and moment; strain follows from the section"},
  };
  for (const Usual& usual : table)
    if (usual.word == word) return usual.instead;
  return {};
}

bool is_name(std::string_view text) {
  constexpr std::size_t longest = 200;
  return !text.empty() && text.size() <= longest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-';
         });
}

}  // namespace mbd::schema
