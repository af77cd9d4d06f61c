// Bullet's own examples without a window: how far the pivots of their joints are apart.
//   program SCENE    prints "gap: joints mean largest max" over 300 steps of 1/60 s: the joints with a counterpart, at
//                    the most, and how far their pivots are apart (m): the mean of all, the mean over the steps of the
//                    largest, and the largest of all; -1 if anything is not finite
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <vector>

#include "headless.h"

namespace {

constexpr int steps = 300;

using headless::Scene;
using headless::scenes;
using headless::WorldCatcher;

// m between the pivots in the two bodies; below 0: no joint of a type that has a counterpart.
double gap(btTypedConstraint& joint) {
  const btTransform& A = joint.getRigidBodyA().getCenterOfMassTransform();
  const btTransform& B = joint.getRigidBodyB().getCenterOfMassTransform();
  const auto apart = [&](const btVector3& in_a, const btVector3& in_b) {
    return double((A * in_a - B * in_b).length());
  };
  if (const auto* ball = dynamic_cast<btPoint2PointConstraint*>(&joint))
    return apart(ball->getPivotInA(), ball->getPivotInB());
  if (auto* hinge = dynamic_cast<btHingeConstraint*>(&joint))
    return hinge->getAngularOnly()
               ? -1
               : apart(hinge->getAFrame().getOrigin(), hinge->getBFrame().getOrigin());
  if (const auto* cone = dynamic_cast<btConeTwistConstraint*>(&joint))
    return apart(cone->getAFrame().getOrigin(), cone->getBFrame().getOrigin());
  if (const auto* universal = dynamic_cast<btUniversalConstraint*>(&joint))
    return apart(universal->getFrameOffsetA().getOrigin(),
                 universal->getFrameOffsetB().getOrigin());
  if (const auto* fixed = dynamic_cast<btFixedConstraint*>(&joint))
    return apart(fixed->getFrameOffsetA().getOrigin(), fixed->getFrameOffsetB().getOrigin());
  if (const auto* slider = dynamic_cast<btSliderConstraint*>(&joint)) {
    const btTransform a = A * slider->getFrameOffsetA(), b = B * slider->getFrameOffsetB();
    const btVector3 d = a.getBasis().transpose() * (b.getOrigin() - a.getOrigin());
    return double(btVector3(0, d.y(), d.z()).length());  // it slides along x
  }
  return -1;
}

int run(const Scene& scene) {
  WorldCatcher helper;
  CommonExampleOptions options(&helper, scene.option);
  CommonExampleInterface* const example = scene.create(options);
  example->initPhysics();
  if (helper.world == nullptr) {
    std::fprintf(stderr, "%s: no world\n", scene.name);
    return 1;
  }
  double sum = 0, sum_of_largest = 0, most = 0;
  long long count = 0;
  int most_joints = 0;
  for (int step = 0; step < steps; ++step) {
    example->stepSimulation(float(1) / 60);
    bool finite = true;
    int joints = 0;
    double largest = 0;
    for (int i = 0; i < helper.world->getNumConstraints(); ++i) {
      btTypedConstraint& joint = *helper.world->getConstraint(i);
      if (!joint.isEnabled()) continue;
      const double d = gap(joint);
      finite = finite && std::isfinite(d);
      if (d < 0) continue;
      sum += d;
      largest = d > largest ? d : largest;
      ++count;
      ++joints;
    }
    sum_of_largest += largest;
    most = largest > most ? largest : most;
    most_joints = joints > most_joints ? joints : most_joints;
    const btCollisionObjectArray& bodies = helper.world->getCollisionObjectArray();
    for (int i = 0; i < bodies.size(); ++i)
      finite = finite && std::isfinite(bodies[i]->getWorldTransform().getOrigin().length2());
    if (!finite) {
      std::printf("gap: %d -1 -1 -1\n", most_joints);
      return 0;
    }
  }
  std::printf("gap: %d %.3e %.3e %.3e\n", most_joints, count > 0 ? sum / double(count) : 0,
              sum_of_largest / steps, most);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // Examples print what they like.
  std::vector<const char*> names(argv + 1, argv + argc);
  if (names.empty()) {
    for (const Scene& scene : scenes) std::printf("%s\n", scene.name);
    return 0;
  }
  for (const Scene& scene : scenes) {
    if (std::strcmp(scene.name, names[0]) != 0) continue;
    try {
      return run(scene);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", scene.name, error.what());
      return 1;
    }
  }
  std::fprintf(stderr, "no scene %s\n", names[0]);
  return 1;
}
