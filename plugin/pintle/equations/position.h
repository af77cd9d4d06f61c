// Purpose: the full position constraint (document, section 3.1.3): the anchors p_a and p_b coincide.
//   C = d = p_b - p_a                                      m, world
//   J = [-D, -[r_a]x^T.., D, ..]: row u is [-u, -(lever x u), u, r_b x u]
// Terms, world space: r_a = p_a - x_a, r_b = p_b - x_b, d, and a unit vector u for each row.
#pragma once

#include <pintle/equations/effective_mass.h>
#include <pintle/equations/velocity.h>

#include <algorithm>

namespace pintle::equations {

/// Where a joint holds its bodies: the levers of both anchors and the gap between them.
template <class T>
struct Anchors {
  Vector3<T> r_a, r_b, d;
};

/// One row with a linear part: J and its position error C.
template <class T>
struct LinearRow {
  Jacobian<T> J;
  T C;
};

/// d, in the order of operations that keeps its digits far from the origin.
template <class X, class R>
auto position_error(const X& x_a, const R& r_a, const X& x_b, const R& r_b) {
  return Vector3<typename X::Scalar>((x_b - x_a) + (r_b - r_a));                          // (3.6)
}

/// The document's row: u is fixed in the world, each body is held at its own anchor. The two levers
/// differ by d, so that while the joint is violated the row's impulse adds angular momentum u x d.
template <class T>
Jacobian<T> position_row(const Vector3<T>& u, const Vector3<T>& r_a, const Vector3<T>& r_b) {
  return {u, cross(r_a, u), cross(r_b, u)};                                               // (3.7)
}

/// The same for u the i-th axis of the world.
template <int i, class T>
Jacobian<T> position_row_world(const Vector3<T>& r_a, const Vector3<T>& r_b) {
  return {Vector3<T>::Unit(i), cross_unit<i>(r_a), cross_unit<i>(r_b)};
}

/// The same with u fixed in body a: w_a x u is then a part of dC/dt, which moves the lever of body a
/// to p_b. Both bodies are held at one point, and angular momentum is conserved at any violation.
template <class T>
Jacobian<T> position_row_conserving(const Vector3<T>& u, const Vector3<T>& r_a,
                                    const Vector3<T>& d, const Vector3<T>& r_b) {
  return {u, cross(r_a + d, u), cross(r_b, u)};
}

/// d^2/dt^2 of d at constant v, w: the centripetal part, which J v leaves out. (Of the levers that
/// the rows use.)
template <class T>
Vector3<T> position_curvature(const Vector3<T>& w_a, const Vector3<T>& r_a, const Vector3<T>& w_b,
                              const Vector3<T>& r_b) {
  return cross(w_b, cross(w_b, r_b)) - cross(w_a, cross(w_a, r_a));
}

/// The motion of the end of a lever r that turns by w dt beside dt w x r, as the mean of a second derivative over the step: 2/dt^2 times
///   exp([w dt]x) r - r - dt w x r.
/// The centripetal part alone is a parabola, on which what turns fast gains energy with (w dt)^4. (To the rounding of single precision up to
/// a turn of pi/4, which is the most that Bullet makes of a step; beyond, as at pi/4.)
template <class T>
Vector3<T> chord_curvature(const Vector3<T>& w, const Vector3<T>& r, T dt) {
  constexpr T max_turn2 = T(0.6168502750680849);  // (pi/4)^2
  const T turn2 = std::min(w.dot(w) * dt * dt, max_turn2);
  const Vector3<T> tangent = cross(w, r);
  const T inward = 1 - turn2 / 12 * (1 - turn2 / 30 * (1 - turn2 / 56)),  // 2 (1 - cos t) / t^2
      back = turn2 / 3 * (1 - turn2 / 20 * (1 - turn2 / 42));             // 2 (1 - sin t / t)
  return inward * cross(w, tangent) - back / dt * tangent;
}

/// The same as seen from body a, at any gap: u . this is d^2/dt^2 of u.d with u fixed in body a. The
/// point at p_b of body b may move in body a meanwhile (slide), which adds the Coriolis part.
template <class T>
Vector3<T> position_curvature_conserving(const Anchors<T>& at, const Velocity<T>& v) {
  const Vector3<T> lever_a = at.r_a + at.d, slide = relative_velocity(v, lever_a, at.r_b);
  // position_curvature - 2 w_a x slide, with what w_a turns as one.
  return cross(v.w_b, cross(v.w_b, at.r_b)) - cross(v.w_a, cross(v.w_a, lever_a) + T(2) * slide);
}

/// K of the three world rows as one block.
template <class T>
Matrix3<T> position_inverse_mass(const InverseMass<T>& M, const Vector3<T>& r_a,
                                 const Vector3<T>& r_b) {
  const auto skew = [](const Vector3<T>& r) {
    Matrix3<T> m;
    m << T(0), -r.z(), r.y(), r.z(), T(0), -r.x(), -r.y(), r.x(), T(0);
    return m;
  };
  const Matrix3<T> r_ax = skew(r_a), r_bx = skew(r_b);
  return (M.m_a + M.m_b) * Matrix3<T>::Identity() + r_ax * M.I_a * r_ax.transpose() +
         r_bx * M.I_b * r_bx.transpose();                                                 // (3.8)
}

}  // namespace pintle::equations
