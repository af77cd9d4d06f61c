// The errata of the document's hinges by dot products and of points, of its unstable constraints
// and of its appendix A: each test has the printed form, wrong by a stated amount, next to the form
// that the library uses, right to rounding.
#include <gtest/gtest.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/equations/unstable.h>

#include <Eigen/LU>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

std::vector<Hinge> all_hinges() { return hinges(kSwings, {0}); }

template <class T>
Vector3<T> crossed(const Hinge& hinge, const Bodies<T>& bodies) {
  const auto axis = [](const Quaternion<T>& q, const Turn& f) {
    return arm(equations::product(q, constant<T>(f)), Vector::Unit(2));
  };
  return cross(axis(bodies.q_a, hinge.f_a), axis(bodies.q_b, hinge.f_b));
}

Velocities angular_rows(const Vector& J_a, const Vector& J_b) {
  return row(equations::Jacobian<double>{Vector::Zero(), -J_a, J_b});
}

// --- 3.2 -----------------------------------------------------------------------------------------

TEST(Errata, Equation3_17InvertsTheWrongFactor) {
  Random random(1);
  double printed = 0, used = 0;
  for (int i = 0; i < 200; ++i) {
    const auto M = any_mass<double>(random);
    const Vector f = random.unit(), d = pintle::any_tangent(f);
    const auto dot = equations::dot_hinge_row(f, d);
    const double exact = angular_row(dot.J_b).dot(dense(M) * angular_row(dot.J_b));
    // As printed, with the only reading that is a number: I x without an inverse.
    const Eigen::Matrix3d I_a = Eigen::Matrix3d(M.I_a).inverse();
    const Eigen::Matrix3d I_b = Eigen::Matrix3d(M.I_b).inverse();
    const Vector x = cross(d, f);
    const double form = Vector(I_a * x).dot(x) + Vector(I_b * x).dot(x);
    printed = std::max(printed, std::abs(form / exact - 1));
    used =
        std::max(used, std::abs(equations::angular_inverse_effective_mass(M, dot.J_b) / exact - 1));
  }
  EXPECT_GT(printed, 0.9);
  EXPECT_LT(used, kRight);
}

// --- 3.3 -----------------------------------------------------------------------------------------

TEST(Errata, Equation3_52IsZeroAsPrinted) {
  // With r_i the turning axes, (3.51) has d = e = f: the cross products are taken in the wrong
  // order.
  double printed = 0, form_length = 0, used = 0;
  for (const Hinge& hinge : all_hinges()) {
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      const Vector3<S> x = crossed(hinge, bodies);
      return S(x.dot(x) / 2);
    };
    const Vector c_a = hinge.axis_a(2), c_b = hinge.axis_b(2);
    const Vector d = cross(c_a, c_b), e = cross(c_a, c_b), f = cross(c_a, c_b);
    const Velocities form = angular_rows(cross(e, d), cross(d, f));
    const Velocities exact = gradient(C, hinge.bodies);
    printed = std::max(printed, mismatch(form, exact));
    form_length = std::max(form_length, form.norm());
    used = std::max(used, mismatch(angular_row(equations::cross_product_row(c_a, c_b).J_b), exact));
  }
  EXPECT_GT(printed, 0.4);
  EXPECT_EQ(form_length, 0);
  EXPECT_LT(used, kRight);
}

TEST(Errata, Equation3_55TakesTheCrossProductsInTheWrongOrder) {
  double printed = 0, used = 0;
  for (const Hinge& hinge : all_hinges()) {
    const Vector c_a = hinge.axis_a(2), c_b = hinge.axis_b(2);
    const Vector x_a = cross(c_b, c_a), x_b = cross(c_a, c_b);
    for (int i = 0; i < 3; ++i) {
      const auto C = [&](const auto& bodies) { return crossed(hinge, bodies)[i]; };
      const Velocities exact = gradient(C, hinge.bodies);
      // Row i of [x]x is x cross e_i, negative.
      const Vector u = Vector::Unit(i);
      printed = std::max(printed, mismatch(angular_rows(cross(u, x_a), cross(u, x_b)), exact));
      used = std::max(
          used, mismatch(row(equations::cross_product_matrix_row<double>(u, c_a, c_b).J), exact));
    }
  }
  EXPECT_GT(printed, 0.9);
  EXPECT_LT(used, kRight);
}

TEST(Errata, Equation3_58HoldsForThePrintedRowsButNotForTheGradient) {
  // The printed matrices are singular at any error; the true ones where the constraint holds.
  double printed = 0, on = 0;
  for (const Hinge& hinge : hinges({0, 0.7}, {0})) {
    const Vector c_a = hinge.axis_a(2), c_b = hinge.axis_b(2), x = cross(c_a, c_b);
    Eigen::Matrix3d S, A_a, A_b;
    for (int i = 0; i < 3; ++i) {
      const Vector u = Vector::Unit(i);
      const auto J = equations::cross_product_matrix_row<double>(u, c_a, c_b).J;
      S.row(i) = cross(u, x).transpose();
      A_a.row(i) = J.A_a.transpose();
      A_b.row(i) = J.A_b.transpose();
    }
    const Eigen::Matrix3d K_printed = 2 * S * S.transpose();
    const Eigen::Matrix3d K = A_a * A_a.transpose() + A_b * A_b.transpose();
    printed = std::max(printed, std::abs(K_printed.determinant()));
    if (hinge.swing == 0) {
      on = std::max(on, std::abs(K.determinant()));
    } else {
      ASSERT_GT(K.determinant(), 0.48);  // sin^2(2 swing) / 2
    }
  }
  EXPECT_LT(printed, kRight);
  EXPECT_LT(on, 10 * kRight);
}

TEST(Errata, Equation3_61LeavesOutAFactorOfOneHalf) {
  double printed = 0, used = 0;
  for (const Hinge& hinge : all_hinges()) {
    const auto C = [&](const auto& bodies) {
      using S = typename std::decay_t<decltype(bodies.x_a)>::Scalar;
      return S(turn(hinge, bodies).w - S(1));
    };
    const Turn q_a = hinge.frame_a(), q_b = hinge.frame_b();
    const Velocities exact = gradient(C, hinge.bodies);
    const Vector form_a = equations::product(q_b, equations::conjugate(q_a)).v;
    const Vector form_b = equations::product(q_a, equations::conjugate(q_b)).v;
    printed = std::max(printed, mismatch(angular_rows(form_a, form_b), exact));
    used =
        std::max(used, mismatch(angular_row(equations::quaternion_dot_row(q_a, q_b).J_b), exact));
  }
  EXPECT_GT(printed, 0.4);
  EXPECT_LT(used, kRight);
}

// --- A -------------------------------------------------------------------------------------------

TEST(Errata, EquationA_15IsTheAngleOfOneSignOfTheQuaternionOnly) {
  Random random(3);
  double printed = 0, used = 0;
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(0, pi);
    const Turn b = random.turn();
    const Turn a = equations::product(equations::rotation<double>(random.unit(), angle), b);
    for (const double sign : {1.0, -1.0}) {
      const Turn other{sign * a.w, sign * a.v};
      const Turn turn = equations::product(other, equations::conjugate(b));
      const double dot = std::min(1.0, std::max(-1.0, other.w * b.w + other.v.dot(b.v)));
      printed = std::max(printed, std::abs(2 * std::acos(dot) - angle));
      const Vector phi = equations::rotation_vector(turn);
      used = std::max(used, std::abs(std::sqrt(phi.dot(phi)) - angle));
    }
  }
  EXPECT_GT(printed, 5);  // 2 pi - angle for angle
  EXPECT_LT(used, kRight);
}

TEST(Errata, EquationA_25LeavesOutTheAxisOfTheTwist) {
  // What is left of q without its twist has to have no part along the axis v (A.26). As printed,
  // the twist's imaginary part is one number: taken for the first of three.
  double printed = 0, used = 0;
  for (const Hinge& hinge : hinges({0, 1e-8, 1, 2.5}, {0})) {
    const Turn q = turn(hinge, hinge.bodies);
    const auto left = [&](const Turn& twist, const Vector& v) {
      return std::abs(equations::product(equations::conjugate(twist), q).v.dot(v));
    };
    const Vector v = Vector::Unit(2);
    const double s = q.v.dot(v), norm = std::hypot(q.w, s);
    printed = std::max(printed, left({q.w / norm, Vector(s / norm, 0, 0)}, v));
    const auto dot = [&](int i, int j) { return hinge.axis_a(i).dot(hinge.axis_b(j)); };
    const auto used_twist = equations::twist<double>(dot(0, 0), dot(1, 1), dot(1, 0), dot(0, 1));
    const double angle = std::atan2(used_twist.y, used_twist.x);
    used = std::max(used, left(equations::rotation<double>(v, angle), v));
  }
  EXPECT_GT(printed, 0.9);
  EXPECT_LT(used, kRight);
}

}  // namespace
