// Bullet's reduced coordinates: btMultiBody.

#pragma once

#include "engine.h"

namespace engines {

// Null: the scene is no tree of hinges, balls, sliders and fixed joints that hangs on the world, has contacts, or springs.
std::unique_ptr<Engine> make_multibody(const scenes::Scene& scene);

}  // namespace engines
