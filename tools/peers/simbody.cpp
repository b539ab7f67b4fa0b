// The scenes of tools/peers in Simbody: a tree of mobilizers in joint coordinates, recursive in time N; loops are closed by
// constraints. Usage: simbody SCENE N ACCURACY DURATION; prints the recorded point at eleven instants, "t x y z" a line.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include <Simbody.h>

using namespace SimTK;

namespace {

struct Point {
  MobilizedBodyIndex body;
  Vec3 at;  // in the body's axes [m]
};

// Rods of 0.1 m and 0.1 kg on ball joints, at rest along x (models/chain.xml). A body's frame is at its inner end.
Point chain(SimbodyMatterSubsystem& matter, int n) {
  const double l = 0.1, m = 0.1, across = m * l * l / 12;
  const Vec3 centre(l / 2, 0, 0);
  const Inertia inertia = Inertia(1e-5, across, across).shiftFromMassCenter(-centre, m);
  const Body::Rigid rod(MassProperties(m, centre, inertia));
  MobilizedBodyIndex last = matter.Ground().getMobilizedBodyIndex(), tenth = last;
  for (int i = 0; i < n; ++i) {
    last = MobilizedBody::Ball(matter.updMobilizedBody(last),
                               Transform(i == 0 ? Vec3(0) : Vec3(l, 0, 0)), rod, Transform())
               .getMobilizedBodyIndex();
    if (i == 9) tenth = last;
  }
  return {tenth, Vec3(l, 0, 0)};
}

// n windows of links of 1 m and 1 kg on hinges about z (models/windows.xml). Cranks and couplers are a tree, and each loop is
// closed in the plane of motion alone, so that nothing is held twice.
Point windows(SimbodyMatterSubsystem& matter, int n, std::vector<MobilizedBodyIndex>& cranks) {
  const double thin = 1e-5;
  const auto link = [&](const Vec3& centre, const Vec3& inertia) {
    return Body::Rigid(MassProperties(1, centre, Inertia(inertia).shiftFromMassCenter(-centre, 1)));
  };
  const Body::Rigid crank = link(Vec3(0, 0.5, 0), Vec3(1.0 / 12, thin, 1.0 / 12));
  const Body::Rigid coupler = link(Vec3(0.5, 0, 0), Vec3(thin, 1.0 / 12, 1.0 / 12));
  for (int i = 0; i <= n; ++i)
    cranks.push_back(
        MobilizedBody::Pin(matter.Ground(), Transform(Vec3(i, 0, 0)), crank, Transform())
            .getMobilizedBodyIndex());
  for (int i = 0; i < n; ++i) {
    MobilizedBody& left = matter.updMobilizedBody(cranks[static_cast<std::size_t>(i)]);
    MobilizedBody& right = matter.updMobilizedBody(cranks[static_cast<std::size_t>(i) + 1]);
    MobilizedBody::Pin bar(left, Transform(Vec3(0, 1, 0)), coupler, Transform());
    // Axes of the crank: it keeps the coupler's end at its own.
    Constraint::PointInPlane(right, UnitVec3(1, 0, 0), 0, bar, Vec3(1, 0, 0));
    Constraint::PointInPlane(right, UnitVec3(0, 1, 0), 1, bar, Vec3(1, 0, 0));
  }
  return {cranks.front(), Vec3(0, 1, 0)};
}

void run(const std::string& scene, int n, double accuracy, double duration) {
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  std::vector<MobilizedBodyIndex> cranks;
  const bool is_chain = scene == "chain";
  const Point point = is_chain ? chain(matter, n) : windows(matter, n, cranks);
  Force::Gravity(forces, matter, is_chain ? Vec3(0, 0, -9.81) : Vec3(0, -9.81, 0));
  State state = system.realizeTopology();
  system.realizeModel(state);
  if (!is_chain) {
    // Cranks turn by -1 rad/s from upright; couplers keep their direction.
    for (MobilizedBodyIndex body(1); body < matter.getNumBodies(); ++body)
      matter.getMobilizedBody(body).setOneU(state, 0, 1.0);
    for (const MobilizedBodyIndex crank : cranks)
      matter.getMobilizedBody(crank).setOneU(state, 0, -1.0);
  }
  RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(accuracy);
  TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  for (int k = 0; k <= 10; ++k) {
    stepper.stepTo(duration * k / 10);
    const State& now = integrator.getState();
    system.realize(now, Stage::Position);
    const Vec3 x = matter.getMobilizedBody(point.body).findStationLocationInGround(now, point.at);
    std::printf("%.17g %.17g %.17g %.17g\n", now.getTime(), x[0], x[1], x[2]);
  }
}

}  // namespace

int main(int count, char** words) {
  if (count != 5) return 2;
  try {
    run(words[1], std::atoi(words[2]), std::atof(words[3]), std::atof(words[4]));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "simbody: %s\n", e.what());
    return 1;
  }
}
