// A scene filled in C++: the four-bar mechanism of models/four_bar.xml, one hinge 5 degrees out of true, driven from rest.
//
// Build: see CMakeLists.txt beside this file. Run: four_bar
// Expect: at 2.997 s point C has left the plane by 1.02830 mm (the converged value of models/four_bar.xml). Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace {

// A hollow box of graphite and epoxy: it twists where it is stretched, and bends where it is sheared. `part`: of the thick one's
// stiffness and mass, which for torsion and bending is another.
mbd::Section box(const std::string& name, double EA, double GA, double GJ, double EI, double D14,
                 double D25, double per_length, double inertia) {
  mbd::Section s;
  s.name = name;
  s.stiffness.diagonal() << EA, GA, GA, GJ, EI, EI;
  s.stiffness(0, 3) = s.stiffness(3, 0) = D14;
  s.stiffness(1, 4) = s.stiffness(4, 1) = s.stiffness(2, 5) = s.stiffness(5, 2) = D25;
  s.mass.emplace(mbd::Mat6::Zero());
  s.mass->diagonal() << per_length, per_length, per_length, 2 * inertia, inertia, inertia;
  return s;
}

mbd::BeamScene bar(const std::string& name, const std::string& section, mbd::Vec3 from,
                   mbd::Vec3 to, int elements) {
  mbd::BeamScene b;
  b.name = name;
  b.section = section;
  b.line = mbd::Straight{from, to};
  b.normal = {0, 0, 1};
  b.elements = elements;
  return b;
}

const mbd::Place ground{};
mbd::Place start(const std::string& beam) { return {mbd::Place::Kind::beam, beam, 0.0}; }
mbd::Place end(const std::string& beam) { return {mbd::Place::Kind::beam, beam, 1.0}; }

mbd::JointScene hinge(const std::string& name, mbd::Place a, mbd::Place b, mbd::Vec3 axis) {
  mbd::JointScene j;
  j.kind = "revolute";
  j.name = name;
  j.a = a;
  j.b = b;
  j.axis = axis;
  return j;
}

mbd::Scene four_bar() {
  mbd::Scene scene;
  scene.name = "four_bar";
  scene.sections = {box("box16", 10660e3, 2532e3, 246.2, 309.1, -8676, 5013, 1.9968, 42.598e-6),
                    box("box8", 2665e3, 633e3, 15.39, 19.32, -1085, 626.6, 0.4992, 2.6624e-6)};
  scene.beams = {bar("bar1", "box16", {0, 0, 0}, {0, 0.12, 0}, 2),
                 bar("bar2", "box16", {0, 0.12, 0}, {0.24, 0.12, 0}, 4),
                 bar("bar3", "box8", {0.24, 0.12, 0}, {0.24, 0, 0}, 2)};
  const double tilt = 5 * std::numbers::pi / 180;
  scene.joints = {hinge("A", ground, start("bar1"), {0, 0, 1}),
                  hinge("B", end("bar1"), start("bar2"), {0, 0, 1}),
                  hinge("C", end("bar2"), start("bar3"), {std::sin(tilt), 0, std::cos(tilt)}),
                  hinge("D", end("bar3"), ground, {0, 0, 1})};
  mbd::DriveScene drive;
  drive.joint = "A";
  drive.rate =
      mbd::Expression::parse("t >= 6 ? 0.6 : 0.3*(1 - cos(pi*t/6))", {}, mbd::Variables::time);
  scene.drives = {drive};
  mbd::RecordScene record;
  record.name = "C";
  record.at = end("bar2");
  record.quantities = {"displacement"};
  scene.records = {record};
  scene.transient.emplace().duration = 36;
  scene.transient->step = 9e-3;
  scene.transient->rho_infinity = 0.0;
  return scene;
}

}  // namespace

int main() try {
  const mbd::Scene scene = four_bar();
  const mbd::Model model = mbd::compile(scene);
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  mbd::State state = model.initial;
  mbd::StepReport report = stepper->start(state);
  while (report.converged && state.t < 2.997 - 1e-9) report = stepper->step(state);
  if (!report.converged) throw mbd::Error(report.failure, report.kind);
  std::vector<double> y(mbd::ports(model).outputs.size());
  mbd::outputs(model, state, y);
  const double u3 = y[mbd::output_index(model, "C.displacement.3")];
  std::printf("t = %.3f s: C is %.5f mm out of the plane, after %ld iterations\n", state.t,
              1e3 * u3, stepper->counters().iterations);
  return std::abs(u3 - 1.0282952e-3) < 1e-6 * 4.3 ? 0 : 1;
} catch (const mbd::Error& error) {
  std::printf("%s (%s)\n", error.what(), std::string(mbd::name_of(error.kind())).c_str());
  return 2;
}
