#include <pintle/solver/solve/contact_poses.h>

#include <pintle/finite.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Of a contact's normal: how fast Bullet wants it to lead out, m/s.
double speedOut(const ContactRow& row) {
  const double inverse_K = double(row.from->m_jacDiagABInv);
  return inverse_K > 0 ? double(row.from->m_rhsPenetration) / inverse_K : 0;
}

}  // namespace

// No body goes further than all of its contacts ask for, and they lift by no more than impulses have taken in this step.
bool pushApart(Island& island, const std::vector<ContactRow>& contacts,
               const std::vector<Vector6d>& velocities, int passes, double turn_share,
               ContactResponse& response, const HoldJoints& holdJoints,
               ContactPosesMemory& memory) {
  std::vector<ContactRow>& rows = memory.rows;
  rows.clear();
  for (const ContactRow& row : contacts) {
    if (row.isFriction() || row.is_held || !(row.K > 0) || !(speedOut(row) > 0)) continue;
    ContactRow& out = rows.emplace_back(row);
    out.target = out.aim = speedOut(row);
    out.softness = out.compliance = out.recovery = out.impulse = out.before = 0;
    response.forgetOld(island, out);
  }
  if (rows.empty()) return false;
  std::vector<Vector6d>& push = memory.push;
  push.assign(island.bodies.size(), Vector6d::Zero());
  std::vector<double>& most = memory.most;
  most.assign(island.bodies.size(), 0.);
  for (const ContactRow& row : rows)
    for (const int body : row.body)
      if (body >= 0) most[size_t(body)] += row.aim;
  response.rest();
  for (int pass = 0; pass < passes; ++pass) response.sweep(rows);
  for (ContactRow& row : rows) row.push(push);
  holdJoints(push);
  double lifted = 0;  // J
  for (size_t i = 0; i < push.size(); ++i) {
    IslandBody& body = island.bodies[i];
    const double size = push[i].head<3>().norm() + body.radius() * push[i].tail<3>().norm();
    if (!isFinite(size)) continue;
    body.push = size > most[i] ? Vector6d(most[i] / size * push[i]) : push[i];
    body.push.tail<3>() *= turn_share;
    lifted -= body.product(body.by_forces, body.push);
  }
  if (!(lifted > 0)) return true;
  double taken = 0;  // J
  for (size_t i = 0; i < push.size(); ++i) {
    const IslandBody& body = island.bodies[i];
    taken += body.product(body.v_free - velocities[i], body.v_free + velocities[i]) / 2;
  }
  const double share = std::fmin(1, std::fmax(0, taken) / lifted);
  for (IslandBody& body : island.bodies) body.push *= share;
  return true;
}

void followPoses(const Island& island, Span<const int> bodies, std::vector<Vector6d>& velocities,
                 std::vector<PoseChange>& changes) {
  // Rotations about two free axes may have a part about a locked one, which is no velocity.
  const auto by = [&](size_t i) {
    Vector6d change = changes[i] / island.dt + island.bodies[i].push;
    for (int k = 0; k < 6; ++k)
      if (island.bodies[i].locked[size_t(k)]) change[k] = 0;
    return change;
  };
  double slope = 0, bend = 0;
  for (const int body : bodies) {
    const auto i = size_t(body);
    slope += island.bodies[i].product(by(i), velocities[i]);
    bend += island.bodies[i].product(by(i), by(i));
  }
  if (!(slope < 0)) return;
  const double part = std::fmin(1, -slope / bend);
  for (const int body : bodies) {
    const auto i = size_t(body);
    const Vector6d next = velocities[i] + part * by(i);
    changes[i] = changeFor(next, velocities[i], changes[i], island.dt);
    velocities[i] = next;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
