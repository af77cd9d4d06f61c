// Solves a scene by another method than any contender's: accelerations from the constraints'
// second derivatives, integrated by the classical Runge-Kutta method, projected back onto the
// constraints after each step. Shares no equation with the joints: gradients and curvatures come
// from Taylor arithmetic on the definitions of the joints.

#pragma once

#include <memory>
#include <vector>

#include "../engines/engine.h"
#include "../scenes/scene.h"

namespace reference {

struct Solution {
  std::vector<scenes::Vector3d> probe;  // every `interval`, up to the horizon
  double energy_change = 0;             // J, the largest: how well it is converged
  double gap = 0;                       // m or rad, the largest violation of a constraint
};

// Smooth scenes only: balls, hinges, sliders and fixed joints, springs of sliders and distances, no
// limits, motors, contacts or damping. Throws std::invalid_argument for others.
Solution solve(const scenes::Scene& scene, double dt, double interval);

// Bullet's own steps with joints that leave nothing: velocities first and positions by them, the
// gyroscopic term and the turn of a body as Bullet has them, and impulses along the joints' rows at
// the start of the step with which the joints hold at its end. Springs pull by the start of the step,
// as forces do, or by its end where they are too stiff for that. The errors of such a run are those
// of the steps, and of no joint. Throws as `solve` does.
std::unique_ptr<engines::Engine> make_bullet_steps(const scenes::Scene& scene);

}  // namespace reference
