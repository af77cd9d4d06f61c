// Purpose: the settings of a pose drive: a spring and damper that turns two bodies to a pose of each other, as an active ragdoll's muscles do.
#pragma once

#include <pintle/rows/axis_settings.h>

#include <LinearMath/btVector3.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A spring and damper between the rotation of b in a and its target. The torque on b (N m) is
///   -stiffness phi - damping (w - target_velocity),
/// phi the rotation vector from the target to b (rad, the shorter way round), and w the angular velocity of b against a; both are those at
/// the end of the step (implicit Euler), so that any stiffness is stable at any step. The torque at rest is exactly stiffness times phi.
struct PoseDrive {
  /// Frequency (Hz, > 0) and damping ratio (>= 0) with which the two bodies alone would swing, about each axis by the inertia that the joint
  /// leaves them about it in this step. `max_torque`: N m, >= 0.
  static PoseDrive fromFrequency(btScalar frequency_hz, btScalar damping_ratio,
                                 btScalar max_torque = infinity) {
    PoseDrive drive;
    drive.spring = {SIMD_2_PI * frequency_hz, damping_ratio};
    drive.max_torque = max_torque;
    return drive;
  }
  /// Stiffness (N m/rad, >= 0) and damping (N m s/rad, >= 0), not both 0. `max_torque`: N m, >= 0.
  static PoseDrive fromStiffness(btScalar n_m_per_rad, btScalar n_m_s_per_rad,
                                 btScalar max_torque = infinity) {
    PoseDrive drive;
    drive.spring.stiffness = n_m_per_rad;
    drive.spring.damping = n_m_s_per_rad;
    drive.max_torque = max_torque;
    return drive;
  }

  Spring spring;                   ///< one of the two functions above sets it
  btScalar max_torque = infinity;  ///< N m: the length of the torque is never more than that
  /// rad/s, of the target against a, along the axes of frame a. With it and with the target that is due at the end of each step a moving
  /// target is followed without lag. The target itself stays where it was set.
  btVector3 target_velocity = {0, 0, 0};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
