// Where Bullet's solver computes the document's formulas itself, its numbers are the document's: one
// row of any Jacobian between two free bodies, solved in one step of a world.
#include <gtest/gtest.h>
#include <pintle/extend.h>

#include "solver_of_tests.h"
#include "support.h"

namespace bullet_numbers_test {

namespace equations = pintle::equations;
using pintle::Scalar;
using pintle::Vec3;
using support::Random;
using support::scalar;
using support::vec;

using Jacobian = equations::Jacobian<Scalar>;

Vec3 from(const btVector3& v) { return pintle::view(v); }

/// One equality that says what it is told to: C where the bodies are now, and beyond as J has it.
class OneRow : public pintle::FrameJoint {
 public:
  OneRow(btRigidBody& a, btRigidBody& b, const Jacobian& J, Scalar C)
      : FrameJoint(a, b, pintle::RowCount{1}), m_J(J), m_C(C) {
    setBlockRows(false);
  }
  const char* name() const override { return "OneRow"; }
  void addRows(const pintle::PosePair& at, pintle::Rows& rows) const override {
    const Vec3 d = at.x_b() - at.x_a() - from(m_b.getOrigin() - m_a.getOrigin());
    const Scalar moved =
        m_J.L.dot(d) - m_J.A_a.dot(turn(m_a, at.R_a())) + m_J.A_b.dot(turn(m_b, at.R_b()));
    rows.addEquality(m_J.L, m_J.A_a, m_J.A_b, m_C + moved);
  }
  /// C where the bodies are.
  Scalar error() const {
    pintle::RowMemory<1> memory;
    pintle::Rows rows(memory);
    addRows(pintle::BodyPair(m_rbA, m_rbB), rows);
    return rows[0].position;
  }
  void soften(Scalar erp, Scalar cfm) {
    support::closeByErpAlone<pintle::Joint>(*this);
    setParam(BT_CONSTRAINT_ERP, erp);
    setParam(BT_CONSTRAINT_CFM, cfm);
  }

 private:
  static Vec3 turn(const btTransform& start, const pintle::Mat3& R) {
    const Eigen::AngleAxis<Scalar> by(pintle::Mat3(R * pintle::view(start.getBasis()).transpose()));
    return by.angle() * by.axis();
  }

  Jacobian m_J;
  Scalar m_C;
  btTransform m_a = m_rbA.getCenterOfMassTransform(), m_b = m_rbB.getCenterOfMassTransform();
};

// Two bodies that move anyhow in a world without gravity, and a row between them.
class BulletNumbers : public testing::TestWithParam<unsigned> {
 protected:
  BulletNumbers() : m_random(GetParam()) {
    for (btRigidBody* body : {&a, &b}) {
      body->setFlags(0);  // no gyroscopic torque: the row alone acts
      body->setLinearVelocity(m_random.vector(3));
      body->setAngularVelocity(m_random.vector(3));
    }
    const auto any = [&] { return from(m_random.vector(2)); };
    J = {any(), any(), any()};
    const pintle::BodyPair pair(a, b);
    M = {pair.inv_mass_a(), pair.inv_mass_b(), pair.inv_inertia_a(), pair.inv_inertia_b()};
    K = equations::inverse_effective_mass(J, M, J);
    before = {pair.v_a(), pair.w_a(), pair.v_b(), pair.w_b()};
    Jv = equations::row_velocity(J, before);
  }

  /// The bodies' velocities after a step are those after the impulse lambda of the row (B.6, B.7).
  void expectImpulse(Scalar lambda, double tolerance) {
    const auto after = equations::after_impulse(before, M, J, lambda);
    const auto expect = [&](const btVector3& got, const Vec3& expected) {
      EXPECT_LE(double((from(got) - expected).norm()), tolerance * (1 + double(expected.norm())));
    };
    expect(a.getLinearVelocity(), after.v_a);
    expect(b.getLinearVelocity(), after.v_b);
    expect(a.getAngularVelocity(), after.w_a);
    expect(b.getAngularVelocity(), after.w_b);
  }

  const double h = 1.0 / 60;
  // Of the exact solver, 1e-9 m in a step.
  const double rounding = onExactSolver() ? (support::is_double ? 1e-7 : 1e-4)
                                          : 100 * double(std::numeric_limits<Scalar>::epsilon());
  Random m_random;
  scenes::World world{0, 200};
  btRigidBody& a = world.add_box(2, vec(0.5, 0.3, 0.2), m_random.pose(1));
  btRigidBody& b = world.add_box(0.7, vec(0.2, 0.3, 0.4), m_random.pose(1));
  Jacobian J;
  equations::InverseMass<Scalar> M;
  equations::Velocity<Scalar> before;
  Scalar K, Jv;
};

// (2.4) with the bias of (2.7): K is Bullet's own (2.6), the impulse minus its applied one.
TEST_P(BulletNumbers, ARigidRowsImpulseIsTheDocuments) {
  for (const double C : {0.0, 0.3, -0.1}) {
    const Scalar erp = scalar(0.35);
    auto& row = world.add_joint<OneRow>(a, b, J, scalar(C));
    row.soften(erp, 0);
    row.enableFeedback(true);
    world.step(h);
    // The exact solver moves poses instead.
    const Scalar bias =
        onExactSolver() ? Scalar(0) : equations::baumgarte(scalar(C), erp, scalar(h));
    const Scalar lambda = equations::impulse(K, Jv, bias);
    expectImpulse(lambda, rounding);
    EXPECT_NEAR(double(-row.getAppliedImpulse()), double(lambda),
                rounding * (1 + std::abs(double(lambda))));
    EXPECT_NEAR(double(row.error()), (1 - double(erp)) * C, rounding);
    // What the next one starts from.
    row.setEnabled(false);
    before = {from(a.getLinearVelocity()), from(a.getAngularVelocity()),
              from(b.getLinearVelocity()), from(b.getAngularVelocity())};
    const pintle::BodyPair pair(a, b);
    M = {pair.inv_mass_a(), pair.inv_mass_b(), pair.inv_inertia_a(), pair.inv_inertia_b()};
    K = equations::inverse_effective_mass(J, M, J);
    Jv = equations::row_velocity(J, before);
  }
}

// (2.13) with gamma and beta of (2.9): Bullet's erp is beta, its cfm gamma / (dt K).
TEST_P(BulletNumbers, ASoftRowsImpulseIsTheDocuments) {
  PINTLE_SKIP_ON_EXACT_SOLVER("a spring starts without tension wherever it is");
  const Scalar C = scalar(0.2), dt = scalar(h);
  // Stiff enough for Bullet's iteration to converge: cfm = 1 / (dt (dt k + d) K).
  const Scalar k = 20 / (K * dt * dt), d = 5 / (K * dt);
  const auto soft = equations::softness(k, d, dt);
  auto& row = world.add_joint<OneRow>(a, b, J, C);
  row.soften(soft.beta, soft.gamma / dt / K);
  world.step(h);
  expectImpulse(equations::soft_impulse(equations::soft_effective_mass(K, soft.gamma, dt), Jv,
                                        soft.beta, C, dt),
                rounding);
}

// (B.5): as a force over the step.
TEST_P(BulletNumbers, TheForceFormIsTheImpulseOverTheStep) {
  auto& row = world.add_joint<OneRow>(a, b, J, scalar(0));
  btJointFeedback feedback;
  row.setJointFeedback(&feedback);
  row.enableFeedback(true);
  world.step(h);
  const Scalar lambda = equations::impulse(K, Jv, Scalar(0));
  const Vec3 force = J.L * lambda / scalar(h);
  EXPECT_LE(double((from(feedback.m_appliedForceBodyB) - force).norm()),
            rounding * (1 + double(force.norm())));
}

INSTANTIATE_TEST_SUITE_P(Seeds, BulletNumbers, testing::Range(1u, 21u));

}  // namespace bullet_numbers_test
