// Purpose: bodies and joints of one island as plain numbers, for one step.
#pragma once

#include <pintle/finite.h>
#include <pintle/rows/row.h>
#include <pintle/rows/row_shape.h>
#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/axis_law.h>
#include <pintle/solver/model/turn.h>
#include <pintle/vectors.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

class btTypedConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

class Joint;
using Vector6d = Eigen::Matrix<double, 6, 1>;

inline Vector3d inDouble(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}
inline Vector3d inDouble(const Vec3& v) { return v.cast<double>(); }
inline Matrix3d inDouble(const btMatrix3x3& m) {
  Matrix3d to;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) to(i, j) = double(m[i][j]);
  return to;
}
inline btVector3 toBullet(const Vector3d& v) { return {Scalar(v[0]), Scalar(v[1]), Scalar(v[2])}; }
/// Of one of Bullet's bodies: the velocity that forces lead to.
inline Vector6d freeVelocity(const btSolverBody& of) {
  Vector6d v;
  v << inDouble(of.m_linearVelocity) + inDouble(of.m_externalForceImpulse),
      inDouble(of.m_angularVelocity) + inDouble(of.m_externalTorqueImpulse);
  return v;
}

/// The larger one of `most` and |left|; infinity where that is not a number.
inline double larger(double most, double left) {
  return std::abs(left) <= most ? most : isNumber(left) ? std::abs(left) : infinity;
}

/// d u / d(velocities): of body a and of body b, each linear and angular.
struct RowJacobian {
  Vector3d L_a, A_a, L_b, A_b;

  // Of body a (0) or b (1).
  const Vector3d& L(int side) const { return side ? L_b : L_a; }
  const Vector3d& A(int side) const { return side ? A_b : A_a; }
  double along(int side, const Vector6d& v) const {
    return L(side).dot(v.head<3>()) + A(side).dot(v.tail<3>());
  }
  double along(const Vector6d& a, const Vector6d& b) const {
    return L_a.dot(a.head<3>()) + A_a.dot(a.tail<3>()) + L_b.dot(b.head<3>()) +
           A_b.dot(b.tail<3>());
  }
};

/// Bullet's solver turns the body's velocity as a rotor's.
inline bool isGyroscopic(const btRigidBody& body) {
  return (body.getFlags() &
          (BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT | BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD |
           BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY)) != 0;
}

/// A rigid body that joints hold. World space; of vectors of six the first three are linear.
struct IslandBody {
  IslandBody() {}    // leaves what its maker sets as it is
  double mass;       ///< kg
  Matrix3d inertia;  ///< kg m^2
  Vector6d v0;       ///< at the start of the step
  Vector6d v_free;   ///< v*: with the step's forces, without its impulses
  /// v* - v0 by forces, without Bullet's gyroscopic term; and the work of that term, J, which is its error.
  Vector6d by_forces;
  double gyroscopic_work;
  /// The second half of gravity acts when it has moved (half_forces.h): then it turns as a rotor, if any of its gyroscopic flags is set.
  bool acts_in_halves;
  Vector6d by_forces_at_end;

  Vector3d inverse_mass;       ///< where its factors let it move
  Matrix3d inverse_inertia;    ///< where its factors let it turn
  double scale[2];             ///< square roots of the mass, and of a mean of the inertia
  double inverse_scale2[2];    ///< of their squares
  double least_inertia;        ///< kg m^2: about any axis
  std::array<bool, 6> locked;  ///< axes of the world along which its factors hold it
  bool follows;  ///< it moves along all axes and turns about all: no row's K is rounding alone

  const btRigidBody* body;
  int solver_body;    ///< its number among Bullet's
  btTransform start;  ///< pose
  /// With which contacts move its pose out of others in this step, beside its velocity.
  Vector6d push;

  /// a M b
  double product(const Vector6d& a, const Vector6d& b) const {
    return mass * a.head<3>().dot(b.head<3>()) + a.tail<3>().dot(inertia * b.tail<3>());
  }
  /// Its part of J_1 M^-1 J_2^T, as body `side` of a joint.
  double inverseMass(const RowJacobian& J_1, const RowJacobian& J_2, int side) const {
    const double K = J_1.A(side).dot(inverse_inertia * J_2.A(side));
    return K + J_1.L(side).dot(inverse_mass.cwiseProduct(J_2.L(side)));
  }
  /// It has no axis of its own about which it does not turn.
  bool isRotor() const { return acts_in_halves && follows && isGyroscopic(*body); }
  /// m: of gyration.
  double radius() const { return scale[1] / scale[0]; }
  /// M^-1 of an impulse, N s and N m s: 0 where its factors hold it.
  Vector6d answer(const Vector3d& linear, const Vector3d& angular) const {
    Vector6d to;
    to << inverse_mass.cwiseProduct(linear), inverse_inertia * angular;
    return to;
  }
};

/// A body at the end of the step, from its start.
struct MovedBody {
  Vector6d v;     ///< with which it came there
  Vector3d move;  ///< m
  Matrix3d turn;

  MovedBody(const Vector6d& velocity, double dt)
      : MovedBody(velocity, dt, RotationOfStep(velocity.tail<3>(), dt).matrix()) {}
  MovedBody(const Vector6d& velocity, double dt, const Matrix3d& rotation)
      : v(velocity), move(dt * velocity.head<3>()), turn(rotation) {}

  /// On from there, by `part` of the way of w in a step.
  void goOn(const Vector6d& w, double dt, double part = 1) {
    v += part * w;
    move += part * dt * w.head<3>();
    turn = RotationOfStep(w.tail<3>(), dt, part).matrix() * turn;
  }
  btTransform from(const btTransform& start) const {
    if (v.isZero(0)) return start;
    const Matrix3d& R = turn;
    const btMatrix3x3 turned(Scalar(R(0, 0)), Scalar(R(0, 1)), Scalar(R(0, 2)), Scalar(R(1, 0)),
                             Scalar(R(1, 1)), Scalar(R(1, 2)), Scalar(R(2, 0)), Scalar(R(2, 1)),
                             Scalar(R(2, 2)));
    return btTransform(
        turned * start.getBasis(),
        start.getOrigin() + btVector3(Scalar(move[0]), Scalar(move[1]), Scalar(move[2])));
  }
};
/// J of a row of ours: [-L, -A_a, L, A_b], times the sign with which a coordinate moves along it.
inline RowJacobian jacobianOf(const Row& row, double sign) {
  const Vector3d L = sign * row.L.cast<double>();
  return {-L, -sign * row.A_a.cast<double>(), L, sign * row.A_b.cast<double>()};
}

/// Of a soft equality, or of a soft stop that is reached. It gives like a spring, which starts without tension wherever it is: what the
/// step's velocities stretch it by pulls it back, and what it was open by before moves poses.
struct RowSpring {
  double erp = 0;
  double open = 0;     ///< ERP times C, m or rad
  double stretch = 0;  ///< the part of it that pulls
  int part = 0;        ///< of the law of the row, which it is

  double length(double u, double dt) const { return stretch + erp * dt * u; }
  /// J, before the step and after it: never more than it was given.
  double energy(double softness, double dt) const {
    return stretch * stretch / (2 * erp * dt * dt * softness);
  }
  double energyAfter(double u, double lambda, double softness, double dt) const {
    const double l = length(u, dt);
    return std::fmax(
        0, std::fmin(l * l / (2 * erp * dt * dt * softness), energy(softness, dt) - lambda * u));
  }
  /// How far it is stretched by that energy.
  double stretchOf(double energy, double softness, double dt) const {
    return dt * std::sqrt(2 * erp * softness * energy);
  }
};

/// What few rows have.
struct RowExtras {
  LawPart parts[AxisLaw::max_parts];
  RowSpring spring;
  double rebound_energy;  ///< J: what its limit took when it was met, which a rebound may give back
  bool keeps_for_rebound;  ///< what its limit takes in this step, for the next one
  Row turned;  ///< at the end of what forces lead to, where that is another one (turnStops)
};

/// A row at the start of the step. Its velocity u is the mean over the step of what it measures: (C(end) - C(start)) / dt, or,
/// of a row that is known at the start alone, J v.
struct IslandRow {
  IslandRow() {}  // leaves what its maker sets as it is: to zero it all takes time
  RowJacobian J;
  bool has_position;  ///< whether C can be asked for at other poses
  /// An angle that may change by more than half a turn in the step: then poses do not tell by how much.
  bool spins = false;
  /// Rigid stops of an angle, and nothing else that asks where it is.
  bool has_stops_alone = false;
  bool shares_arms = false;  ///< has those of the row before it
  signed char sign = 1;      ///< of J against start: coordinates of an axis may fall along its row
  int index;                 ///< among the rows of the joint
  RowShape shape;
  AxisLaw law;
  double K;                    ///< J M^-1 J^T
  double root_K, by_root_K;    ///< its square root, and 1 over that
  double open = 0;             ///< C of an equality, m or rad: what is to be closed by moving poses
  const Row* start = nullptr;  ///< as the joint has it, in its memory; null: a row of Bullet's
  RowExtras* extras = nullptr;

  bool isOfAxis() const { return start != nullptr && start->axis >= 0; }
  /// Whether what it measures follows from two arms of the bodies (RowShape), without asking the joint.
  bool isOfArms() const { return shape.kind <= RowShape::distance; }
  bool isOfAngle() const { return shape.kind == RowShape::angle || shape.kind == RowShape::turn; }
  /// Whether the direction of a stop may turn over in the step.
  bool mayTurnStops() const {
    return isOfAxis() && start->limit && start->angular && has_position && !isOfArms() &&
           !has_stops_alone;
  }
  bool isSoft() const { return extras != nullptr && extras->spring.erp > 0; }
  /// Of one that is soft.
  double softness() const { return law.part(extras->spring.part).softness; }
  /// Whether it is beyond a soft stop.
  bool hasSoftStop() const { return isSoft() && law.part(extras->spring.part).gives; }
  double reboundEnergy() const { return extras != nullptr ? extras->rebound_energy : 0; }
  bool keepsForRebound() const { return extras != nullptr && extras->keeps_for_rebound; }
  /// Whether u = J v is far from both, where bodies turn by `turn` (rad) in the step: what else they measure by then is of its square.
  bool isFarFromStops(double straight, double turn, double dt) const {
    for (int i = 0; i < law.parts(); ++i) {
      const LawPart& part = law.part(i);
      if (part.drives) continue;
      const double left = part.isLowerStop() ? straight - part.target : part.target - straight;
      if (!(left * dt > turn * turn)) return false;
    }
    return true;
  }
  void setK(double of) {
    K = of;
    root_K = std::sqrt(K);
    by_root_K = 1 / root_K;
  }
};

struct IslandJoint {
  btTypedConstraint* constraint;
  Joint* ours;              ///< null: a joint of Bullet's
  std::array<int, 2> body;  ///< one that nothing moves: below 0 (Island::unmoved)
  int first_row, rows;
  int row_of_component;  ///< where its rows begin among those of its component
  int equalities;        ///< that come first; of a joint of ours those of addRows

  // What its rows are: so passes go by those of joints that do not concern them.
  int bounded;        ///< so many are no equalities
  double error;       ///< m or rad: the largest C of equalities that are of no axis
  double open;        ///< m or rad: the most that poses are to close, or more
  double lever[2];    ///< m: the longest of each body on which a row holds a point or a distance
  unsigned on_lever;  ///< a bit for each row that does
  bool has_axes, has_springs, may_turn_stops;
  bool drives;             ///< some work by themselves, as motors do, and rebounds
  bool keeps_for_rebound;  ///< stops may, what they take

  /// When its law is known, and what is open.
  void add(const IslandRow& row) {
    ++rows;
    open = std::max(open, std::abs(row.open));
    const bool is_of_axis = row.isOfAxis();
    has_axes = has_axes || is_of_axis;
    drives = drives || row.law.hasDrives();
    if (row.extras != nullptr) {
      has_springs = has_springs || row.isSoft();
      drives = drives || row.reboundEnergy() > 0;
      keeps_for_rebound = keeps_for_rebound || row.extras->keeps_for_rebound;
    }
    if (!row.law.isEquality())
      ++bounded;
    else if (row.start != nullptr && !is_of_axis)
      error = std::max(error, std::abs(double(row.start->position)));
  }
  /// None of its rows acts any more.
  void release() {
    bounded = rows;
    error = open = 0;
    has_springs = drives = keeps_for_rebound = false;
  }
  bool isOnLever(int i) const { return (on_lever >> i & 1) != 0; }
  /// When the shapes of its rows are known.
  void finishShapes(IslandRow* of) {
    for (int i = 0; i < rows; ++i) {
      const RowShape& shape = of[i].shape;
      may_turn_stops = may_turn_stops || of[i].mayTurnStops();
      of[i].shares_arms = i > 0 && shape.kind == of[i - 1].shape.kind &&
                          shape.a == of[i - 1].shape.a && shape.b == of[i - 1].shape.b;
      if (!of[i].has_position ||
          (shape.kind != RowShape::point && shape.kind != RowShape::distance))
        continue;
      on_lever |= 1u << i;
      if (of[i].shares_arms && isOnLever(i - 1)) continue;
      lever[0] = std::fmax(lever[0], inDouble(shape.a).norm());
      lever[1] = std::fmax(lever[1], inDouble(shape.b).norm());
    }
  }
};

struct Island {
  /// Bodies that nothing moves, but their owner: 0 is at rest, the others are kinematic.
  static constexpr int at_rest = 0;
  static int unmoved(int body) { return -1 - body; }

  double dt;
  std::vector<MovedBody> unmoved_bodies;
  std::vector<IslandBody> bodies;
  std::vector<IslandJoint> joints;
  std::vector<IslandRow> rows;
  Pool<RowExtras> extras;

  RowExtras& giveExtras(IslandRow& row) {
    row.extras = &extras.take();
    row.extras->spring = {};
    row.extras->rebound_energy = 0;
    row.extras->keeps_for_rebound = false;
    return *row.extras;
  }

  size_t bytes() const { return bytesOf(unmoved_bodies, bodies, joints, rows) + extras.bytes(); }
  /// J_1 M^-1 J_2^T
  double inverseMass(const IslandJoint& joint, const RowJacobian& J_1,
                     const RowJacobian& J_2) const {
    double K = 0;
    for (int side = 0; side < 2; ++side)
      if (const int body = joint.body[size_t(side)]; body >= 0)
        K += bodies[size_t(body)].inverseMass(J_1, J_2, side);
    return K;
  }
  const Vector6d& velocity(int body, Vector6d IslandBody::*v) const {
    return body < 0 ? unmovedBody(body).v : bodies[size_t(body)].*v;
  }
  /// Of velocities `v`, which are those of the bodies from `first` on.
  const Vector6d& velocity(int body, const Vector6d* v, int first = 0) const {
    return body < 0 ? unmovedBody(body).v : v[body - first];
  }
  /// Whether any body that nothing else moves is moved by its owner.
  bool anyUnmovedMoves() const { return unmoved_bodies.size() > 1; }
  /// J v of those bodies of a joint that nothing moves, but their owner.
  double velocityOfUnmoved(const IslandJoint& joint, const RowJacobian& J) const {
    double u = 0;
    for (int side = 0; side < 2; ++side)
      if (const int body = joint.body[size_t(side)]; body < 0)
        u += J.along(side, unmovedBody(body).v);
    return u;
  }
  const MovedBody& unmovedBody(int body) const { return unmoved_bodies[size_t(unmoved(body))]; }
};

/// Joints and bodies that hang together: ranges of an island's.
struct Component {
  int first_body = 0, bodies = 0, first_joint = 0, joints = 0;
  // Of all its joints:
  int rows = 0;
  double lever = 0;          ///< m: the longest
  bool is_anchored = false;  ///< one holds on to a body that does not move, or that its owner moves
};

/// Forces act half before and half after its bodies move (half_forces.h): all of them, or none.
inline bool actsInHalves(const Island& island, const Component& component) {
  return component.bodies > 0 && island.bodies[size_t(component.first_body)].acts_in_halves;
}

/// visit(number of the joint in the component, number of the row in the joint, row, its number in the component)
template <class Visit>
void forEachRow(const Island& island, const Component& component, const Visit& visit) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i)
      visit(c, i, island.rows[size_t(joint.first_row + i)], size_t(joint.row_of_component + i));
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
