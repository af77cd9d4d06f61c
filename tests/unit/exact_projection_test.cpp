// The projection of poses, without a step: what is open closes, by the least move in the metric of the masses.
#include <pintle/joints/ball_joint.h>
#include <pintle/solver/solve/projection.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

#include "island_problem.h"
#include "support.h"

namespace exact_projection_test {

using island_problem::IslandProblem;
using pintle::Vector6d;
using support::Random;
using support::scalar;
using support::vec;

/// A chain of bodies at random poses on balls, each of which is open by up to `open` m. The first body hangs from a post, or nothing does.
struct OpenChain : IslandProblem {
  OpenChain(Random& random, int links, double open, bool is_anchored) {
    btRigidBody* last = is_anchored ? &add(0, vec(0, 0, 0)) : nullptr;
    for (int i = 0; i < links; ++i) {
      btRigidBody& link =
          add(std::pow(10, random.uniform(-1, 1)), random.vector(1), random.pose(1).getRotation());
      if (last != nullptr) {
        const btVector3 middle =
            (last->getCenterOfMassPosition() + link.getCenterOfMassPosition()) / 2;
        join<pintle::BallJoint>(
            *last, link, last->getCenterOfMassTransform().inverse() * middle,
            link.getCenterOfMassTransform().inverse() * (middle + random.vector(open)));
      }
      last = &link;
    }
    build(1);
  }

  pintle::PosesReport project() {
    std::vector<std::array<int, 2>> joints;
    std::vector<int> sizes;
    for (const pintle::IslandJoint& joint : island.joints) {
      joints.push_back(joint.body);
      for (int& body : joints.back()) body = std::max(body, -1);
      sizes.push_back(joint.rows);
    }
    const auto bodies = island.bodies.size(), rows = island.rows.size();
    K.analyse(joints, pintle::JointMatrix::Locks(bodies));
    K.setSizes(sizes);
    work.of_loop.assign(joints.size(), 0.);
    work.way.assign(bodies, Vector6d::Zero());
    work.u.assign(rows, 0.);
    work.x.assign(K.vectorSize(), 0.);
    work.y = work.x;
    for (const pintle::IslandRow& row : island.rows) work.pieces.push_back(row.law.meet(0, row.K));
    return projectPoses(island, components.front(), options, work, K, false, memory);
  }
  /// Move and turn of each body, m and rad.
  Eigen::VectorXd moved() const {
    Eigen::VectorXd by(6 * work.moved.size());
    for (size_t i = 0; i < work.moved.size(); ++i) {
      const Eigen::AngleAxisd turn(work.moved[i].turn);
      by.segment<6>(Eigen::Index(6 * i)) << work.moved[i].move, turn.angle() * turn.axis();
    }
    return by;
  }
  /// m: the most that a joint is open, by the poses of its bodies.
  double open() const {
    double most = 0;
    for (const pintle::IslandJoint& of : island.joints) {
      const auto& joint = dynamic_cast<const pintle::BallJoint&>(*of.constraint);
      pintle::Vector3d point[2];
      for (size_t side = 0; side < 2; ++side) {
        const btRigidBody& body = side ? joint.getRigidBodyB() : joint.getRigidBodyA();
        const btVector3 pivot = side ? joint.getPivotInB() : joint.getPivotInA(),
                        arm = body.getCenterOfMassTransform().getBasis() * pivot;
        point[side] = pintle::inDouble(body.getCenterOfMassPosition());
        if (of.body[side] < 0) {
          point[side] += pintle::inDouble(arm);
        } else {
          const pintle::MovedBody& to = work.moved[size_t(of.body[side])];
          point[side] += to.move + to.turn * pintle::inDouble(arm);
        }
      }
      most = std::max(most, (point[1] - point[0]).norm());
    }
    return most;
  }

  pintle::SolverOptions options;
  pintle::JointMatrix K;
  pintle::Workspace work;
  pintle::ProjectionMemory memory;
};

TEST(Projection, ClosesWhatIsOpen) {
  Random random(3);
  for (int n = 0; n < 50; ++n) {
    OpenChain chain(random, 2 + n % 5, 0.2, n % 2 == 0);
    const pintle::PosesReport done = chain.project();
    EXPECT_TRUE(done.moves) << n;
    EXPECT_LE(done.open, chain.options.pose_tolerance) << n;
    EXPECT_LT(chain.open(), support::is_double ? 1e-8 : 3e-6) << n;
  }
}

// Nearly closed joints move by d = -A^-1 J^T (J A^-1 J^T)^-1 C, but for terms of second order.
TEST(Projection, MovesByTheLeast) {
  constexpr double open = 1e-3;
  Random random(4);
  for (int n = 0; n < 50; ++n) {
    OpenChain chain(random, 2 + n % 5, open, n % 2 == 0);
    ASSERT_TRUE(chain.project().moves) << n;
    const Eigen::VectorXd least = chain.leastMove();
    const Eigen::VectorXd off = chain.moved() - least;
    EXPECT_LT(std::sqrt(off.dot(chain.A() * off)), 0.05 * std::sqrt(least.dot(chain.A() * least)))
        << n;
  }
}

// Nothing outside acts on a chain that hangs from nothing.
TEST(Projection, LeavesTheCentreOfMass) {
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    OpenChain chain(random, 4, 0.2, false);
    ASSERT_TRUE(chain.project().moves) << n;
    pintle::Vector3d sum = pintle::Vector3d::Zero();
    double mass = 0;
    for (size_t i = 0; i < chain.island.bodies.size(); ++i) {
      sum += chain.island.bodies[i].mass * chain.work.moved[i].move;
      mass += chain.island.bodies[i].mass;
    }
    EXPECT_LT(sum.norm() / mass, 1e-9) << n;
  }
}

// A budget of one factor leaves what it cannot close, and says so.
TEST(Projection, SaysWhatABudgetLeavesOpen) {
  Random random(6);
  int left = 0;
  for (int n = 0; n < 20; ++n) {
    OpenChain chain(random, 6, 0.5, true);
    chain.options.max_factors = 1;
    const pintle::PosesReport done = chain.project();
    // (That of a row; a joint has three.)
    EXPECT_GE(chain.open(), done.open * (1 - 1e-4)) << n;
    EXPECT_LE(chain.open(), std::sqrt(3.) * done.open * (1 + 1e-4)) << n;
    left += done.open > chain.options.pose_tolerance;
  }
  EXPECT_GT(left, 0);
}

}  // namespace exact_projection_test
