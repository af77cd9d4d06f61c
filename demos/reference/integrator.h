// Solves a scene by another method than any contender's: accelerations from the constraints'
// second derivatives, integrated by the classical Runge-Kutta method, projected back onto the
// constraints after each step. Shares no equation with the joints: gradients and curvatures come
// from Taylor arithmetic on the definitions of the joints.

#pragma once

#include <vector>

#include "../scenes/scene.h"

namespace reference {

struct Solution {
  std::vector<scenes::Vector3d> probe;  // every `interval`, up to the horizon
  double energy_change = 0;             // J, the largest: how well it is converged
  double gap = 0;                       // m or rad, the largest violation of a constraint
};

// Smooth scenes only: balls, hinges, sliders and fixed joints, springs, no limits, motors,
// contacts or damping. Throws std::invalid_argument for others.
Solution solve(const scenes::Scene& scene, double dt, double interval);

}  // namespace reference
