// Purpose: what Bullet's solver asks of a joint in one step, without the solver: two bodies of general
// orientation, the joint satisfied, one buildJacobian + getInfo1 + getInfo2 a call.
#pragma once

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstring>
#include <memory>

namespace bench {

class JointStep {
 public:
  JointStep() : m_shape(btVector3(btScalar(0.5), btScalar(0.1), btScalar(0.1))) {
    btTransform pose_a(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.7)),
                       btVector3(1, 2, 3));
    a = body(1, pose_a);
    // Turned against a by 0.4 about the joint's z axis, anchors together.
    const btTransform turn(btQuaternion(btVector3(0, 0, 1), btScalar(0.4)), btVector3(0, 0, 0));
    b = body(2, pose_a * frameA() * turn * frameB().inverse());
  }

  /// The joint frames: z is the axis; both general.
  static btTransform frameA() {
    return btTransform(btQuaternion(btVector3(2, 1, -1).normalized(), btScalar(0.5)),
                       btVector3(btScalar(0.5), btScalar(0.05), btScalar(-0.1)));
  }
  static btTransform frameB() {
    return btTransform(btQuaternion(btVector3(-1, 1, 2).normalized(), btScalar(-0.8)),
                       btVector3(btScalar(-0.5), btScalar(-0.02), btScalar(0.08)));
  }

  /// Turns b against a by 0.4 about z and then about y of a frame (world) that is common to both.
  void bend(const btTransform& frame) {
    const btQuaternion turn = btQuaternion(btVector3(0, 0, 1), btScalar(0.4)) *
                              btQuaternion(btVector3(0, 1, 0), btScalar(0.4));
    const btTransform bent = frame * btTransform(turn) * frame.inverse();
    b->setCenterOfMassTransform(bent * b->getCenterOfMassTransform());
    b->updateInertiaTensor();
  }

  /// Returns the number of rows.
  int run(btTypedConstraint& joint) {
    joint.buildJacobian();
    btTypedConstraint::btConstraintInfo1 info1;
    joint.getInfo1(&info1);
    btTypedConstraint::btConstraintInfo2 info2;
    info2.fps = 60;
    info2.erp = btScalar(0.2);
    info2.m_J1linearAxis = m_rows[0].m_contactNormal1;
    info2.m_J1angularAxis = m_rows[0].m_relpos1CrossNormal;
    info2.m_J2linearAxis = m_rows[0].m_contactNormal2;
    info2.m_J2angularAxis = m_rows[0].m_relpos2CrossNormal;
    info2.rowskip = sizeof(btSolverConstraint) / sizeof(btScalar);
    info2.m_constraintError = &m_rows[0].m_rhs;
    info2.cfm = &m_rows[0].m_cfm;
    info2.m_lowerLimit = &m_rows[0].m_lowerLimit;
    info2.m_upperLimit = &m_rows[0].m_upperLimit;
    info2.m_numIterations = 10;
    info2.m_damping = 1;
    joint.getInfo2(&info2);
    return info1.m_numConstraintRows;
  }

  std::unique_ptr<btRigidBody> a, b;

 private:
  std::unique_ptr<btRigidBody> body(btScalar mass, const btTransform& pose) {
    btVector3 inertia;
    m_shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &m_shape, inertia);
    info.m_startWorldTransform = pose;
    return std::make_unique<btRigidBody>(info);
  }

  btBoxShape m_shape;
  btSolverConstraint m_rows[8] = {};
};

}  // namespace bench
