// The chain of tools/peers in DART: joint coordinates, articulated bodies, semi-implicit Euler in fixed steps.
// Usage: dart chain N STEP DURATION; prints the recorded point at eleven instants, "t x y z" a line.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <dart/dart.hpp>

using namespace dart::dynamics;

int main(int count, char** words) {
  if (count != 5 || std::string(words[1]) != "chain") return 2;
  const int n = std::atoi(words[2]);
  const double step = std::atof(words[3]), duration = std::atof(words[4]);
  // Rods of 0.1 m and 0.1 kg on ball joints, at rest along x (models/chain.xml). A body's frame is at its inner end.
  const double l = 0.1, m = 0.1, across = m * l * l / 12;
  const SkeletonPtr skeleton = Skeleton::create("chain");
  BodyNode *last = nullptr, *tenth = nullptr;
  for (int i = 0; i < n; ++i) {
    BallJoint::Properties joint;
    joint.mName = "joint" + std::to_string(i);
    if (i > 0) joint.mT_ParentBodyToJoint.translation() = Eigen::Vector3d(l, 0, 0);
    BodyNode::Properties body;
    body.mName = "rod" + std::to_string(i);
    body.mInertia.setMass(m);
    body.mInertia.setLocalCOM(Eigen::Vector3d(l / 2, 0, 0));
    body.mInertia.setMoment(Eigen::Vector3d(1e-5, across, across).asDiagonal());
    last = skeleton->createJointAndBodyNodePair<BallJoint>(last, joint, body).second;
    if (i == 9) tenth = last;
  }
  const dart::simulation::WorldPtr world = dart::simulation::World::create();
  world->setGravity(Eigen::Vector3d(0, 0, -9.81));
  world->setTimeStep(step);
  world->addSkeleton(skeleton);
  const long steps = std::lround(duration / step);
  for (long k = 0; k <= steps; ++k) {
    if (k * 10 % steps == 0) {
      const Eigen::Vector3d x = tenth->getWorldTransform() * Eigen::Vector3d(l, 0, 0);
      std::printf("%.17g %.17g %.17g %.17g\n", static_cast<double>(k) * step, x[0], x[1], x[2]);
    }
    if (k < steps) world->step();
  }
}
