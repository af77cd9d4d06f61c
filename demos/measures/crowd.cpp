#include "crowd.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include "run.h"

namespace measures {
namespace {

double deepest_contact(btDynamicsWorld* world) {
  double deepest = 0;
  const int count = world ? world->getDispatcher()->getNumManifolds() : 0;
  for (int i = 0; i < count; ++i) {
    const btPersistentManifold& contacts = *world->getDispatcher()->getManifoldByIndexInternal(i);
    for (int k = 0; k < contacts.getNumContacts(); ++k)
      deepest = std::max(deepest, -double(contacts.getContactPoint(k).getDistance()));
  }
  return deepest;
}

}  // namespace

CrowdResult run_crowd(const scenes::Scene& scene, engines::Engine& engine, double dt) {
  CrowdResult result;
  const auto probe = [&](const engines::State& body) -> scenes::Vector3d {
    return body.pose * scene.probe;
  };
  scenes::Vector3d last = probe(engine.state(scene.probe_body));
  double penetration = 0;
  const Outcome outcome =
      run(scene, engine, dt, [&](double, const std::vector<engines::State>& states) {
        penetration += deepest_contact(engine.bullet_world());
        const scenes::Vector3d now = probe(states[size_t(scene.probe_body)]);
        result.travel += (now - last).norm();
        last = now;
      });
  result.mean_gap = outcome[Error::gap];
  result.max_gap = outcome.max_gap;
  result.mean_penetration = penetration / outcome.steps;
  result.lowest = HUGE_VAL;
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].mass == 0) continue;
    result.end_kinetic += kinetic_energy(scene.bodies[i], outcome.end[i]);
    result.lowest = std::min(result.lowest, outcome.end[i].pose.translation().z());
  }
  result.finite = outcome.finite;
  result.joints = int(scene.joints.size());
  result.microseconds_per_step = 1e6 * outcome.seconds / outcome.steps;
  return result;
}

}  // namespace measures
