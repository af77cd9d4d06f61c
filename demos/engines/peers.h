// Other physics engines, if they were found at configuration (PINTLE_PEERS). Both compute in double.

#pragma once

#include <algorithm>

#include "engine.h"

namespace engines {

// What both leave out: contacts, Bullet's damping, and joints that they have none of.
inline bool is_known(const scenes::Scene& scene) {
  using scenes::Kind;
  return !scene.contacts() &&
         std::none_of(scene.joints.begin(), scene.joints.end(),
                      [](const scenes::Joint& joint) {
                        return joint.kind == Kind::cone_twist ||
                               joint.kind == Kind::constant_velocity || joint.kind == Kind::wedge;
                      }) &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(),
                      [](const scenes::Body& body) { return body.damping != 0; });
}

// Null: the scene is not known (is_known), or has a setting that the engine cannot express.
std::unique_ptr<Engine> make_ode(const scenes::Scene& scene, int iterations);
std::unique_ptr<Engine> make_mujoco(const scenes::Scene& scene, int iterations);

}  // namespace engines
