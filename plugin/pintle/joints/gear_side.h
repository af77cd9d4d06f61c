// Purpose: one of the two coordinates of a gear: where it is at a pose, how far it has come, over any number of revolutions, and how its
// bodies move it. For the .cpp files of gears and of the exact solver only.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/joints/gear_coordinate.h>

#include <optional>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Where the bodies of a gear are: those of its own at given poses, others where they are.
struct GearPoses {
  const btRigidBody &a, &b;
  const PosePair& of;

  const btTransform& operator[](const btRigidBody& body) const {
    return &body == &a ? of.pose_a() : &body == &b ? of.pose_b() : body.getCenterOfMassTransform();
  }
};

/// A coordinate at a pose.
struct GearReading {
  Vec3 L, A_a, A_b;  ///< its velocity is L.(v_b - v_a) - A_a.w_a + A_b.w_b
  double rest = 0;   ///< rad, within a revolution, or m: before its sign or the length of its axis
  Vector3<double> n, x;  ///< of the rotation of one body (equations/gear.h)

  bool isFinite() const { return pintle::isFinite(rest + double(L.sum() + A_a.sum() + A_b.sum())); }
};

class GearSide {
 public:
  /// The rotation of a body of the gear's, as Bullet's gear has it. Its axis comes later.
  explicit GearSide(const btRigidBody& body) : m_a(nullptr), m_b(&body) {}

  /// Another coordinate, as long as Bullet's object has this axis.
  void name(const GearCoordinate& coordinate, const btVector3& axis, const GearPoses& at);
  /// True if Bullet's object has the axis that it had last.
  bool hasAxis(const btVector3& axis) const;
  /// The rotation of `body`, one of the gear's, about an axis in its frame (finite, of any length), counted from here on.
  void takeAxis(const btVector3& axis, const btRigidBody& body, const GearPoses& at);

  GearReading read(const GearPoses& at) const;
  /// The change of the coordinate since it was followed last (rad or m): the nearest, as of a pose alone.
  double nearestChange(const GearReading& now) const { return change(now, 0); }
  /// How a step of dt has changed it.
  struct Change {
    double size;  ///< rad or m
    /// By its owner: it differs by too much from what velocities have made of it.
    bool is_put_elsewhere;
  };
  Change changeInStep(const GearReading& now, Scalar dt) const;
  void follow(const GearReading& now, double change);

  /// rad or m.
  double value() const { return double(m_factor) * (2 * pi * m_turns + m_rest); }
  Scalar factor() const { return m_factor; }
  bool isPosition() const { return m_named && m_named->m_is_position; }
  /// Null if it is the rotation of body b alone.
  const btRigidBody* bodyA() const { return m_a; }
  const btRigidBody& bodyB() const { return *m_b; }
  ///@{
  /// In the world: a point of its axis, and the axis, a unit vector.
  btVector3 place() const;
  btVector3 axis() const;
  ///@}

 private:
  void begin(const GearPoses& at);
  GearReading readAngle(const GearPoses& at) const;
  GearReading readPosition(const GearPoses& at) const;
  GearReading readRotation(const GearPoses& at) const;
  double change(const GearReading& now, double expected) const;
  bool turnsFar(Scalar dt) const;
  double expectedChange(const GearReading& now, Scalar dt) const;

  const btRigidBody *m_a, *m_b;
  std::optional<GearCoordinate> m_named;
  btVector3 m_axis = {0, 0, 0};  ///< as Bullet's object has it, in the frame of a body
  bool m_has_axis = false;       ///< one was given
  Scalar m_factor = 0;           ///< of the coordinate: a sign, or the length of the axis
  double m_turns = 0, m_rest = 0;
  // Directions n and v of the rotation of one body: in its frame, and n and x in the world where it was followed last.
  Vector3<double> m_n_in_b = Vector3<double>::Zero(), m_v_in_b = Vector3<double>::Zero();
  Vector3<double> m_n = Vector3<double>::Zero(), m_x = Vector3<double>::Zero();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
