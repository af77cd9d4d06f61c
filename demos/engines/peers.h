// Other physics engines, if they were found at configuration (PINTLE_PEERS). ODE and MuJoCo compute in double, Jolt in
// single.

#pragma once

#include <algorithm>

#include "engine.h"

namespace engines {

// What ODE and MuJoCo leave out: contacts, Bullet's damping, lasting torques, joints that start apart, limits that give,
// and joints that they have none of.
inline bool is_known(const scenes::Scene& scene) {
  using scenes::Kind;
  return !scene.contacts() && !scene.has(scenes::Error::recovery) &&
         std::none_of(scene.joints.begin(), scene.joints.end(),
                      [](const scenes::Joint& joint) {
                        const bool known =
                            joint.kind <= Kind::fixed || joint.kind == Kind::universal;
                        const bool gives = joint.kind == Kind::hinge && joint.spring.frequency > 0;
                        return !known || gives;
                      }) &&
         std::none_of(scene.bodies.begin() + 1, scene.bodies.end(), [](const scenes::Body& body) {
           const bool rests = !(body.mass > 0);  // beside the world itself
           return rests || body.damping != 0 || !body.torque.isZero();
         });
}

// kg: of its two bodies, one of which may rest.
inline double reduced_mass(const scenes::Scene& scene, const scenes::Joint& joint) {
  const auto inverse = [&](int body) {
    const double mass = scene.bodies[size_t(body)].mass;
    return mass > 0 ? 1 / mass : 0;
  };
  return 1 / (inverse(joint.a) + inverse(joint.b));
}

// Null: the scene has a joint or a setting that the engine cannot express.
std::unique_ptr<Engine> make_ode(const scenes::Scene& scene, int iterations);
std::unique_ptr<Engine> make_mujoco(const scenes::Scene& scene, int iterations);
std::unique_ptr<Engine> make_jolt(const scenes::Scene& scene, int iterations);

}  // namespace engines
