// The errata of the document's linear constraints and of its reaction model: each test has the
// printed form, wrong by a stated amount, next to the form that the library uses, right to
// rounding.
#include <gtest/gtest.h>
#include <pintle/equations/distance.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/equations/slider.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

// J M^-1 J^T by the twelve numbers of the row.
double dense_product(const equations::Jacobian<double>& J,
                     const equations::InverseMass<double>& M) {
  return row(J).dot(dense(M) * row(J));
}

// --- 3.1 -----------------------------------------------------------------------------------------

TEST(Errata, Equation3_4HasTheLeverOfTheWrongBody) {
  Random random(1);
  double printed = 0, used = 0;
  for (const Hinge& hinge : hinges({-pi}, {1, 4})) {
    const auto M = any_mass<double>(random);
    const auto at = anchors<double>(hinge);
    const auto to = equations::distance<double>(at.d, Vector::Unit(0));
    const auto J = equations::distance_row(to, 1.0, at.r_a, at.r_b).J;
    const double exact = dense_product(J, M);
    const Vector x_a = cross(at.r_a, to.n), x_b = cross(at.r_b, to.n);
    const double form = M.m_a + Vector(M.I_a * x_a).dot(x_a) + M.m_b + Vector(M.I_b * x_b).dot(x_a);
    printed = std::max(printed, std::abs(form / exact - 1));
    used = std::max(used, std::abs(equations::inverse_effective_mass(J, M, J) / exact - 1));
  }
  EXPECT_GT(printed, 0.5);
  EXPECT_LT(used, kRight);
}

TEST(Errata, Section3_1_2LeavesOutThatTheNormalTurnsWithItsBody) {
  double printed = 0, used = 0, used_difference = 0;
  for (const Hinge& hinge : hinges({-pi}, {1, 4})) {
    const Vector n_l = hinge.m, n = arm(hinge.bodies.q_a, n_l);
    const auto C = [&](const auto& bodies) {
      const auto c = arm(bodies.q_a, n_l).dot(error(hinge, bodies));
      return std::decay_t<decltype(c)>(c);
    };
    const auto at = anchors<double>(hinge);
    const Velocities exact = gradient(C, hinge.bodies);
    const Velocities J = row(equations::contact_row(n, at).J);
    printed = std::max(printed, mismatch(row(equations::contact_row_world(n, at).J), exact));
    used = std::max(used, mismatch(J, exact) / size(hinge));
    used_difference =
        std::max(used_difference, mismatch(J, difference(C, hinge.bodies)) / size(hinge));
  }
  EXPECT_GT(printed, 3);  // m: the gap of 4 m
  EXPECT_LT(used, kRight);
  EXPECT_LT(used_difference, difference_tolerance);
}

TEST(Errata, Equation3_12IsNotTheGradientOfTheSliderEvenWhereItHolds) {
  // On the slide (no error across the axis) and off it.
  double printed_on = 0, printed_off = 0, used = 0;
  for (const bool on : {true, false}) {
    for (Hinge hinge : hinges({-pi}, {1, 4})) {
      const Vector c = hinge.axis_a(2);
      if (on) hinge.bodies.x_b -= hinge.d() - hinge.d().dot(c) * c;
      for (int i = 0; i < 2; ++i) {
        const auto C = [&](const auto& bodies) {
          using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
          const auto frame = equations::product(bodies.q_a, constant<S>(hinge.f_a));
          return S(arm(frame, Vector::Unit(i)).dot(error(hinge, bodies)));
        };
        const Vector u = hinge.axis_a(i);
        const auto at = anchors<double>(hinge);
        const Velocities exact = gradient(C, hinge.bodies);
        const double wrong = mismatch(row(equations::slider_row_middle(u, c, at).J), exact);
        (on ? printed_on : printed_off) = std::max(on ? printed_on : printed_off, wrong);
        used = std::max(used, mismatch(row(equations::contact_row(u, at).J), exact) / size(hinge));
      }
    }
  }
  EXPECT_GT(printed_on, 1);
  EXPECT_GT(printed_off, 3);
  EXPECT_LT(used, kRight);
}

// --- B -------------------------------------------------------------------------------------------

TEST(Errata, EquationB_13IsReachedThroughTheInertiaOfTheWrongBody) {
  // Where the document puts the parts back together it has I_a for I_b.
  Random random(2);
  double printed = 0, used = 0;
  for (int i = 0; i < 200; ++i) {
    const auto M = any_mass<double>(random);
    const equations::Anchors<double> at{random.vector(2), random.vector(2), Vector::Zero()};
    const Vector n = random.unit();
    const auto J = equations::contact_row_world(n, at).J;
    const auto K = [&](const Matrix3<double>& I_b) {
      const Vector turn_a = cross(Vector(M.I_a * cross(at.r_a, n)), at.r_a);
      const Vector turn_b = cross(Vector(I_b * cross(at.r_b, n)), at.r_b);
      return M.m_a + M.m_b + (turn_a + turn_b).dot(n);
    };
    const auto v = velocity<double>(random.velocities());
    const double Jv = equations::row_velocity(J, v), e = random.uniform(0, 1);
    const double terms = 1 + std::abs(Jv);
    const auto error = [&](double k) {
      const double lambda = equations::reaction_impulse(k, Jv, e);
      const auto after = equations::after_impulse(v, M, J, lambda);
      return std::abs(equations::row_velocity(J, after) + e * Jv) / terms;
    };
    printed = std::max(printed, error(K(M.I_a)));
    used = std::max(used, error(equations::inverse_effective_mass(J, M, J)));
  }
  EXPECT_GT(printed, 0.5);
  EXPECT_LT(used, kRight);
}

}  // namespace
