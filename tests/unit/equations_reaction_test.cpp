// The collision of two bodies, against the laws that it has to obey: Newton's restitution at the
// point of contact, and the momentum and energy of the two bodies, computed one by one.
#include <gtest/gtest.h>
#include <pintle/equations/contact.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/precision.h>

#include <Eigen/LU>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Reaction : public testing::Test {
 public:
  // Sums of some ten terms; relative to their size.
  static constexpr double kTolerance = 20 * double(std::numeric_limits<T>::epsilon());
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Reaction, Scalars);

// Two bodies that touch at one point, in double; every other one is fixed.
struct Collision {
  equations::InverseMass<double> M;
  equations::Anchors<double> at;
  Vector x_a, x_b, n;
  Velocities v;
  double e;
};
Collision any_collision(Random& random, int i) {
  Collision c;
  c.M = any_mass<double>(random);
  if (i % 4 == 1) c.M.m_a = 0, c.M.I_a.setZero();
  if (i % 4 == 3) c.M.m_b = 0, c.M.I_b.setZero();
  const Vector p = random.vector(5);
  c.x_a = random.vector(5);
  c.x_b = random.vector(5);
  c.at = {p - c.x_a, p - c.x_b, Vector::Zero()};
  c.n = random.unit();
  c.v = random.velocities();
  c.e = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : random.uniform(0, 1);
  return c;
}

template <class T>
struct Outcome {
  T K, lambda;
  equations::Velocity<T> before, after;
  equations::Jacobian<T> J;
};
template <class T>
Outcome<T> collide(const Collision& c) {
  const equations::InverseMass<T> M{T(c.M.m_a), T(c.M.m_b), c.M.I_a.cast<T>(), c.M.I_b.cast<T>()};
  const equations::Anchors<T> at{c.at.r_a.cast<T>(), c.at.r_b.cast<T>(), c.at.d.cast<T>()};
  Outcome<T> o;
  o.before = velocity<T>(c.v);
  o.J = equations::contact_row_world<T>(c.n.cast<T>(), at).J;
  o.K = equations::inverse_effective_mass(o.J, M, o.J);
  o.lambda = equations::reaction_impulse(o.K, equations::row_velocity(o.J, o.before), T(c.e));
  o.after = equations::after_impulse(o.before, M, o.J, o.lambda);
  return o;
}
template <class T>
double largest(const equations::Velocity<T>& v) {
  return double(std::max({v.v_a.cwiseAbs().maxCoeff(), v.w_a.cwiseAbs().maxCoeff(),
                          v.v_b.cwiseAbs().maxCoeff(), v.w_b.cwiseAbs().maxCoeff()}));
}

TYPED_TEST(Reaction, RowVelocityIsThatOfThePointsAlongTheNormal) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Collision c = any_collision(random, i);
    const auto o = collide<T>(c);
    const Vector v_a = c.v.segment<3>(0), w_a = c.v.segment<3>(3);
    const Vector v_b = c.v.segment<3>(6), w_b = c.v.segment<3>(9);
    const Vector apart = (v_b + cross(w_b, c.at.r_b)) - (v_a + cross(w_a, c.at.r_a));
    ASSERT_LE(std::abs(double(equations::row_velocity(o.J, o.before)) - c.n.dot(apart)),
              10 * this->kTolerance);
  }
}

TYPED_TEST(Reaction, PointsPartAtEpsilonTimesTheVelocityAtWhichTheyMet) {
  using T = TypeParam;
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Collision c = any_collision(random, i);
    const auto o = collide<T>(c);
    // By the points themselves, and not by the row.
    const auto opening = [&](const equations::Velocity<T>& v) {
      const Vector v_a = v.v_a.template cast<double>(), w_a = v.w_a.template cast<double>();
      const Vector v_b = v.v_b.template cast<double>(), w_b = v.w_b.template cast<double>();
      return c.n.dot((v_b + cross(w_b, c.at.r_b)) - (v_a + cross(w_a, c.at.r_a)));
    };
    ASSERT_LE(std::abs(opening(o.after) + c.e * opening(o.before)),
              10 * this->kTolerance * (1 + largest(o.after)));
  }
}

TYPED_TEST(Reaction, MomentumIsConservedAndEnergyIsLostByRestitutionOnly) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 300; i += 2) {  // both bodies free
    const Collision c = any_collision(random, i);
    const auto o = collide<T>(c);
    const double m_a = 1 / c.M.m_a, m_b = 1 / c.M.m_b;
    const Matrix3<double> I_a = Eigen::Matrix3d(c.M.I_a).inverse();
    const Matrix3<double> I_b = Eigen::Matrix3d(c.M.I_b).inverse();
    struct Total {
      Vector p, L;
      double energy, terms;
    };
    const auto total = [&](const equations::Velocity<T>& v) {
      const Vector v_a = v.v_a.template cast<double>(), w_a = v.w_a.template cast<double>();
      const Vector v_b = v.v_b.template cast<double>(), w_b = v.w_b.template cast<double>();
      const Vector p_a = m_a * v_a, p_b = m_b * v_b, L_a = I_a * w_a, L_b = I_b * w_b;
      Total t;
      t.p = p_a + p_b;
      t.L = cross(c.x_a, p_a) + L_a + cross(c.x_b, p_b) + L_b;
      t.energy = (p_a.dot(v_a) + L_a.dot(w_a) + p_b.dot(v_b) + L_b.dot(w_b)) / 2;
      t.terms =
          p_a.cwiseAbs().sum() + p_b.cwiseAbs().sum() + L_a.cwiseAbs().sum() + L_b.cwiseAbs().sum();
      return t;
    };
    const Total before = total(o.before), after = total(o.after);
    const double terms = before.terms + after.terms;
    ASSERT_LE(mismatch(after.p, before.p), this->kTolerance * terms);
    ASSERT_LE(mismatch(after.L, before.L), 10 * this->kTolerance * terms);
    const double v_n = double(equations::row_velocity(o.J, o.before));
    const double lost = (1 - c.e * c.e) * v_n * v_n / (2 * double(o.K));
    ASSERT_LE(std::abs(before.energy - after.energy - lost),
              this->kTolerance * terms * (1 + largest(o.after)));
  }
}

TYPED_TEST(Reaction, WithoutRestitutionItIsTheImpulseOfTheRow) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 300; i += 3) {  // e = 0
    const auto o = collide<T>(any_collision(random, i));
    ASSERT_EQ(o.lambda, equations::impulse(o.K, equations::row_velocity(o.J, o.before), T(0)));
  }
}

TYPED_TEST(Reaction, InverseMassIsTheDenominatorOfTheReactionModel) {
  // (B.14): by the velocity that a unit impulse gives the points.
  using T = TypeParam;
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Collision c = any_collision(random, i);
    const Vector turn_a = cross(Vector(c.M.I_a * cross(c.at.r_a, c.n)), c.at.r_a);
    const Vector turn_b = cross(Vector(c.M.I_b * cross(c.at.r_b, c.n)), c.at.r_b);
    const double expected = c.M.m_a + c.M.m_b + (turn_a + turn_b).dot(c.n);
    ASSERT_LE(std::abs(double(collide<T>(c).K) / expected - 1), 4 * this->kTolerance);
  }
}

TYPED_TEST(Reaction, ForceOverTheStepSatisfiesTheVelocityConstraint) {
  // (B.1) to (B.4): f = J^T lambda for a whole step, with any row.
  using T = TypeParam;
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Collision c = any_collision(random, i);
    const auto o = collide<T>(c);
    const T Jv = equations::row_velocity(o.J, o.before), b = T(random.uniform(-1, 1));
    const T dt = T(1 / random.uniform(20, 1000));
    const double f = double(equations::force(o.K, Jv, b, dt));
    Velocities MJ;
    const Velocities J = row(o.J);
    MJ << c.M.m_a * J.segment<3>(0), c.M.I_a * J.segment<3>(3), c.M.m_b * J.segment<3>(6),
        c.M.I_b * J.segment<3>(9);
    const Velocities after = c.v + double(dt) * f * MJ;
    ASSERT_LE(
        std::abs(J.dot(after) + double(b)),
        10 * this->kTolerance * (1 + J.cwiseAbs().maxCoeff()) * (1 + after.cwiseAbs().maxCoeff()));
  }
}

}  // namespace
