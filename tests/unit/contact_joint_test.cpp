// A point on a plane: held on it, kept above it, and its rebound, which is the document's impulse.
#include <pintle/body_pair.h>
#include <pintle/equations/contact.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/joints/contact_joint.h>

#include "free_joint_support.h"
#include "solver_of_tests.h"

namespace contact_joint_test {

using namespace free_joints;
using pintle::ContactJoint;
using pintle::Formulation;
using scenes::standard_gravity;
using scenes::World;
using support::infinite;
using support::SolverRows;
namespace equations = pintle::equations;

constexpr double dt = 1.0 / 60;
constexpr double g = standard_gravity;

// A cube over the floor z = 0.
struct Floor {
  World world;
  btRigidBody& fixed;
  btRigidBody& cube;
  ContactJoint& joint;

  explicit Floor(double height, double gravity = g)
      : world(gravity),
        fixed(addCube(world, 0, vec(0, 0, 0))),
        cube(addCube(world, 2, vec(0, 0, height))),
        joint(
            world.add_joint<ContactJoint>(fixed, cube, vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 2))) {}

  btRigidBody& free() { return cube; }
  void step() { world.step(dt); }
  double height() const { return scenes::position(cube).z(); }
  double speed() const { return double(cube.getLinearVelocity().z()); }
};

// --- restitution ---------------------------------------------------------------------------------

TEST(ContactJoint, TheReboundIsTheDocumentsImpulse) {
  support::Random random(1);
  for (int n = 0; n < 200; ++n) {
    // On the exact solver what does not rebound is held at the end of the step.
    const double none = onExactSolver() ? 0.01 : 0;
    const double e = n % 4 == 0 ? none : n % 4 == 1 ? 1 : random.uniform(0, 1);
    World world(0);
    btRigidBody& a = addCube(world, random.uniform(0.5, 3), random.vector(1));
    btRigidBody& b = addCube(world, random.uniform(0.5, 3), random.vector(1));
    a.setCenterOfMassTransform(random.pose(1));
    // They touch anywhere on the plane.
    const btVector3 normal = random.unit(), pivot_a = random.vector(0.3),
                    pivot_b = random.vector(0.3);
    btVector3 along = random.vector(0.2);
    if (n % 2 == 0) along = vec(0, 0, 0);
    along -= normal * normal.dot(along);
    btTransform pose_b = random.pose(1);
    pose_b.setOrigin(a.getCenterOfMassTransform()(pivot_a + along) - pose_b.getBasis() * pivot_b);
    b.setCenterOfMassTransform(pose_b);
    auto& joint = world.add_joint<ContactJoint>(a, b, pivot_a, pivot_b, normal);
    joint.setRestitution(scalar(e));
    // Where the point slides on a plane that turns, only the document's row has the document's
    // impulse; and with spin only a row that foresees nothing.
    const bool document = n % 3 == 0;
    if (document) joint.setFormulation(Formulation::document);
    for (btRigidBody* body : {&a, &b}) {
      body->setLinearVelocity(random.vector(2));
      if (document) body->setAngularVelocity(random.vector(3));
    }
    const pintle::BodyPair pair(a, b);
    const equations::Velocity<btScalar> v{pair.v_a(), pair.w_a(), pair.v_b(), pair.w_b()};
    const equations::InverseMass<btScalar> M{pair.inv_mass_a(), pair.inv_mass_b(),
                                             pair.inv_inertia_a(), pair.inv_inertia_b()};
    equations::Anchors<btScalar> at;
    at.r_a = pair.R_a() * pintle::view(pivot_a);
    at.r_b = pair.R_b() * pintle::view(pivot_b);
    at.d = equations::position_error(pair.x_a(), at.r_a, pair.x_b(), at.r_b);
    const pintle::Vec3 n_world = pair.R_a() * pintle::view(normal);
    const auto row =
        document ? equations::contact_row_world(n_world, at) : equations::contact_row(n_world, at);
    const btScalar closing = equations::row_velocity(row.J, v);
    const btScalar K = equations::inverse_effective_mass(row.J, M, row.J);
    const double expected =
        closing < 0 ? double(equations::reaction_impulse(K, closing, scalar(e))) : 0;
    const auto after = equations::after_impulse(v, M, row.J, scalar(expected));
    // Within rounding the point may be above the plane: then the step brings it there, and the next
    // one is the rebound.
    if (joint.getDistance() > 0)
      joint.getFrameOffsetA().getOrigin() += normal * scalar(rounding(1e-6, 1e-14));
    world.step(dt);
    // The correction of that micrometre is 4e-6 m/s; a cube of 1 kg has an inertia of 1/600.
    const double tolerance = rounding(3e-5, 1e-11);
    if (onExactSolver()) {
      // The mean speed of the step rebounds, or, where the bodies turn too fast for that, the speed along the row of the start.
      if (!(closing < 0)) continue;
      const double mean = double(joint.getDistance()) / dt,
                   at_start = double(equations::row_velocity<btScalar>(
                       row.J, {pair.v_a(), pair.w_a(), pair.v_b(), pair.w_b()})),
                   rebound = -e * double(closing);
      ASSERT_LT(std::min(std::abs(mean - rebound), std::abs(at_start - rebound)),
                rounding(1e-3, 1e-6))
          << n;
      continue;
    }
    ASSERT_NEAR(double(joint.getNormalImpulse()), expected, tolerance) << n;
    ASSERT_LE((pair.v_b() - after.v_b).norm(), tolerance) << n;
    ASSERT_LE((pair.w_a() - after.w_a).norm(), 20 * tolerance) << n;
    ASSERT_LE((pair.w_b() - after.w_b).norm(), 20 * tolerance) << n;
  }
}

TEST(ContactJoint, ADroppedBodyReboundsToTheSquareOfRestitution) {
  // Bullet's fall is N steps of i g dt^2, from h to a rest x_N in [0, (N + 1) g dt^2) that the next
  // step would pass; it then leaves the plane at e N g dt and climbs e N g dt^2, (e N - 1) g dt^2, ...:
  // as high as g dt^2 (e N (e N + 1) + f (1 - f)) / 2, f the fraction of e N.
  for (const double e : {0., 0.5, 1.}) {
    for (const double h : {0.05, 0.5, 1., 2.}) {
      for (const double start : {h, h + 0.0123}) {
        Floor floor(start);
        floor.joint.setRestitution(scalar(e));
        const double unit = g * dt * dt;
        int N = 0;
        while (start - unit * (N + 1) * (N + 2) / 2 >= 0) ++N;
        const double up = e * N, f = up - std::floor(up);
        const double expected = e == 0 ? 0 : unit * (up * (up + 1) + f * (1 - f)) / 2;
        double top = 0;
        for (int i = 0; i < N + 2; ++i) floor.step();
        EXPECT_NEAR(floor.height(), up * unit, rounding(1e-5, 1e-12)) << "e " << e << ", h " << h;
        for (int i = 0; i < int(up) + 1; ++i) {
          top = std::max(top, floor.height());
          floor.step();
        }
        EXPECT_NEAR(top, expected, rounding(1e-5, 1e-12)) << "e " << e << ", h " << h;
        // Which is e^2 h to within what the steps leave out, and never more at e = 1.
        EXPECT_LE(top, e * e * start + N * (e - e * e) * unit / 2 + unit / 8 + 1e-5);
        EXPECT_GE(top, e * e * (start - (N + 1) * unit) - 1e-5);
        if (e == 1) {
          EXPECT_LE(top, start + rounding(1e-6, 1e-12));
        }
      }
    }
  }
}

TEST(ContactJoint, ABouncingBodyGainsNoEnergyAndAtLastRests) {
  for (const double e : {0., 0.5, 0.9, 1.}) {
    Floor floor(0.5);
    floor.joint.setRestitution(scalar(e));
    double top = 0.5, climbed = 0;
    bool rising = false;
    for (int i = 0; i < 1200; ++i) {
      floor.step();
      ASSERT_GE(floor.height(), -rounding(1e-5, 1e-12));
      if (floor.speed() > 0) climbed = floor.height(), rising = true;
      if (floor.speed() <= 0 && rising) {
        ASSERT_LE(climbed, top + rounding(1e-5, 1e-12));
        top = climbed;
        rising = false;
      }
    }
    if (e < 0.6) {
      // A rebound of less than g dt is no flight.
      EXPECT_LT(floor.height(), 2 * g * dt * dt);
      EXPECT_LT(std::abs(floor.speed()), g * dt);
    }
    if (e == 0) {
      EXPECT_NEAR(floor.height(), 0, rounding(1e-6, 1e-12));
      EXPECT_NEAR(double(floor.joint.getNormalImpulse()), 2 * g * dt, rounding(1e-5, 1e-12));
    }
  }
}

// --- the plane -----------------------------------------------------------------------------------

TEST(ContactJoint, APenetrationIsTakenAway) {
  PINTLE_SKIP_ON_EXACT_SOLVER("what is open closes by poses, which velocities tell nothing of");
  // Two-sided, a part erp of it a step.
  Floor held(-0.2, 0);
  held.joint.setTwoSided(true);
  support::closeByErpAlone(held.joint);
  EXPECT_NEAR(double(held.joint.getDistance()), -0.2, 1e-6);
  for (int i = 1; i < 30; ++i) {
    held.step();
    EXPECT_NEAR(held.height(), -0.2 * std::pow(0.8, i), rounding(1e-5, 1e-12));
  }
  // One-sided, a limit's 0.3 of that, of the depth at first: nothing pulls the body back.
  Floor floor(-0.2);
  floor.step();
  EXPECT_NEAR(floor.speed(), 0.3 * 0.2 * 0.2 / dt, 1e-5);
  double top = 0;
  for (int i = 0; i < 300; ++i) {
    floor.step();
    top = std::max(top, floor.height());
  }
  EXPECT_NEAR(floor.height(), 0, rounding(1e-5, 1e-8));
  // As high above the plane as that speed would take it, at most.
  EXPECT_LT(top, 0.72 * 0.72 / (2 * g));
  // Deep, and it comes out no faster than it may.
  Floor deep(-10, 0);
  deep.joint.setMaxCorrectionSpeed(3);
  deep.step();
  EXPECT_NEAR(deep.speed(), 3, 1e-5);
}

TEST(ContactJoint, AboveThePlaneItDoesNothing) {
  Floor floor(1, 0);
  EXPECT_EQ(SolverRows::ofStep(floor.joint).announced(), 0);
  floor.cube.setLinearVelocity(vec(3, 0, 2));
  floor.step();
  EXPECT_EQ(floor.joint.getNormalImpulse(), 0);
  floor.cube.setLinearVelocity(vec(0, 0, -100));  // it would be far below
  floor.step();
  EXPECT_NEAR(floor.height(), 0, 1e-5);
}

TEST(ContactJoint, ItSlidesAndTurnsWithoutFriction) {
  Floor floor(0);
  floor.cube.setLinearVelocity(vec(1, 2, 0));
  floor.cube.setAngularVelocity(vec(3, -1, 2));
  for (int i = 0; i < 60; ++i) floor.step();
  EXPECT_NEAR(scenes::position(floor.cube).x(), 1, 1e-4);
  EXPECT_NEAR(scenes::position(floor.cube).y(), 2, 1e-4);
  EXPECT_NEAR(double(floor.cube.getAngularVelocity().z()), 2, 1e-4);
}

TEST(ContactJoint, TwoSidedItHoldsFromBothSides) {
  Floor floor(0);
  floor.joint.setTwoSided(true);
  EXPECT_TRUE(floor.joint.getTwoSided());
  for (const double force : {-100., 100.}) {
    for (int i = 0; i < 60; ++i) {
      floor.cube.applyCentralForce(vec(0, 0, force));
      floor.step();
      ASSERT_NEAR(floor.height(), 0, rounding(1e-5, 1e-12));
      ASSERT_NEAR(double(floor.joint.getNormalImpulse()), (2 * g - force) * dt,
                  rounding(1e-4, 1e-10));
    }
  }
  floor.joint.setLimitSpring(2, 1);
  for (int i = 0; i < 300; ++i) floor.step();
  EXPECT_NEAR(floor.height(), -g / (16 * pi * pi), 1e-4);
  EXPECT_NEAR(double(floor.joint.getNormalImpulse()), 2 * g * dt, 1e-4);
}

TEST(ContactJoint, ThePlaneOfABodyTurnsWithItAndTheDocumentsDoesNot) {
  // A plate spins freely, and a point rides on it off its centre: the pair keeps its momentum.
  for (const Formulation formulation : {Formulation::conditioned, Formulation::document}) {
    World world(0);
    btRigidBody &a = addCube(world, 300, vec(0, 0, 0)), &b = addCube(world, 1, vec(0.5, 0, 0));
    auto& joint = world.add_joint<ContactJoint>(a, b, vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 1));
    joint.setFormulation(formulation);
    joint.setTwoSided(true);
    a.setAngularVelocity(vec(0, -2, 0));
    const auto momentum = [&] {
      Eigen::Vector3d L = Eigen::Vector3d::Zero();
      for (const btRigidBody* body : {&a, &b})
        L += scenes::position(*body).cross(scenes::to_eigen(body->getLinearVelocity())) /
                 double(body->getInvMass()) +
             double(body->getLocalInertia().x()) * scenes::to_eigen(body->getAngularVelocity());
      return L;
    };
    const Eigen::Vector3d L = momentum();
    double off_body = 0, off_world = 0;
    for (int i = 0; i < 30; ++i) {
      world.step(dt);
      const Eigen::Vector3d d = scenes::position(b) - scenes::position(a);
      off_body = std::max(off_body, std::abs(d.dot(scenes::direction_in_world(a, {0, 0, 1}))));
      off_world = std::max(off_world, std::abs(d.z()));
    }
    if (formulation == Formulation::conditioned) {
      EXPECT_LT(off_body, 2e-4);
      EXPECT_GT(off_world, 0.01);
      // Of the exact solver, what it leaves of the gap is between their impulses.
      EXPECT_LT((momentum() - L).norm(), rounding(2e-5, onExactSolver() ? 1e-8 : 1e-12));
    } else {
      EXPECT_LT(off_world, rounding(1e-6, 1e-12));
    }
  }
}

// --- as any of Bullet's joints -------------------------------------------------------------------

TEST(ContactJoint, ASpringCarriesByItsFrequency) {
  Floor floor(0.1);
  floor.joint.setLimitSpring(3, 1);
  EXPECT_EQ(SolverRows::ofStep(floor.joint).announced(), 0);
  for (int i = 0; i < 300; ++i) floor.step();
  EXPECT_NEAR(floor.height(), -g / (36 * pi * pi), 1e-4);
}

TEST(ContactJoint, FeedbackIsTheLoadAndABreakingThresholdBreaksIt) {
  Floor floor(0);
  btJointFeedback feedback;
  floor.joint.setJointFeedback(&feedback);
  for (int i = 0; i < 10; ++i) floor.step();
  EXPECT_NEAR(double(feedback.m_appliedForceBodyB.z()), 2 * g, 1e-3);
  Floor breaking(0);
  breaking.joint.setBreakingImpulseThreshold(scalar((50.5 + 2 * g) * dt));
  EXPECT_NEAR(support::stepOfBreaking(breaking, breaking.joint, vec(0, 0, -1), vec(0, 0, 0)), 51,
              1);
}

TEST(ContactJoint, ConstructorsAgree) {
  World world(0);
  btRigidBody &a = addCube(world, 1, vec(1, 2, 3)), &b = addCube(world, 1, vec(1, 2, 2));
  const btVector3 p = vec(0.1, 0.2, 0.3), q = vec(-0.2, 0, 0.1);
  ContactJoint pivots(a, b, p, q, vec(0, 0, 3)),
      frames(a, b, scenes::pose_at(p), scenes::pose_at(q));
  EXPECT_EQ(SolverRows::ofStep(pivots), SolverRows::ofStep(frames));
  EXPECT_EQ(SolverRows::ofStep(frames).announced(), 1);
  EXPECT_NEAR(double(pivots.getDistance()), -1.2, 1e-6);
  ContactJoint one(a, scenes::pose_at(p));
  EXPECT_NEAR(double(one.getDistance()), 0, 1e-6);
  EXPECT_EQ(&one.getRigidBodyB(), &btTypedConstraint::getFixedBody());
}

TEST(ContactJoint, RefusesBadSettingsAndStaysAsItWas) {
  Floor floor(-0.1);
  using C = ContactJoint;
  const auto make = [&] {
    return std::make_unique<C>(floor.fixed, floor.cube, vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 1));
  };
  expectChecked<C>(
      {{"restitution", [](C& c, btScalar v) { c.setRestitution(v); }, false, true, false},
       {"spring frequency", [](C& c, btScalar v) { c.setLimitSpring(v, 1); }, false, true, false},
       {"damping ratio", [](C& c, btScalar v) { c.setLimitSpring(1, v); }, false, true, false}},
      make);
  const auto joint = make(), twin = make();
  expectRefused(
      *joint, *twin, [](C& c, btScalar v) { c.setRestitution(v); }, "restitution", scalar(1.5));
  const btVector3 o = vec(0, 0, 0), z = vec(0, 0, 1);
  for (const btScalar value : {nan_value, infinite}) {
    const btVector3 bad(0, value, 0);
    const auto refused = [&](const btVector3& p, const btVector3& q, const btVector3& n) {
      return refusal([&] { C(floor.fixed, floor.cube, p, q, n); });
    };
    expectRefusal(refused(bad, o, z), "ContactJoint", "pivotInA", value);
    expectRefusal(refused(o, bad, z), "ContactJoint", "pivotInB", value);
    expectRefusal(refused(o, o, bad), "ContactJoint", "normalInA", value);
    expectRefusal(refused(o, o, o), "ContactJoint", "normalInA", 0);
  }
}

TEST(ContactJoint, IsDrawn) {
  const Floor floor(1);
  expectDrawn(floor.joint, 6, true);
}

}  // namespace contact_joint_test
