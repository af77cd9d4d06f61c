// Bullet's own examples without a window, on the solver that solver.h says.
//   program            prints the names of the scenes
//   program SCENE      prints "row: joints gap gap_max passed energy us" of 600 steps of 1/60 s: the most joints that there
//                                are; how far their pivots are apart, the mean of all and the largest (m); how far they are beyond a
//                                limit (m or rad, the largest); by how much the energy rises above that of the start (J); the CPU time of
//                                a step (us). "not finite", if a number is not.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>

#include "../headless.h"
#include "joint_errors.h"

CommonExampleInterface* Dof6Spring2CreateFunc(CommonExampleOptions&);

namespace examples {
namespace {

constexpr int steps = 600;

const headless::Scene of_six_dof = {"6dof_spring_2", Dof6Spring2CreateFunc, 0};

template <class Visit>
void eachScene(Visit visit) {
  for (const headless::Scene& scene : headless::scenes) visit(scene);
  visit(of_six_dof);
}

/// J: kinetic and potential, of all rigid bodies that move.
double energyOf(btDiscreteDynamicsWorld& world) {
  double sum = 0;
  for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
    const btRigidBody* const body = btRigidBody::upcast(world.getCollisionObjectArray()[i]);
    if (body == nullptr || !(body->getInvMass() > 0)) continue;
    const btMatrix3x3& R = body->getCenterOfMassTransform().getBasis();
    const btVector3 w = R.transpose() * body->getAngularVelocity(), I = body->getLocalInertia();
    const double mass = 1 / double(body->getInvMass());
    sum += double(w.dot(I * w)) / 2 +
           mass * (double(body->getLinearVelocity().length2()) / 2 -
                   double(body->getGravity().dot(body->getCenterOfMassPosition())));
  }
  return sum;
}

void run(const headless::Scene& scene) {
  headless::WorldCatcher helper;
  CommonExampleOptions options(&helper, scene.option);
  CommonExampleInterface* const example = scene.create(options);
  example->initPhysics();
  btDiscreteDynamicsWorld& world = *helper.world;
  const double start = energyOf(world);
  double gap = 0, largest = 0, passed = 0, rise = 0, seconds = 0;
  long count = 0;
  int joints = 0;
  for (int step = 0; step < steps; ++step) {
    const std::clock_t before = std::clock();
    example->stepSimulation(float(1) / 60);
    seconds += double(std::clock() - before) / CLOCKS_PER_SEC;
    joints = std::max(joints, world.getNumConstraints());
    for (int i = 0; i < world.getNumConstraints(); ++i) {
      btTypedConstraint& joint = *world.getConstraint(i);
      if (!joint.isEnabled()) continue;
      const JointErrors errors = errorsOf(joint);
      gap += errors.gap;
      ++count;
      largest = std::max(largest, errors.gap);
      passed = std::max(passed, errors.passed);
    }
    const double energy = energyOf(world);
    rise = std::max(rise, energy - start);
    if (!std::isfinite(energy) || !std::isfinite(gap)) {
      std::printf("row: %d not finite in step %d\n", joints, step);
      return;
    }
  }
  std::printf("row: %d %.2e %.2e %.2e %.3g %.0f\n", joints, count > 0 ? gap / double(count) : 0,
              largest, passed, rise, 1e6 * seconds / steps);
}

}  // namespace
}  // namespace examples

int main(int argc, char** argv) {
  if (argc < 2) {
    examples::eachScene([](const headless::Scene& scene) { std::printf("%s\n", scene.name); });
    return 0;
  }
  examples::eachScene([&](const headless::Scene& scene) {
    if (std::strcmp(scene.name, argv[1]) == 0) examples::run(scene);
  });
}
