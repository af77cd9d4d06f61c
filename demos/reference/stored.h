// Solutions that are stored, because they take minutes: demos/reference/<scene>.csv.

#pragma once

#include <string>
#include <vector>

#include "../scenes/scene.h"

namespace reference {

// The first `samples` positions of the probe. Throws std::runtime_error if they are not there.
std::vector<scenes::Vector3d> stored(const std::string& scene, int samples);

// Solves the scene twice, in steps of dt and of half of it, and writes the better one with how it was
// made and by how much the two differ.
void store(const scenes::Scene& scene, double dt);

}  // namespace reference
