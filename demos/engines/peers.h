// Other physics engines, if they were found at configuration (PINTLE_PEERS). Both compute in double.

#pragma once

#include "engine.h"

namespace engines {

// Null: the engine has no joint of some kind that the scene has, or the scene has contacts.
std::unique_ptr<Engine> make_ode(const scenes::Scene& scene, int iterations);
std::unique_ptr<Engine> make_mujoco(const scenes::Scene& scene, int iterations);

}  // namespace engines
