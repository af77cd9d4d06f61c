#include <pintle/solver/iterate.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/solver/discrete_gradient.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

const btTransform& poseOf(const IslandJoint& joint, int side, const BodyAtEnd& end) {
  if (Island::unmoved(joint.body[size_t(side)]) != Island::at_rest) return end.pose;
  return side ? joint.constraint->getRigidBodyB().getCenterOfMassTransform()
              : joint.constraint->getRigidBodyA().getCenterOfMassTransform();
}

btTransform moved(const btTransform& start, double dt, const Vector6d& v, const Matrix3d& R) {
  btTransform to;
  const btMatrix3x3 turned(Scalar(R(0, 0)), Scalar(R(0, 1)), Scalar(R(0, 2)), Scalar(R(1, 0)),
                           Scalar(R(1, 1)), Scalar(R(1, 2)), Scalar(R(2, 0)), Scalar(R(2, 1)),
                           Scalar(R(2, 2)));
  to.setBasis(turned * start.getBasis());
  const Vector3d x = dt * v.head<3>();
  to.setOrigin(start.getOrigin() + btVector3(Scalar(x[0]), Scalar(x[1]), Scalar(x[2])));
  return to;
}

// A row of the start, as a velocity.
void holdVelocity(const IslandRow& row, const BodyAtEnd& a, const BodyAtEnd& b, RowAtEnd& to) {
  to.J = to.G = row.J;
  to.u = row.J.along(a.v, b.v);
}

// From a row of poses to one of velocities: bodies turn as they do (Turn).
RowJacobian byVelocity(const Row& row, double sign, const BodyAtEnd& a, const BodyAtEnd& b) {
  const Vector3d L = sign * row.L.cast<double>();
  return {-L, -sign * (a.turn.slope.transpose() * row.A_a.cast<double>()), L,
          sign * (b.turn.slope.transpose() * row.A_b.cast<double>())};
}
RowJacobian byVelocity(const Gradient& G, double sign, const BodyAtEnd& a, const BodyAtEnd& b) {
  return {-sign * G.L, -sign * a.turn.part * G.A_a, sign * G.L, sign * b.turn.part * G.A_b};
}

// What the row of the start measures, among the rows of the end. Returns false if nothing does. Tangents of a joint may be chosen
// anew at each pose: an equality is then taken along that of the start.
bool findAtEnd(const IslandRow& row, const Rows& end, int equalities_at_start, Row& found) {
  if (row.start.axis >= 0) {
    for (int i = end.equalities(); i < end.size(); ++i)
      if (end[i].axis == row.start.axis) {
        found = end[i];
        return isSameRow(row.start, found);
      }
    return false;
  }
  if (end.equalities() != equalities_at_start) return false;
  found = end[row.index];
  if (isSameRow(row.start, found)) return true;
  found.L = found.A_a = found.A_b = Vec3::Zero();
  found.position = 0;
  bool any = false;
  for (int i = 0; i < end.equalities(); ++i) {
    const Row& other = end[i];
    if (other.angular != row.start.angular || other.group != row.start.group) continue;
    const Vec3 &mine = row.start.angular ? row.start.A_b : row.start.L,
               &its = row.start.angular ? other.A_b : other.L;
    const Scalar part = mine.dot(its) / its.dot(its);
    found.L += part * other.L;
    found.A_a += part * other.A_a;
    found.A_b += part * other.A_b;
    found.position += part * other.position;
    any = any || btFabs(part) > Scalar(0.1);
  }
  return any;
}

// Two arms of the bodies at the end of the step. Rows of a joint share them.
struct Arms {
  const RowShape* of = nullptr;
  Vector3d r_a = Vector3d::Zero(), r_b = r_a, end_a = r_a, end_b = r_a;
  Vector3d move = r_a;  ///< of b's end against a's

  template <class Body>
  void find(const RowShape& shape, double horizon, const Body& a, const Body& b) {
    if (of != nullptr && of->a == shape.a && of->b == shape.b) return;
    of = &shape;
    r_a = inDouble(shape.a);
    r_b = inDouble(shape.b);
    end_a = a.turn.turned(r_a);
    end_b = b.turn.turned(r_b);
    const Vector6d v = b.v - a.v;
    move = horizon * v.head<3>() + end_b - r_b - end_a + r_a;
  }
  // u of a row of these arms.
  double measure(const IslandRow& row, double horizon) const {
    switch (row.shape.kind) {
      case RowShape::dot:
        return ((r_a + end_a).dot(end_b - r_b) + (r_b + end_b).dot(end_a - r_a)) / (2 * horizon);
      case RowShape::distance: {
        const Vector3d d_0 = double(row.shape.length) * inDouble(row.start.L), d_1 = d_0 + move;
        const double sum = d_0.norm() + d_1.norm();
        if (sum > 0) return (d_0 + d_1).dot(move) / (sum * horizon);
        break;
      }
      default: break;
    }
    return inDouble(row.start.L).dot(move) / horizon;
  }
};

// J and u of rows that are made of arms of the bodies, in closed form, without asking the joint.
void moveArms(const IslandRow& row, double horizon, const Arms& arms, const BodyAtEnd& a,
              const BodyAtEnd& b, RowAtEnd& to) {
  const Vector3d &end_a = arms.end_a, &end_b = arms.end_b;
  to.u = arms.measure(row, horizon);
  const auto turnsBy = [&](const Vector3d& A_a, const Vector3d& A_b) {
    to.J.A_a = a.turn.slope.transpose() * A_a;
    to.J.A_b = b.turn.slope.transpose() * A_b;
  };
  if (row.shape.kind == RowShape::dot) {
    to.J.L_a = to.J.L_b = Vector3d::Zero();
    turnsBy(cross(end_a, end_b), cross(end_b, end_a));
    return;
  }
  Vector3d n = inDouble(row.start.L);
  if (row.shape.kind == RowShape::distance) {
    const Vector3d d_1 = double(row.shape.length) * n + arms.move;
    const double length = d_1.norm();
    if (length > 0) n = d_1 / length;
  }
  to.J.L_a = -n;
  to.J.L_b = n;
  turnsBy(-cross(end_a, n), cross(end_b, n));
}

void moveRows(const Island& island, const IslandJoint& joint, const Component& component, Rows& end,
              Iterate& at) {
  const BodyAtEnd &a = bodyOf(island, joint, 0, component, at),
                  &b = bodyOf(island, joint, 1, component, at);
  end.clear();
  bool asked = false;
  Arms arms;
  const Displacement by_a(at.horizon * a.v.head<3>(), a.turn.phi, a.turn.mean),
      by_b(at.horizon * b.v.head<3>(), b.turn.phi, b.turn.mean);
  for (int i = 0; i < joint.rows; ++i) {
    const IslandRow& row = island.rows[size_t(joint.first_row + i)];
    RowAtEnd& to = at.rows[size_t(joint.row_of_component + i)];
    Row now = row.start;
    double change = 0;
    if (!row.has_position || !(at.horizon > 0)) {
      holdVelocity(row, a, b, to);
      continue;
    }
    if (row.isOfArms()) {
      arms.find(row.shape, at.horizon, a, b);
      moveArms(row, at.horizon, arms, a, b, to);
    } else {
      if (!asked) joint.ours->addRows(PosePair(poseOf(joint, 0, a), poseOf(joint, 1, b)), end);
      asked = true;
      if (!findAtEnd(row, end, joint.equalities, now)) {
        holdVelocity(row, a, b, to);
        continue;
      }
      change = double(now.position) - double(row.start.position);
      to.J = byVelocity(now, row.sign, a, b);
      to.u = change / at.horizon;
    }
    to.G = byVelocity(
        discreteGradient({row.start, now, row.shape, row.shape}, row.sign * change, by_a, by_b),
        row.sign, a, b);
  }
}

}  // namespace

void moveBody(const btTransform& start, double dt, BodyAtEnd& end) {
  end.turn = Turn(end.v.tail<3>(), dt);
  end.pose = moved(start, dt, end.v, end.turn.rotation());
}

const BodyAtEnd& bodyOf(const Island& island, const IslandJoint& joint, int side,
                        const Component& component, const Iterate& at) {
  const int body = joint.body[size_t(side)];
  return body < 0 ? island.unmovedBody(body) : at.bodies[size_t(body - component.first_body)];
}

Vector6d meanVelocity(const Island& island, const IslandJoint& joint, int side,
                      const Component& component, const Iterate& at, Vector6d IslandBody::*start) {
  const int body = joint.body[size_t(side)];
  const Vector6d& v = bodyOf(island, joint, side, component, at).v;
  return body < 0 ? v : Vector6d((v + island.bodies[size_t(body)].*start) / 2);
}

void moveTo(const Island& island, const Component& component, Iterate& at) {
  for (int i = 0; at.horizon > 0 && i < component.bodies; ++i)
    moveBody(island.bodies[size_t(component.first_body + i)].start, at.horizon,
             at.bodies[size_t(i)]);
  RowMemory<max_joint_rows, max_joint_rows> memory;
  Rows end(memory);
  for (int c = 0; c < component.joints; ++c)
    moveRows(island, island.joints[size_t(component.first_joint + c)], component, end, at);
}

void measure(const Island& island, const Component& component, double dt,
             const std::vector<Vector6d>& v, std::vector<MovedBody>& bodies,
             std::vector<double>& u) {
  bodies.clear();
  for (const Vector6d& of : v) bodies.emplace_back(of, dt);
  RowMemory<max_joint_rows, max_joint_rows> memory;
  Rows end(memory);
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const auto bodyAt = [&](int side) -> const MovedBody& {
      const int body = joint.body[size_t(side)];
      return body < 0 ? island.moved_by_owner[size_t(Island::unmoved(body))]
                      : bodies[size_t(body - component.first_body)];
    };
    const MovedBody &a = bodyAt(0), &b = bodyAt(1);
    Arms arms;
    bool asked = false;
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      double& to = u[size_t(joint.row_of_component + i)];
      if (!row.has_position) {
        to = row.J.along(a.v, b.v);
        continue;
      }
      if (row.isOfArms()) {
        arms.find(row.shape, dt, a, b);
        to = arms.measure(row, dt);
        continue;
      }
      if (!asked) {
        const auto pose = [&](int side) {
          const int body = joint.body[size_t(side)];
          const MovedBody& of = bodyAt(side);
          return body < 0 ? poseOf(joint, side, island.unmovedBody(body))
                          : moved(island.bodies[size_t(body)].start, dt, of.v, of.turn.matrix());
        };
        end.clear();
        joint.ours->addRows(PosePair(pose(0), pose(1)), end);
        asked = true;
      }
      Row now = row.start;
      to = findAtEnd(row, end, joint.equalities, now)
               ? (double(now.position) - double(row.start.position)) / dt
               : row.J.along(a.v, b.v);
    }
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
