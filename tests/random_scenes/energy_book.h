// The mechanical energy of a scene, step by step: what its joints and contacts give.
//
// Bullet's free fall keeps KE + m g (z - dt v_z / 2), so a weight works along the mean of the velocities before and after a step,
// and what a pose is moved by beside its velocity is height. A body that turns about its own velocity keeps it in Bullet, and its kinetic energy;
// where its pose is turned beside that, its inertia there counts.
//
// That is m (v_z - g dt / 2)^2 / 2 + m g z - m (g dt)^2 / 8: Bullet's velocities are those of half a step before their poses. What is held has
// no such fall. So who stops a body that rises by g dt / 2 seems to give it m (g dt)^2 / 8, which is not counted.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace random_scenes {

/// J, above the start.
class EnergyBook {
 public:
  using Bodies = std::vector<std::unique_ptr<btRigidBody>>;

  EnergyBook(const Bodies& bodies, double dt);
  void beginStep();
  void endStep();

  double weight() const;  ///< N, of all

  double by_velocities = 0;  ///< kinetic energy, and the work against the weight along velocities
  double height = 0;         ///< the work against the weight by moving poses
  double total() const { return by_velocities + height; }
  double kinetic = 0;  ///< at the end of the step
  double peak = 0;     ///< the largest kinetic energy
  double jump = 0;     ///< m: the most that a body was moved in the step beside its velocity

 private:
  struct Start {
    btTransform pose;
    double energy;
    double fall;  ///< m/s
  };
  const Bodies& m_bodies;
  double m_dt;
  std::vector<Start> m_start;
};

}  // namespace random_scenes
