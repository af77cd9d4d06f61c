#include "degrees.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace drawings {
namespace {

using Six =
    std::array<double,
               6>;  // of a twist: velocity of the frame's origin, angular velocity; in the frame

struct Row {
  Six J;
  bool bounded;
};

// The rows as Bullet's solver gets them.
std::vector<Row> rowsOf(Pair& pair, bool moves_a, const btTransform& frame) {
  pair.joint->constraint().buildJacobian();
  btTypedConstraint::btConstraintInfo1 info_1;
  pair.joint->constraint().getInfo1(&info_1);
  const int count = info_1.m_numConstraintRows;
  struct SolverRow {
    btVector3 linear_a, angular_a, linear_b, angular_b;
    btScalar rhs, cfm, low, high;
  };
  SolverRow blank{};
  blank.low = -SIMD_INFINITY;
  blank.high = SIMD_INFINITY;
  std::vector<SolverRow> rows(std::size_t(count) + 1, blank);
  btTypedConstraint::btConstraintInfo2 info{};
  info.fps = 60;
  info.erp = btScalar(0.2);
  info.m_damping = 1;
  info.m_numIterations = 10;
  info.rowskip = int(sizeof(SolverRow) / sizeof(btScalar));
  info.m_J1linearAxis = rows[0].linear_a;
  info.m_J1angularAxis = rows[0].angular_a;
  info.m_J2linearAxis = rows[0].linear_b;
  info.m_J2angularAxis = rows[0].angular_b;
  info.m_constraintError = &rows[0].rhs;
  info.cfm = &rows[0].cfm;
  info.m_lowerLimit = &rows[0].low;
  info.m_upperLimit = &rows[0].high;
  if (count > 0) pair.joint->constraint().getInfo2(&info);

  std::vector<Row> found;
  const btRigidBody& body = moves_a ? *pair.a : *pair.b;
  const btVector3 lever = frame.getOrigin() - body.getCenterOfMassPosition();
  for (int i = 0; i < count; ++i) {
    const SolverRow& row = rows[std::size_t(i)];
    const btVector3& linear = moves_a ? row.linear_a : row.linear_b;
    const btVector3 angular = (moves_a ? row.angular_a : row.angular_b) - lever.cross(linear);
    Row r{{}, row.low > -SIMD_INFINITY || row.high < SIMD_INFINITY};
    for (int k = 0; k < 3; ++k) {
      r.J[std::size_t(k)] = double(linear.dot(frame.getBasis().getColumn(k)));
      r.J[std::size_t(k) + 3] = double(angular.dot(frame.getBasis().getColumn(k)));
    }
    found.push_back(r);
  }
  return found;
}

double dot(const Six& x, const Six& y) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += x[i] * y[i];
  return sum;
}

// An orthonormal basis of what the equalities span.
std::vector<Six> spanOfEqualities(const std::vector<Row>& rows) {
  std::vector<Six> basis;
  for (const Row& row : rows) {
    if (row.bounded) continue;
    Six rest = row.J;
    for (int pass = 0; pass < 2; ++pass)
      for (const Six& b : basis) {
        const double part = dot(rest, b);
        for (std::size_t i = 0; i < 6; ++i) rest[i] -= part * b[i];
      }
    const double length = std::sqrt(dot(rest, rest));
    if (length <= 1e-3 * std::sqrt(dot(row.J, row.J))) continue;  // says nothing new
    for (double& x : rest) x /= length;
    basis.push_back(rest);
  }
  return basis;
}

bool meetsLimit(const MakeJoint& make, const Poses& poses, bool moves_a, const btTransform& frame,
                int k, bool turns) {
  for (int i = 1; i <= 16; ++i)
    for (const int sign : {-1, 1}) {
      btVector3 axis(0, 0, 0);
      axis[k] = 1;
      const btScalar way = btScalar(sign * i) * (turns ? 5 * SIMD_RADS_PER_DEG : btScalar(0.0625));
      const btTransform motion = turns ? btTransform(btQuaternion(axis, way))
                                       : btTransform(btQuaternion::getIdentity(), way * axis);
      Poses moved = poses;
      btTransform& pose = moves_a ? moved.a : moved.b;
      const btTransform to = frame * motion;
      pose = to * frame.inverse() * pose;
      Pair pair(moved, make);
      for (const Row& row : rowsOf(pair, moves_a, to))
        if (row.bounded) return true;
    }
  return false;
}

}  // namespace

Pair::Pair(const Poses& poses, const MakeJoint& make) {
  const auto body = [](const btTransform& pose) {
    auto made = std::make_unique<btRigidBody>(1, nullptr, nullptr, btVector3(1, 1, 1));
    made->setCenterOfMassTransform(pose);
    made->updateInertiaTensor();
    return made;
  };
  a = body(poses.a);
  b = body(poses.b);
  joint = make(*a, *b);
}

const char* name(Freedom freedom) {
  switch (freedom) {
    case Freedom::held: return "held";
    case Freedom::limited: return "limited";
    case Freedom::free: break;
  }
  return "free";
}

Degrees degreesOf(const MakeJoint& make, const Poses& poses, bool moves_a,
                  const btTransform& frame) {
  Pair pair(poses, make);
  const std::vector<Six> held = spanOfEqualities(rowsOf(pair, moves_a, frame));
  Degrees found;
  for (int i = 0; i < 6; ++i) {
    double part = 0;
    for (const Six& b : held) part += b[std::size_t(i)] * b[std::size_t(i)];
    if (part > 0.02 && part < 0.98)
      throw std::logic_error(std::string(pair.joint->name()) +
                             ": a degree of freedom is held in part: choose another frame");
    const bool turns = i >= 3;
    const Freedom freedom = part > 0.5 ? Freedom::held
                            : meetsLimit(make, poses, moves_a, frame, i % 3, turns)
                                ? Freedom::limited
                                : Freedom::free;
    (turns ? found.turn : found.slide)[i % 3] = freedom;
  }
  return found;
}

}  // namespace drawings
