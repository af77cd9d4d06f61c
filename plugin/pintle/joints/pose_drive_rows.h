// Purpose: the rows of a pose drive: three springs about axes at right angles.
//   C_i = phi.u_i,   J_b = u_i,   J_a = -J_b
// phi is the rotation vector from the target, as a carries it, to b (equations::orientation_error), rad, world. Its potential
// k |phi|^2 / 2 has the gradient k phi with unit rows u_i: the exact Jacobian of phi leaves phi as it is. Any three unit vectors at right
// angles make the same torque. These are the principal axes of K, the inverse inertia that the equalities of the joint leave, so that no
// spring moves the coordinate of another; of axes about which they leave nothing there are no rows.
//
// A bound of the torque's length T is one of each row that, together, make a box within the sphere. Its longest edge lies along the torque
// that is expected, and its length is half way from that to T, max_part_along of T at most; the others have what that leaves. (Of a joint that
// leaves one axis the bound is T.)
#pragma once

#include <pintle/body_pair.h>
#include <pintle/frame.h>
#include <pintle/joints/pose_drive.h>
#include <pintle/rows/row.h>

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btQuaternion.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rows of a pose drive, with its settings.
class PoseDriveRows {
 public:
  static constexpr int count = 3;  ///< the most that it has

  /// The target is unit.
  void set(const btQuaternion& target, const PoseDrive& settings);
  void clear() { m_is_on = false; }                         ///< There are none.
  bool isOn() const { return m_is_on; }                     ///< True from set to clear.
  const btQuaternion& target() const { return m_target; }   ///< as set
  const PoseDrive& settings() const { return m_settings; }  ///< as set

  /// Another step: the next rows choose axes and bounds for it.
  void begin() { m_step_begins = true; }
  /// Adds rows about the axes of this step, `first_axis` being the first of their numbers. `pair`: the bodies at the start of the step.
  /// Returns how far (rad) they may turn the bodies.
  Scalar add(const Frame& a, const Frame& b, int first_axis, const BodyPair& pair, Scalar dt,
             Scalar friction, Rows& rows);
  /// N m s, on b, in the world, of the impulses about the axes of the last step.
  Vec3 sum(const Vec3& impulses) const { return m_u * impulses; }

 private:
  Vec3 error(const Frame& a, const Frame& b) const;
  void choose(const Vec3& phi, const Vec3& target_velocity, const Frame& b, int first_axis,
              const BodyPair& pair, Scalar dt, Rows& rows);
  void boundLength(const Vec3& expected, int free, Scalar dt);

  PoseDrive m_settings;
  btQuaternion m_target = btQuaternion::getIdentity();
  btMatrix3x3 m_R = btMatrix3x3::getIdentity();  ///< the target
  Axis m_axis[count];
  Mat3 m_principal = Mat3::Identity();  ///< axes of K in frame b, as columns
  Mat3 m_u = Mat3::Identity();          ///< axes of the rows in the world, as columns
  // At the start of the step: the axes of frame a, those of b in it, and phi.
  Mat3 m_start_a = Mat3::Identity(), m_start = Mat3::Identity();
  Vec3 m_start_error = Vec3::Zero();
  bool m_acts[count] = {true, true, true};
  bool m_is_on = false, m_step_begins = true;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
