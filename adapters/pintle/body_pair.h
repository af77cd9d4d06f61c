// Purpose: Bullet's two bodies of a joint in the document's symbols (1.2): x and R, which are all that a joint's rows
// depend on, and v, w, m^-1, I^-1. Everything is world space and SI. Nothing is copied: the accessors are Eigen views
// of Bullet's own numbers, so that a joint pays for what it reads.
#pragma once

#include <pintle/finite.h>
#include <pintle/vectors.h>

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using VectorView = Eigen::Map<const Vec3>;
using MatrixView = Eigen::Map<const Eigen::Matrix<Scalar, 3, 3, Eigen::RowMajor>, Eigen::Unaligned,
                              Eigen::OuterStride<sizeof(btVector3) / sizeof(btScalar)>>;

inline VectorView view(const btVector3& v) { return VectorView(static_cast<const btScalar*>(v)); }
inline MatrixView view(const btMatrix3x3& m) {
  return MatrixView(static_cast<const btScalar*>(m[0]));
}

/// The fourth lane is what Bullet pads with: anything.
inline LanesView lanes(const btVector3& v) { return LanesView(static_cast<const btScalar*>(v)); }

inline void setLanes(btVector3& v, const Lanes& to) {
  Eigen::Map<Lanes, Eigen::Unaligned>(static_cast<btScalar*>(v)) = to;
}

/// The velocity of a body at the end of a step in which only its forces act.
inline Vec3 freeLinear(const btRigidBody& body, Scalar dt) {
  return view(body.getLinearVelocity()) +
         dt * body.getInvMass() *
             view(body.getTotalForce()).cwiseProduct(view(body.getLinearFactor()));
}
inline Vec3 freeAngular(const btRigidBody& body, Scalar dt) {
  return view(body.getAngularVelocity()) +
         dt * (view(body.getInvInertiaTensorWorld()) * view(body.getTotalTorque()))
                  .cwiseProduct(view(body.getAngularFactor()));
}

/// Where two bodies are. Keep the poses alive as long as the pair.
class PosePair {
 public:
  PosePair(const btTransform& pose_a, const btTransform& pose_b)
      : m_pose_a(pose_a), m_pose_b(pose_b) {}

  VectorView x_a() const { return view(m_pose_a.getOrigin()); }
  VectorView x_b() const { return view(m_pose_b.getOrigin()); }
  MatrixView R_a() const { return view(m_pose_a.getBasis()); }
  MatrixView R_b() const { return view(m_pose_b.getBasis()); }
  const btTransform& pose_a() const { return m_pose_a; }
  const btTransform& pose_b() const { return m_pose_b; }

  static bool is_finite(Scalar s) { return isFinite(s); }

 private:
  const btTransform& m_pose_a;
  const btTransform& m_pose_b;
};

/// Two bodies, with what they move by.
class BodyPair : public PosePair {
 public:
  /// The bodies where they are.
  BodyPair(const btRigidBody& a, const btRigidBody& b)
      : BodyPair(a, a.getCenterOfMassTransform(), b, b.getCenterOfMassTransform()) {}
  /// The bodies as they would be at other poses.
  BodyPair(const btRigidBody& a, const btTransform& pose_a, const btRigidBody& b,
           const btTransform& pose_b)
      : PosePair(pose_a, pose_b), m_a(a), m_b(b) {}

  VectorView v_a() const { return view(m_a.getLinearVelocity()); }
  VectorView v_b() const { return view(m_b.getLinearVelocity()); }
  VectorView w_a() const { return view(m_a.getAngularVelocity()); }
  VectorView w_b() const { return view(m_b.getAngularVelocity()); }
  Scalar inv_mass_a() const { return m_a.getInvMass(); }
  Scalar inv_mass_b() const { return m_b.getInvMass(); }
  MatrixView inv_inertia_a() const { return view(m_a.getInvInertiaTensorWorld()); }
  MatrixView inv_inertia_b() const { return view(m_b.getInvInertiaTensorWorld()); }

  const btRigidBody& a() const { return m_a; }
  const btRigidBody& b() const { return m_b; }
  /// Whether the poses are the bodies' own, to which their velocities belong.
  bool inPlace() const { return &pose_a() == &m_a.getCenterOfMassTransform(); }

  /// False if a velocity, a force or a mass of either body holds NaN or infinity. (Poses need no check: NaN in one
  /// shows in every row.)
  bool finite() const {
    // A sum is finite only if its terms are, and costs less than looking at each.
    const Lanes sum = lanes(m_a.getLinearVelocity()) + lanes(m_b.getLinearVelocity()) +
                      lanes(m_a.getAngularVelocity()) + lanes(m_b.getAngularVelocity()) +
                      lanes(m_a.getTotalForce()) + lanes(m_b.getTotalForce()) +
                      lanes(m_a.getTotalTorque()) + lanes(m_b.getTotalTorque());
    return is_finite(sum[0] + sum[1] + sum[2] + m_a.getInvMass() + m_b.getInvMass());
  }

 private:
  const btRigidBody& m_a;
  const btRigidBody& m_b;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
