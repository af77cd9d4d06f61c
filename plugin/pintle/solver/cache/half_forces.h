// Purpose: steps of second order (Verlet; Hairer, Lubich and Wanner, Geometric Numerical Integration, I.1.4): gravity acts half before and half
// after bodies move. What a user adds is known at the start of a step alone, and may depend on velocities: so it acts before, as in Bullet,
// and drag is as stable as there.
//
// Bullet's forces act before bodies move, and so its velocities are those of half a step before their poses. Where a body comes to move in halves it
// gets half a step of gravity, and gives it back where it comes to move as Bullet moves it: neither gives energy. Only if it still has the velocity
// that the last step left it.
#pragma once

#include <pintle/solver/model/island.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// How a body has moved in a step.
struct MotionOfBody {
  enum class Gravity { unknown, in_halves, whole } gravity = Gravity::unknown;
  Vector3d second_half = Vector3d::Zero();  ///< m/s
  Vector6d v = Vector6d::Zero();            ///< with which the step ended
  double dt = 0;                            ///< s
};

/// In the last step and in this one.
struct MotionsOfBody {
  MotionOfBody last, now;
  bool is_touched = false;  ///< something touches its island in this step
  long step = -1;

  /// `last`; unknown if the body has another velocity now, `v`, than that left it, and its damping for dt.
  const MotionOfBody& lastOf(const btRigidBody& body, const Vector6d& v, double dt);
};

/// Neither springs, of which the pull at the end of the step is not known, nor limits that rebound, of which it is not known when in it they do.
bool mayActInHalves(const Island& island, const Component& component);

/// With which a body that acts in halves ends that has gone its way with `way` and has turned: a rotor keeps its angular momentum, and the
/// second half of gravity acts.
Vector6d velocityAtEnd(const IslandBody& body, const Matrix3d& turn, const Vector6d& way);

/// Forces on the bodies of a component.
class HalfForces {
 public:
  /// With the forces of this step, which are whole in the island. `motionsOf(body)` must live longer.
  template <class MotionsOf>
  void begin(const Island& island, const Component& component, const MotionsOf& motionsOf) {
    m_bodies.clear();
    for (int i = 0; i < component.bodies; ++i)
      begin(island.bodies[size_t(component.first_body + i)], island.dt, motionsOf);
  }
  bool areTouched() const;
  /// The first half of gravity acts before bodies move, and the second one is body.by_forces_at_end.
  void split(Island& island, const Component& component);
  /// All of it acts before, as in Bullet.
  void join(Island& island, const Component& component);
  /// The step as it has ended, with these velocities of the component's bodies.
  void keep(const Island& island, const Component& component, const Vector6d* v);
  size_t bytes() const;

 private:
  struct Body {
    Vector6d v0, v_free, by_forces;
    double gyroscopic_work;
    Vector6d half;  ///< of gravity, m/s
    MotionsOfBody* motions;
  };
  template <class MotionsOf>
  void begin(const IslandBody& body, double dt, const MotionsOf& motionsOf) {
    Vector6d half = Vector6d::Zero();
    // (Bodies that are added or woken within a step, or whose forces are cleared, are not pulled in it.)
    if (!body.body->getTotalForce().isZero())
      half.head<3>() = dt / 2 * inDouble(body.body->getGravity() * body.body->getLinearFactor());
    MotionsOfBody& motions = motionsOf(*body.body);
    motions.lastOf(*body.body, body.v0, dt);
    m_bodies.push_back(
        {body.v0, body.v_free, body.by_forces, body.gyroscopic_work, half, &motions});
  }
  std::vector<Body> m_bodies;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
