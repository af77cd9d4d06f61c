#include <pintle/solver/relaxation.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A row with what an impulse along it does to its bodies.
struct Relaxed {
  std::array<int, 2> body;
  RowJacobian J;
  std::array<Vector6d, 2> answer;
  double K = 0;
  double of_unmoved = 0;  ///< m/s: by bodies that their owner moves

  Relaxed(const Island& island, const std::array<int, 2>& of, const RowJacobian& along)
      : body(of), J(along) {
    for (int side = 0; side < 2; ++side) {
      answer[size_t(side)].setZero();
      if (body[size_t(side)] < 0) {
        const Vector6d& v = island.unmovedBody(body[size_t(side)]).v;
        of_unmoved += J.L(side).dot(v.head<3>()) + J.A(side).dot(v.tail<3>());
        continue;
      }
      const IslandBody& by = island.bodies[size_t(body[size_t(side)])];
      Vector6d& to = answer[size_t(side)];
      for (int k = 0; k < 3; ++k) to[k] = by.locked[size_t(k)] ? 0 : J.L(side)[k] / by.mass;
      to.tail<3>() = by.inverse_inertia * J.A(side);
      K += J.L(side).dot(to.head<3>()) + J.A(side).dot(to.tail<3>());
    }
  }

  double velocity(const std::vector<Vector6d>& v) const {
    double u = of_unmoved;
    for (int side = 0; side < 2; ++side)
      if (body[size_t(side)] >= 0) {
        const Vector6d& of = v[size_t(body[size_t(side)])];
        u += J.L(side).dot(of.head<3>()) + J.A(side).dot(of.tail<3>());
      }
    return u;
  }
  void push(double impulse, std::vector<Vector6d>& v) const {
    for (int side = 0; side < 2; ++side)
      if (body[size_t(side)] >= 0) v[size_t(body[size_t(side)])] += impulse * answer[size_t(side)];
  }
};

}  // namespace

void relax(const Island& island, std::vector<ContactPart>& parts, std::vector<ContactRow>& contacts,
           int passes, std::vector<Vector6d>& velocities) {
  struct JointRow {
    Relaxed row;
    const AxisLaw& law;
    double& lambda;
    RowAtEnd& end;
  };
  std::vector<JointRow> joints;
  for (ContactPart& part : parts) {
    Iterate& now = part.work->now;
    now.horizon = 0;
    now.rows.resize(size_t(part.component->rows));
    now.lambda.assign(now.rows.size(), 0.);
    for (int c = part.component->first_joint;
         c < part.component->first_joint + part.component->joints; ++c) {
      const IslandJoint& joint = island.joints[size_t(c)];
      for (int i = 0; i < joint.rows; ++i) {
        const auto r = size_t(joint.row_of_component + i);
        const IslandRow& row = island.rows[size_t(joint.first_row + i)];
        joints.push_back({{island, joint.body, row.J}, row.law, now.lambda[r], now.rows[r]});
      }
    }
  }
  std::vector<Relaxed> touching;
  for (ContactRow& contact : contacts) {
    contact.impulse = 0;
    touching.emplace_back(island, contact.body, contact.J);
  }
  for (int pass = 0; pass < passes; ++pass) {
    for (JointRow& joint : joints) {
      const double K = joint.row.K;
      if (!(K > 0)) continue;
      const double free = joint.row.velocity(velocities) - K * joint.lambda;
      const double next = joint.law.meet(free, K).impulseAt(free, K);
      joint.row.push(next - joint.lambda, velocities);
      joint.lambda = next;
    }
    for (size_t r = 0; r < contacts.size(); ++r) {
      ContactRow& contact = contacts[r];
      const double K = touching[r].K;
      if (!(K > 0)) continue;
      boundFriction(contacts, contact);
      const double next = contact.meet(touching[r].velocity(velocities), K);
      touching[r].push(next - contact.impulse, velocities);
      contact.impulse = next;
    }
  }
  for (JointRow& joint : joints) {
    joint.end.J = joint.end.G = joint.row.J;
    joint.end.u = joint.row.velocity(velocities);
  }
  for (ContactPart& part : parts)
    for (int i = 0; i < part.component->bodies; ++i)
      part.work->now.bodies[size_t(i)].v = velocities[size_t(part.component->first_body + i)];
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
