#include <pintle/solver/model/row_velocities.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/solver/constants.h>
#include <pintle/solver/model/free_rotor.h>
#include <pintle/solver/model/stops.h>

#include <Eigen/QR>
#include <new>
#include <type_traits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// The sum of rows of the end, each by a factor, that is nearest to `row` in the metric of the masses, J M^-1 J^T. Returns false if all
// factors are small.
template <class IsOfThem>
bool findAlong(const Island& island, const IslandJoint& joint, const Row& row, const Rows& end,
               int first, int last, const IsOfThem& isOne, Row& found) {
  constexpr int most = max_joint_rows;
  int those[most], n = 0;
  for (int i = first; i < last; ++i)
    if (end[i].angular == row.angular && isOne(end[i])) those[n++] = i;
  const RowJacobian J = jacobianOf(row, 1);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most> K(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> part(n);
  for (int i = 0; i < n; ++i) {
    const RowJacobian J_i = jacobianOf(end[those[i]], 1);
    part[i] = island.inverseMass(joint, J_i, J);
    for (int k = 0; k <= i; ++k)
      K(i, k) = K(k, i) = island.inverseMass(joint, J_i, jacobianOf(end[those[k]], 1));
  }
  // The least one: rows that repeat each other share it, and such as nobody can move have none.
  part = K.completeOrthogonalDecomposition().solve(part).eval();
  found = row;
  found.L = found.A_a = found.A_b = Vec3::Zero();
  found.position = 0;
  bool any = false;
  for (int i = 0; i < n; ++i) {
    const Row& of = end[those[i]];
    const auto by = Scalar(part[i]);
    found.L += by * of.L;
    found.A_a += by * of.A_a;
    found.A_b += by * of.A_b;
    found.position += by * of.position;
    any = any || btFabs(by) > Scalar(least_part_along);
  }
  return any;
}

// The number of a row of the same axis, below 0 if there is none.
int findAxis(const Row& start, const Rows& end) {
  int at = -1;
  for (int i = end.equalities(); i < end.size(); ++i)
    if (end[i].axis == start.axis && end[i].limit == start.limit) at = i;
  return at;
}

// The row `start`, the number `index` of its joint, among those of the end. Returns false if there is none. Tangents of a joint may be
// chosen anew at each pose, and the axes of a motor about all of them: such rows are then taken along those of the start. So are
// rows along axes of the world: along what `carry` makes of them.
template <class Carry>
bool findAtEnd(const Island& island, const IslandJoint& joint, const Row& start, int index,
               Rows& end, const Carry& carry, Row& found) {
  if (start.axis >= 0) {
    const Axis* const axis = end.axis(start.axis).axis;
    const auto isOne = [&](const Row& other) {
      return !other.limit && end.axis(other.axis).axis == axis;
    };
    int same = 0, at = -1;
    for (int i = end.equalities(); i < end.size(); ++i) {
      if (end[i].axis == start.axis) at = i;
      if (isOne(end[i])) ++same;
    }
    if (at < 0) return false;
    if (!start.limit && same > 1)
      return findAlong(island, joint, start, end, end.equalities(), end.size(), isOne, found);
    found = end[at];
    return isSameRow(start, found);
  }
  if (end.equalities() != joint.equalities) return false;
  found = end[index];
  const bool of_world = start.angular && start.A_b == found.A_b;
  const Row along = of_world ? carry(start) : start;
  if (isSameRow(start, found) && along.A_b == start.A_b) return true;
  return findAlong(
      island, joint, along, end, 0, end.equalities(),
      [&](const Row& other) { return other.group == start.group; }, found);
}

// Rows that joints are asked for. Hardly any joint is: so it is made when the first one is.
class AskedRows {
 public:
  Rows& clear() {
    if (m_of == nullptr) m_of = new (m_memory) WithMemory;
    m_of->rows.clear();
    return m_of->rows;
  }

 private:
  struct WithMemory {
    RowMemory<max_joint_rows, max_joint_rows> memory;
    Rows rows{memory};
  };
  static_assert(std::is_trivially_destructible_v<WithMemory>);
  // (std::optional sets all of it to 0.)
  alignas(WithMemory) unsigned char m_memory[sizeof(WithMemory)];
  WithMemory* m_of = nullptr;
};

// The two bodies of a joint at the end of the step, and what its rows are there.
class JointAtEnd {
 public:
  JointAtEnd(const Island& island, const IslandJoint& joint, const Component& component,
             const std::vector<MovedBody>& moved, AskedRows& rows)
      : JointAtEnd(island, joint, bodyOf(island, component, moved, joint.body[0]),
                   bodyOf(island, component, moved, joint.body[1]), rows) {}
  JointAtEnd(const Island& island, const IslandJoint& joint, const MovedBody& a, const MovedBody& b,
             AskedRows& rows)
      : m_island(island),
        m_joint(joint),
        m_dt(island.dt),
        m_rate(1 / island.dt),
        m_a(a),
        m_b(b),
        m_asked_rows(rows) {}

  double velocityAtStart(const IslandRow& row) const { return row.J.along(m_a.v, m_b.v); }
  double velocity(const IslandRow& row) {
    if (!row.has_position) return velocityAtStart(row);
    if (row.has_stops_alone) {
      const double straight = velocityAtStart(row);
      if (row.isFarFromStops(straight, m_dt * (m_a.v.tail<3>().norm() + m_b.v.tail<3>().norm()),
                             m_dt))
        return straight;
    }
    if (row.isOfArms()) {
      findArms(row);
      return velocityOfArms(row);
    }
    ask();
    Row found;
    const double at_start = velocityAtStart(row);
    if (!find(row, found)) return at_start;
    return velocityOfAngle(row, double(found.position) - double(row.start->position));
  }
  /// Whether the joint ends beyond a stop of the row along a direction that is not the one of the start, which is then found.
  bool isBeyondTurned(const IslandRow& row, Row& found) {
    ask();
    if (find(row, found)) return false;
    const int at = findAxis(*row.start, *m_rows);
    if (at < 0) return false;
    found = (*m_rows)[at];
    return isBeyondStop(row.law, (double(found.position) - double(row.start->position)) / m_dt);
  }
  RowJacobian jacobian(const IslandRow& row) {
    if (row.start == nullptr && !row.has_position) return row.J;
    if (row.isOfArms()) {
      findArms(row);
      return jacobianOfArms(row);
    }
    ask();
    Row found;
    return find(row, found) ? jacobianOf(found, row.sign) : row.J;
  }

 private:
  static const MovedBody& bodyOf(const Island& island, const Component& component,
                                 const std::vector<MovedBody>& moved, int body) {
    return body < 0 ? island.unmovedBody(body) : moved[size_t(body - component.first_body)];
  }

  bool find(const IslandRow& row, Row& found) {
    // With the mean of both bodies.
    const auto carry = [this](const Row& start) {
      Row to = start;
      const Vector3d from = inDouble(start.A_b), mean = m_a.turn * from + m_b.turn * from;
      const double size = mean.norm();
      if (size > 0) to.A_a = to.A_b = (from.norm() / size * mean).cast<Scalar>();
      return to;
    };
    return findAtEnd(m_island, m_joint, *row.start, row.index, *m_rows, carry, found);
  }

  double velocityOfAngle(const IslandRow& row, double change) const {
    return (row.spins ? change + turnsBeside(row, change) : change) * m_rate;
  }
  // rad: the whole turns that the bodies make in the step beside `change`.
  double turnsBeside(const IslandRow& row, double change) const {
    const RotationOfStep a(m_a.v.tail<3>(), m_dt), b(m_b.v.tail<3>(), m_dt);
    const double turn = row.J.A_a.dot(a.phi) + row.J.A_b.dot(b.phi);
    return 2 * pi * std::round((turn - change) / (2 * pi));
  }

  // What two arms of the bodies do not tell: the joint's own rows.
  void ask() {
    if (m_rows != nullptr) return;
    m_rows = &m_asked_rows.clear();
    const btTypedConstraint& joint = *m_joint.constraint;
    m_joint.ours->addRows(PosePair(m_a.from(joint.getRigidBodyA().getCenterOfMassTransform()),
                                   m_b.from(joint.getRigidBodyB().getCenterOfMassTransform())),
                          *m_rows);
  }

  void findArms(const IslandRow& row) {
    const RowShape& shape = row.shape;
    const bool are_known = row.shares_arms && m_shape == &(&row - 1)->shape;
    m_shape = &shape;
    if (are_known) return;
    m_r_a = inDouble(shape.a);
    m_r_b = inDouble(shape.b);
    m_end_a = m_a.turn * m_r_a;
    m_end_b = m_b.turn * m_r_b;
    if (shape.kind == RowShape::point || shape.kind == RowShape::distance)
      m_move = m_b.move - m_a.move + m_end_b - m_r_b - m_end_a + m_r_a;
  }
  static Vector3d directionOf(const IslandRow& row) { return double(row.sign) * row.J.L_b; }
  double velocityOfArms(const IslandRow& row) const {
    switch (row.shape.kind) {
      case RowShape::dot: return (m_end_a.dot(m_end_b) - m_r_a.dot(m_r_b)) * m_rate;
      case RowShape::distance: {
        const Vector3d d_0 = double(row.shape.length) * directionOf(row), d_1 = d_0 + m_move;
        const double sum = d_0.norm() + d_1.norm();
        if (sum > 0) return (d_0 + d_1).dot(m_move) / (sum * m_dt);
        break;
      }
      case RowShape::turn: {
        const Vector3d across = cross(Vector3d(m_a.turn * row.J.A_b), m_end_a);
        return velocityOfAngle(row, std::atan2(m_end_b.dot(across), m_end_b.dot(m_end_a)));
      }
      default: break;
    }
    return directionOf(row).dot(m_move) * m_rate;
  }
  RowJacobian jacobianOfArms(const IslandRow& row) const {
    if (row.shape.kind == RowShape::dot)
      return {Vector3d::Zero(), cross(m_end_a, m_end_b), Vector3d::Zero(), cross(m_end_b, m_end_a)};
    if (row.shape.kind == RowShape::turn) {
      const Vector3d axis = m_a.turn * row.J.A_b;
      return {Vector3d::Zero(), -axis, Vector3d::Zero(), axis};
    }
    Vector3d n = directionOf(row);
    if (row.shape.kind == RowShape::distance) {
      const Vector3d d_1 = double(row.shape.length) * n + m_move;
      const double length = d_1.norm();
      if (length > 0) n = d_1 / length;
    }
    return {-n, -cross(m_end_a, n), n, cross(m_end_b, n)};
  }

  const Island& m_island;
  const IslandJoint& m_joint;
  const double m_dt, m_rate;  ///< s, and 1 / s
  const MovedBody &m_a, &m_b;
  AskedRows& m_asked_rows;
  Rows* m_rows = nullptr;             ///< null: it has not been asked
  const RowShape* m_shape = nullptr;  ///< whose arms these are
  Vector3d m_r_a = Vector3d::Zero(), m_r_b = m_r_a, m_end_a = m_r_a, m_end_b = m_r_a;
  Vector3d m_move = m_r_a;  ///< of b's end against a's
};

// visit(row, its number in the component, its joint at the end)
template <class Visit>
void forEachAtEnd(const Island& island, const Component& component,
                  const std::vector<MovedBody>& moved, const Visit& visit) {
  AskedRows rows;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    JointAtEnd end(island, joint, component, moved, rows);
    for (int i = 0; i < joint.rows; ++i)
      visit(island.rows[size_t(joint.first_row + i)], size_t(joint.row_of_component + i), end);
  }
}

}  // namespace

void moveBodies(const Island& island, const Component& component, const Vector6d* v,
                std::vector<MovedBody>& moved) {
  moved.clear();
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    moved.emplace_back(v[i], island.dt, turnOfStep(body, v[i].tail<3>(), island.dt));
  }
}

void measureAtEnd(const Island& island, const Component& component,
                  const std::vector<MovedBody>& moved, std::vector<double>& u) {
  forEachAtEnd(island, component, moved,
               [&](const IslandRow& row, size_t r, JointAtEnd& end) { u[r] = end.velocity(row); });
}

void measureAtEnd(const Island& island, const Component& component,
                  const std::vector<MovedBody>& moved, const std::vector<char>& which,
                  std::vector<double>& u) {
  forEachAtEnd(island, component, moved, [&](const IslandRow& row, size_t r, JointAtEnd& end) {
    u[r] = which[r] ? end.velocity(row) : end.velocityAtStart(row);
  });
}

void differentiateAtEnd(const Island& island, const Component& component,
                        const std::vector<MovedBody>& moved, const std::vector<char>& which,
                        std::vector<RowJacobian>& J) {
  J.resize(size_t(component.rows));
  forEachAtEnd(island, component, moved, [&](const IslandRow& row, size_t r, JointAtEnd& end) {
    J[r] = which[r] ? end.jacobian(row) : row.J;
  });
}

void turnStops(Island& island, const Component& component) {
  AskedRows rows;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (!joint.may_turn_stops) continue;
    const Vector6d &v_a = island.velocity(joint.body[0], &IslandBody::v_free),
                   &v_b = island.velocity(joint.body[1], &IslandBody::v_free);
    const double turn = (v_a.tail<3>() - v_b.tail<3>()).norm();  // rad/s
    for (int i = 0; i < joint.rows; ++i) {
      IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.mayTurnStops() || !(isBeyondStop(row.law, -turn) || isBeyondStop(row.law, turn)))
        continue;
      const MovedBody a(v_a, island.dt), b(v_b, island.dt);
      Row found;
      if (!JointAtEnd(island, joint, a, b, rows).isBeyondTurned(row, found)) continue;
      found.position = row.start->position;
      row.extras->turned = found;
      row.start = &row.extras->turned;
      row.J = jacobianOf(found, row.sign);
      row.setK(island.inverseMass(joint, row.J, row.J));
    }
  }
}

void measureAtStart(const Island& island, const Component& component, const Vector6d* v,
                    std::vector<double>& u) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const Vector6d &a = island.velocity(joint.body[0], v, component.first_body),
                   &b = island.velocity(joint.body[1], v, component.first_body);
    for (int i = 0; i < joint.rows; ++i)
      u[size_t(joint.row_of_component + i)] =
          island.rows[size_t(joint.first_row + i)].J.along(a, b);
  }
}

Vector6d meanVelocity(const Island& island, const IslandJoint& joint, int side,
                      const Component& component, const std::vector<Vector6d>& v,
                      Vector6d IslandBody::*start) {
  const int body = joint.body[size_t(side)];
  if (body < 0) return island.unmovedBody(body).v;
  return (v[size_t(body - component.first_body)] + island.bodies[size_t(body)].*start) / 2;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
