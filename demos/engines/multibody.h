// Bullet's reduced coordinates: btMultiBody.

#pragma once

#include "engine.h"

namespace engines {

// Null: the scene is no tree of free hinges, balls and sliders on the ground.
std::unique_ptr<Engine> make_multibody(const scenes::Scene& scene);

}  // namespace engines
