// Helpers of the equations' tests: two bodies with a hinge between them, moved by their twelve
// velocities (v_a, w_a, v_b, w_b), and the gradient of a position constraint by these velocities,
// by automatic differentiation and by central differences.
#pragma once

#include <pintle/equations/position.h>
#include <pintle/equations/quaternion.h>

#include <cmath>
#include <limits>
#include <random>
#include <unsupported/Eigen/AutoDiff>
#include <vector>

namespace autodiff {

using pintle::cross;
using pintle::Matrix3;
using pintle::pi;
using pintle::Quaternion;
using pintle::Vector3;
using Vector = Vector3<double>;
using Turn = Quaternion<double>;
using Velocities = Eigen::Matrix<double, 12, 1>;
using Dual = Eigen::AutoDiffScalar<Velocities>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The step of the central differences, near the cube root of epsilon: their error is its square
/// (4e-11) times the third derivative, and about as much by rounding.
constexpr double step = 6e-6;
/// What follows for constraints whose third derivatives and values are of the order of 1 to 10.
constexpr double difference_tolerance = 1e-9;

/// What a right equation leaves: about as many roundings lie between the poses and an entry.
constexpr double kRight = 20 * epsilon;

/// A NaN that comes to it stays, unlike with std::max.
inline double greatest(double so_far, double value) { return so_far > value ? so_far : value; }

/// A hinge's gaps (m; nothing, a little, more than the bodies' size) and swings (rad) that most rows are looked at for.
inline const std::vector<double> kGaps = {0, 1e-8, 0.5, 4};
inline const std::vector<double> kSwings = {0, 1e-8, -pi, pi - 1e-8, pi};

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(unsigned seed) : m_generator(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (double(m_generator()) / 4294967296.0);
  }
  Vector vector(double size = 1) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }
  Vector unit() {
    for (;;) {
      const Vector v = vector();
      const double length2 = v.dot(v);
      if (length2 > 0.01 && length2 < 1) return v / std::sqrt(length2);
    }
  }
  Turn turn() {
    const Vector axis = unit();
    return pintle::equations::rotation<double>(axis, uniform(-2 * pi, 2 * pi));
  }
  Velocities velocities() {
    Velocities v;
    for (int i = 0; i < 12; ++i) v[i] = uniform(-1, 1);
    return v;
  }
  /// A symmetric positive definite matrix, with no two moments alike.
  Matrix3<double> inertia() {
    Matrix3<double> A;
    for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform(-1, 1);
    return A * A.transpose() + 0.1 * Matrix3<double>::Identity();
  }

 private:
  std::mt19937 m_generator;
};

template <class T>
Matrix3<T> matrix(const Quaternion<T>& q) {
  Matrix3<T> R;
  for (int i = 0; i < 3; ++i) {
    Vector3<T> e(T(0), T(0), T(0));
    e[i] = T(1);
    R.col(i) = pintle::equations::rotate(q, e);
  }
  return R;
}

template <class T>
struct Bodies {
  Vector3<T> x_a;
  Quaternion<T> q_a;
  Vector3<T> x_b;
  Quaternion<T> q_b;
};

template <class T>
Vector3<T> constant(const Vector& v) {
  return {T(v.x()), T(v.y()), T(v.z())};
}
template <class T>
Quaternion<T> constant(const Turn& q) {
  return {T(q.w), constant<T>(q.v)};
}
/// x + v t, exp(w t / 2) q: the motion at constant velocities.
inline Bodies<double> moved(const Bodies<double>& bodies, const Velocities& v, double t) {
  const auto turned = [t](const Vector& w, const Turn& q) {
    const double speed = std::sqrt(w.dot(w));
    if (speed == 0) return q;
    return pintle::equations::product(pintle::equations::rotation<double>(w / speed, speed * t), q);
  };
  return {bodies.x_a + t * v.segment<3>(0), turned(v.segment<3>(3), bodies.q_a),
          bodies.x_b + t * v.segment<3>(6), turned(v.segment<3>(9), bodies.q_b)};
}

/// The same to first order at t = 0, with the twelve velocities as the variables.
inline Bodies<Dual> variable(const Bodies<double>& bodies) {
  const auto seeds = [](int first, double factor) {
    Vector3<Dual> v;
    for (int i = 0; i < 3; ++i) v[i] = Dual(0, Velocities(factor * Velocities::Unit(first + i)));
    return v;
  };
  const auto turned = [&](int first, const Turn& q) {
    return pintle::equations::product(Quaternion<Dual>{Dual(1), seeds(first, 0.5)},
                                      constant<Dual>(q));
  };
  return {constant<Dual>(bodies.x_a) + seeds(0, 1), turned(3, bodies.q_a),
          constant<Dual>(bodies.x_b) + seeds(6, 1), turned(9, bodies.q_b)};
}

template <class C>
Velocities gradient(const C& c, const Bodies<double>& bodies) {
  const Dual value = c(variable(bodies));
  return value.derivatives();
}

template <class C>
Velocities difference(const C& c, const Bodies<double>& bodies) {
  Velocities g;
  for (int i = 0; i < 12; ++i) {
    const Velocities v = Velocities::Unit(i);
    g[i] = (c(moved(bodies, v, step)) - c(moved(bodies, v, -step))) / (2 * step);
  }
  return g;
}

/// d^2/dt^2 of f at 0, with an error of h^4/90 times the sixth derivative.
template <class F>
auto second_difference(const F& f, double h) {
  using Value = decltype(f(h));
  return Value((16.0 * (f(h) + f(-h)) - (f(2 * h) + f(-2 * h)) - 30.0 * f(0.0)) / (12 * h * h));
}

/// The twelve entries of a row.
template <class T>
Velocities row(const pintle::equations::Jacobian<T>& J) {
  Velocities r;
  r << -J.L.template cast<double>(), -J.A_a.template cast<double>(), J.L.template cast<double>(),
      J.A_b.template cast<double>();
  return r;
}
template <class T>
Velocities angular_row(const Vector3<T>& J_b) {
  return row(pintle::equations::Jacobian<T>{Vector3<T>::Zero(), J_b, J_b});
}

/// The greatest of the absolute differences.
template <class A, class B>
double mismatch(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

// --- a hinge in every state that matters ---------------------------------------------------------

/// Two bodies, the joint's frame in each (axis: the frame's z), the anchors in each, and how the
/// frames were turned against each other: Rz(th/2) exp(swing m) Rz(th/2), times the sign.
struct Hinge {
  Bodies<double> bodies;
  Turn f_a, f_b;
  Vector anchor_a, anchor_b;
  double th, swing;
  Vector m;
  double sign;

  Turn frame_a() const { return pintle::equations::product(bodies.q_a, f_a); }
  Turn frame_b() const { return pintle::equations::product(bodies.q_b, f_b); }
  Vector axis_a(int i) const {
    return pintle::equations::rotate<double>(frame_a(), Vector::Unit(i));
  }
  Vector axis_b(int i) const {
    return pintle::equations::rotate<double>(frame_b(), Vector::Unit(i));
  }
  Vector r_a() const { return pintle::equations::rotate(bodies.q_a, anchor_a); }
  Vector r_b() const { return pintle::equations::rotate(bodies.q_b, anchor_b); }
  Vector d() const { return (bodies.x_b - bodies.x_a) + (r_b() - r_a()); }
  /// From the frame halfway along the twist to the world. (For either sign: -p is p at th + 2 pi,
  /// where this frame has turned by pi and m is -m.)
  Vector halfway(const Vector& v) const {
    const Turn half = pintle::equations::rotation<double>(Vector::Unit(2), th / 2);
    return pintle::equations::rotate(pintle::equations::product(frame_a(), half), v);
  }
};

/// conj(q_a f_a) (q_b f_b), the turn of the frames, for any scalar.
template <class T>
Quaternion<T> turn(const Hinge& hinge, const Bodies<T>& bodies) {
  using pintle::equations::product;
  return pintle::equations::relative(product(bodies.q_a, constant<T>(hinge.f_a)),
                                     product(bodies.q_b, constant<T>(hinge.f_b)));
}

/// Axis i of the joint frame of each body, for any scalar.
template <class T>
Vector3<T> axis_a(const Hinge& hinge, const Bodies<T>& bodies, int i) {
  const auto frame = pintle::equations::product(bodies.q_a, constant<T>(hinge.f_a));
  return pintle::equations::rotate(frame, constant<T>(Vector(Vector::Unit(i))));
}
template <class T>
Vector3<T> axis_b(const Hinge& hinge, const Bodies<T>& bodies, int i) {
  const auto frame = pintle::equations::product(bodies.q_b, constant<T>(hinge.f_b));
  return pintle::equations::rotate(frame, constant<T>(Vector(Vector::Unit(i))));
}

inline Hinge make_hinge(unsigned seed, double th, double swing, double gap, double sign) {
  using pintle::equations::product;
  using pintle::equations::rotation;
  Random random(seed);
  const Turn identity{1, Vector::Zero()};
  const Vector z = Vector::Unit(2);
  Hinge hinge;
  hinge.th = th;
  hinge.swing = swing;
  hinge.sign = sign;
  const double direction = random.uniform(-pi, pi);
  hinge.m = Vector(std::cos(direction), std::sin(direction), 0);
  // Every fifth seed is at the identity, every seventh has the bodies' own axes for frames.
  hinge.bodies.q_a = seed % 5 == 0 ? identity : random.turn();
  hinge.f_a = seed % 7 == 0 ? identity : random.turn();
  hinge.f_b = seed % 7 == 0 ? identity : random.turn();
  const Turn half = rotation<double>(z, th / 2);
  const Turn p = product(product(half, rotation<double>(hinge.m, swing)), half);
  const Turn f_b_inverse = pintle::equations::conjugate(hinge.f_b);
  const Turn q_b = product(product(hinge.frame_a(), p), f_b_inverse);
  hinge.bodies.q_b = {sign * q_b.w, sign * q_b.v};
  hinge.anchor_a = random.vector(2);
  hinge.anchor_b = random.vector(2);
  hinge.bodies.x_a = random.vector(3);
  hinge.bodies.x_b = hinge.bodies.x_a + hinge.r_a() - hinge.r_b() + gap * random.unit();
  return hinge;
}

/// `seeds` hinges at each of the twists (0, 1e-8, random, and pi from both sides to 1e-8 and
/// exactly), of both quaternion signs, with the swings and gaps given in turn; a negative swing
/// stands for a random one, up to its size.
inline std::vector<Hinge> hinges(const std::vector<double>& swings, const std::vector<double>& gaps,
                                 unsigned seeds = 200) {
  std::vector<Hinge> all;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    Random random(1000 + seed);
    const double any = random.uniform(-pi, pi);
    for (const double th : {0.0, 1e-8, any, pi, -pi, pi - 1e-8, 1e-8 - pi}) {
      const double given = swings[all.size() / 2 % swings.size()];
      const double swing = given < 0 ? random.uniform(0, -given) : given;
      const double gap = gaps[seed % gaps.size()];
      for (const double sign : {1.0, -1.0}) all.push_back(make_hinge(seed, th, swing, gap, sign));
    }
  }
  return all;
}

// --- what the rows of two anchors are made of ---------------------------------------------------

// Levers and gap are at most about 8 long: what the rounding of their entries is a multiple of.
inline double size(const Hinge& hinge) {
  return 1 + hinge.r_a().cwiseAbs().maxCoeff() + hinge.r_b().cwiseAbs().maxCoeff() +
         hinge.d().cwiseAbs().maxCoeff();
}

template <class T>
Vector3<T> arm(const Quaternion<T>& q, const Vector& anchor) {
  return pintle::equations::rotate(q, constant<T>(anchor));
}

template <class T>
Vector3<T> error(const Hinge& hinge, const Bodies<T>& bodies) {
  return pintle::equations::position_error(bodies.x_a, arm(bodies.q_a, hinge.anchor_a), bodies.x_b,
                                           arm(bodies.q_b, hinge.anchor_b));
}

template <class T>
pintle::equations::Anchors<T> anchors(const Hinge& hinge) {
  return {hinge.r_a().cast<T>(), hinge.r_b().cast<T>(), hinge.d().cast<T>()};
}

template <class T>
pintle::equations::Velocity<T> velocity(const Velocities& v) {
  return {v.segment<3>(0).cast<T>(), v.segment<3>(3).cast<T>(), v.segment<3>(6).cast<T>(),
          v.segment<3>(9).cast<T>()};
}

/// The angular momentum about the origin that one unit of the row's impulse adds.
inline Vector added_momentum(const Hinge& hinge, const Velocities& J) {
  return cross(hinge.bodies.x_a, J.segment<3>(0)) + J.segment<3>(3) +
         cross(hinge.bodies.x_b, J.segment<3>(6)) + J.segment<3>(9);
}

/// A five-point second difference at this step: h^4/90 |w|^6 r is below 1e-9 for the speeds below 2
/// and levers below 5 here, and rounding, epsilon / h^2 times some 10, below 1e-10.
constexpr double kCurvatureStep = 5e-3, kCurvatureTolerance = 1e-8;

using Dense = Eigen::Matrix<double, 12, 12>;

template <class T>
pintle::equations::InverseMass<T> any_mass(Random& random) {
  const double m_a = random.uniform(0.01, 10), m_b = random.uniform(0.01, 10);
  const Matrix3<double> I_a = random.inertia(), I_b = random.inertia();
  return {T(m_a), T(m_b), I_a.cast<T>(), I_b.cast<T>()};
}

template <class T>
Dense dense(const pintle::equations::InverseMass<T>& M) {
  Dense m = Dense::Zero();
  m.block<3, 3>(0, 0) = double(M.m_a) * Matrix3<double>::Identity();
  m.block<3, 3>(3, 3) = M.I_a.template cast<double>();
  m.block<3, 3>(6, 6) = double(M.m_b) * Matrix3<double>::Identity();
  m.block<3, 3>(9, 9) = M.I_b.template cast<double>();
  return m;
}

}  // namespace autodiff
