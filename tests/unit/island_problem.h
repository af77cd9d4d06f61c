// An island of Bullet's bodies and joints, of which no step is played, and the same in Eigen's dense matrices.
#pragma once

#include <pintle/solver/bullet/island_builder.h>
#include <pintle/solver/solver_options.h>

#include <Eigen/Dense>
#include <scenes/world.h>

#include <memory>
#include <utility>
#include <vector>

#include "support.h"

namespace island_problem {

inline btSolverBody asSolverBody(btRigidBody& body) {
  btSolverBody to = {};
  to.m_originalBody = body.getInvMass() > 0 ? &body : nullptr;
  to.m_worldTransform = body.getCenterOfMassTransform();
  to.m_linearVelocity = body.getLinearVelocity();
  to.m_angularVelocity = body.getAngularVelocity();
  to.m_externalForceImpulse = to.m_externalTorqueImpulse = btVector3(0, 0, 0);
  return to;
}

class IslandProblem {
 public:
  btRigidBody& add(double mass, const btVector3& at,
                   const btQuaternion& turn = btQuaternion::getIdentity()) {
    btRigidBody& body =
        m_world.add_box(support::scalar(mass), support::vec(0.3, 0.2, 0.1), btTransform(turn, at));
    m_bodies.push_back(&body);
    return body;
  }
  template <class Joint, class... Arguments>
  Joint& join(btRigidBody& a, btRigidBody& b, Arguments&&... arguments) {
    auto& joint = m_world.add_joint<Joint>(a, b, std::forward<Arguments>(arguments)...);
    m_joints.push_back(&joint);
    return joint;
  }
  /// The island of one step of 1/60 s, in which joints close by ERP.
  void build(double erp) {
    btContactSolverInfo info;
    info.m_timeStep = btScalar(1) / 60;
    info.m_erp = support::scalar(erp);
    pintle::SolverBodies bodies;
    for (btRigidBody* body : m_bodies) bodies.push_back(asSolverBody(*body));
    const auto numberOf = [&](const btRigidBody& body) {
      for (size_t i = 0; i < m_bodies.size(); ++i)
        if (m_bodies[i] == &body) return int(i);
      return -1;
    };
    components.clear();
    m_builder.begin(info);
    for (btTypedConstraint* joint : m_joints)
      m_builder.add(*joint, nullptr, bodies, numberOf(joint->getRigidBodyA()),
                    numberOf(joint->getRigidBodyB()));
    m_builder.finish(components);
  }

  /// Masses and inertia, world space.
  Eigen::MatrixXd A() const {
    const auto n = Eigen::Index(island.bodies.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const pintle::IslandBody& body = island.bodies[size_t(i)];
      A.block<3, 3>(6 * i, 6 * i) = body.mass * pintle::Matrix3d::Identity();
      A.block<3, 3>(6 * i + 3, 6 * i + 3) = body.inertia;
    }
    return A;
  }
  /// -A^-1 J^T (J A^-1 J^T)^-1 C: the least move that closes what all rows have open, to first order.
  Eigen::VectorXd leastMove() const {
    const auto n = Eigen::Index(island.bodies.size()), rows = Eigen::Index(island.rows.size());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, 6 * n);
    Eigen::VectorXd C(rows);
    for (const pintle::IslandJoint& joint : island.joints)
      for (int i = 0; i < joint.rows; ++i) {
        const auto r = Eigen::Index(joint.first_row + i);
        const pintle::IslandRow& row = island.rows[size_t(r)];
        C[r] = row.open;
        for (int side = 0; side < 2; ++side)
          if (const int body = joint.body[size_t(side)]; body >= 0)
            J.row(r).segment<6>(6 * body) << row.J.L(side).transpose(), row.J.A(side).transpose();
      }
    const Eigen::MatrixXd by = A().inverse() * J.transpose();
    return -by * (J * by).ldlt().solve(C);
  }

  pintle::Island island;
  std::vector<pintle::Component> components;

 private:
  scenes::World m_world{0};
  std::vector<btRigidBody*> m_bodies;
  std::vector<btTypedConstraint*> m_joints;
  pintle::SolverOptions m_options;
  pintle::IslandBuilder m_builder{island, m_options};
};

}  // namespace island_problem
