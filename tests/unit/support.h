// What the tests of the contract and of the drop-in share: repeatable random poses, bodies without
// a world, and the rows of a joint as Bullet's solver would ask for them.
#pragma once

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <pintle/joints/joint.h>
#include <scenes/world.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <ostream>
#include <random>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace support {

constexpr bool is_double = sizeof(btScalar) == sizeof(double);
// How many of `n` random trials are run. Sanitizers look at the memory, not at the numbers: the first ones
// go through the code.
#ifdef PINTLE_SANITIZED
constexpr int trials(int n) { return (n + 19) / 20; }
#else
constexpr int trials(int n) { return n; }
#endif

constexpr btScalar nan_value = std::numeric_limits<btScalar>::quiet_NaN();
constexpr btScalar infinite = std::numeric_limits<btScalar>::infinity();

inline btScalar scalar(double value) { return static_cast<btScalar>(value); }
inline btVector3 vec(double x, double y, double z) { return {scalar(x), scalar(y), scalar(z)}; }
inline bool is_finite(const btVector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}
inline bool is_finite(const btTransform& t) {
  return is_finite(t.getOrigin()) && is_finite(t.getBasis()[0]) && is_finite(t.getBasis()[1]) &&
         is_finite(t.getBasis()[2]);
}
inline bool is_finite(const btRigidBody& body) {
  return is_finite(body.getCenterOfMassTransform()) && is_finite(body.getLinearVelocity()) &&
         is_finite(body.getAngularVelocity());
}

/// The same numbers with every standard library: its distributions are not, so none is used.
class Random {
 public:
  explicit Random(unsigned seed) : m_engine(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (double(m_engine()) / 4294967296.0);
  }
  btVector3 vector(double half_side) {
    const double x = uniform(-half_side, half_side), y = uniform(-half_side, half_side);
    return vec(x, y, uniform(-half_side, half_side));
  }
  btVector3 unit() {
    for (;;) {
      const btVector3 v = vector(1);
      if (v.length2() > scalar(0.01) && v.length2() < 1) return v.normalized();
    }
  }
  btTransform pose(double half_side) {
    const btVector3 axis = unit();
    const btQuaternion q(axis, scalar(uniform(-scenes::pi, scenes::pi)));
    return btTransform(q, vector(half_side));
  }

 private:
  std::mt19937 m_engine;
};

/// Pintle's part of a constraint that is one of its joints.
inline pintle::Joint& joint(btTypedConstraint& constraint) {
  return dynamic_cast<pintle::Joint&>(constraint);
}

/// Lets a joint that starts apart close by its ERP alone, with no bound on the speed.
template <class Joint>
void closeByErpAlone(Joint& joint) {
  if constexpr (std::is_base_of_v<pintle::Joint, Joint>)
    joint.setMaxLinearCorrectionSpeed(scalar(1e9));
}

/// A body that is in no world.
inline std::unique_ptr<btRigidBody> body(double mass, const btVector3& inertia,
                                         const btTransform& pose) {
  auto result = std::make_unique<btRigidBody>(scalar(mass), nullptr, nullptr,
                                              mass > 0 ? inertia : btVector3(0, 0, 0));
  result->setCenterOfMassTransform(pose);
  return result;
}

/// One row as a joint writes it: linear a, angular a, linear b, angular b, then these.
struct RowData {
  static constexpr int size = 16;
  btScalar fields[size];

  btScalar rhs() const { return fields[12]; }
  btScalar cfm() const { return fields[13]; }
  btScalar lower() const { return fields[14]; }
  btScalar upper() const { return fields[15]; }
};

/// What the solver asks of the world in a step.
struct StepInfo {
  double dt = 1.0 / 60;
  double erp = 0.2;
  double cfm = 0;
  int iterations = 10;
};

/// The rows of one joint, in memory that was NaN before the joint wrote to it.
class SolverRows {
 public:
  static constexpr int capacity = 32;

  SolverRows() { clear(); }

  /// As the solver does it in each step.
  static SolverRows ofStep(btTypedConstraint& joint, const StepInfo& info = {}) {
    joint.buildJacobian();
    SolverRows rows;
    rows.ask(joint, info);
    return rows;
  }

  void ask(btTypedConstraint& joint, const StepInfo& info = {}) {
    count(joint);
    fill(joint, info);
  }
  void count(btTypedConstraint& joint) {
    btTypedConstraint::btConstraintInfo1 info1 = {-1, -1};
    joint.getInfo1(&info1);
    m_announced = info1.m_numConstraintRows;
  }
  void fill(btTypedConstraint& joint, const StepInfo& info = {}) {
    clear();
    if (m_announced == 0) return;  // the solver does not ask
    btTypedConstraint::btConstraintInfo2 info2;
    btScalar* first = m_rows[0].fields;
    info2.fps = 1 / scalar(info.dt);
    info2.erp = scalar(info.erp);
    info2.m_J1linearAxis = first;
    info2.m_J1angularAxis = first + 3;
    info2.m_J2linearAxis = first + 6;
    info2.m_J2angularAxis = first + 9;
    info2.rowskip = RowData::size;
    info2.m_constraintError = first + 12;
    info2.cfm = first + 13;
    first[13] = scalar(info.cfm);  // Bullet hands it over in the first row only
    info2.m_lowerLimit = first + 14;
    info2.m_upperLimit = first + 15;
    info2.m_numIterations = info.iterations;
    info2.m_damping = 1;
    joint.getInfo2(&info2);
    m_damping = info2.m_damping;
  }

  int announced() const { return m_announced; }
  /// Rows up to the last one in which anything was written.
  int touched() const {
    for (int i = capacity; i > 0; --i)
      for (int k = 0; k < RowData::size; ++k)
        if (!(i == 1 && k == 13) && !std::isnan((*this)[i - 1].fields[k])) return i;
    return 0;
  }
  /// Every field of every announced row holds a finite number.
  bool finite() const {
    for (int i = 0; i < m_announced; ++i)
      for (const btScalar field : (*this)[i].fields)
        if (!std::isfinite(field)) return false;
    return std::isfinite(m_damping);
  }
  const RowData& operator[](int i) const { return m_rows[size_t(i)]; }
  btScalar damping() const { return m_damping; }

  /// The same bits; NaN is equal to itself.
  friend bool operator==(const SolverRows& a, const SolverRows& b) {
    return a.m_announced == b.m_announced && a.m_damping == b.m_damping &&
           std::memcmp(a.m_rows.data(), b.m_rows.data(), sizeof(a.m_rows)) == 0;
  }
  friend bool operator!=(const SolverRows& a, const SolverRows& b) { return !(a == b); }
  friend std::ostream& operator<<(std::ostream& out, const SolverRows& rows) {
    out.precision(is_double ? 17 : 9);
    for (int i = 0; i < rows.m_announced; ++i) {
      out << "\n  row " << i << ":";
      for (const btScalar field : rows[i].fields) out << ' ' << field;
    }
    return out;
  }

 private:
  void clear() {
    for (RowData& row : m_rows)
      for (btScalar& field : row.fields) field = nan_value;
    m_damping = 1;
  }

  std::array<RowData, capacity> m_rows;
  int m_announced = 0;
  btScalar m_damping = 1;
};

/// The settings of every joint's base class, none at its default.
inline void setBaseSettings(btTypedConstraint& joint, btJointFeedback& feedback) {
  joint.setUserConstraintType(12);
  joint.setUserConstraintId(34);
  joint.setDbgDrawSize(scalar(0.7));
  joint.setOverrideNumSolverIterations(25);
  joint.setBreakingImpulseThreshold(1000);
  joint.setEnabled(false);
  joint.enableFeedback(true);
  joint.setJointFeedback(&feedback);
}

/// The step in which a joint breaks under a load on the free body that grows by 1 N (N m) a step, up to
/// `max_load`; -1: not within 120.
template <class Rig>
int stepOfBreaking(Rig& rig, const btTypedConstraint& joint, const btVector3& force,
                   const btVector3& torque, double max_load = 1000) {
  for (int i = 1; i <= 120; ++i) {
    const btScalar size = scalar(std::min(double(i), max_load));
    rig.free().applyCentralForce(force * size);
    rig.free().applyTorque(torque * size);
    rig.step();
    if (!joint.isEnabled()) return i;
  }
  return -1;
}

/// What a call that must be refused says.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace support
