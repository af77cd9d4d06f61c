#include <pintle/solver/energy_ledger.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

double gainOf(const IslandBody& body, const Vector6d& from, const Vector6d& to) {
  const Vector6d sum = to + from, change = to - from;
  return (body.mass * change.head<3>().dot(sum.head<3>()) +
          change.tail<3>().dot(body.inertia * sum.tail<3>())) /
         2;
}

void EnergyLedger::begin(const Island& island, const Component& component, double share) {
  double before = 0;
  with_forces = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    before += gainOf(body, Vector6d::Zero(), body.v0);
    with_forces += gainOf(body, Vector6d::Zero(), body.v_free);
  }
  // It is forgotten within a second or so.
  peak = std::fmax(peak * std::fmax(1 - island.dt, 0), before);
  given = std::fmin(given, share * peak);
}

namespace {

// The impulse of the parts of a law that drive.
double drivingImpulse(const AxisLaw& law, double u, double lambda) {
  double impulse[AxisLaw::max_parts], driving = 0;
  law.split(u, lambda, impulse);
  for (int k = 0; k < law.parts(); ++k)
    if (law.part(k).drives) driving += impulse[k];
  return driving;
}

// J: what the spring of a soft row has stored in the step.
double stored(const Island& island, const IslandRow& row, double u, double lambda) {
  if (!(row.spring.erp > 0)) return 0;
  const double softness = row.law.part(0).softness;
  return row.spring.energyAfter(u, lambda, softness, island.dt) -
         row.spring.energy(softness, island.dt);
}

// An impulse p that changes velocities from v to v1 works by p . (v + v1) / 2.
double workFrom(Vector6d IslandBody::*start, const Island& island, const Component& component,
                const Iterate& at) {
  double work = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector6d &v = at.bodies[size_t(i)].v, twice = v + body.*start,
                   by_joints = v - body.v_free;
    work += (body.mass * by_joints.head<3>().dot(twice.head<3>()) +
             by_joints.tail<3>().dot(body.inertia * twice.tail<3>())) /
            2;
  }
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const auto mean = [&](int side) {
      return meanVelocity(island, joint, side, component, at, start);
    };
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      const RowAtEnd& end = at.rows[r];
      work += stored(island, row, end.u, at.lambda[r]);
      const double driving = row.law.hasDrives() ? drivingImpulse(row.law, end.u, at.lambda[r]) : 0;
      if (driving != 0 || row.rebound_energy > 0) {
        const double u = end.G.along(mean(0), mean(1));
        work -=
            driving * u + std::fmin(row.rebound_energy, std::fmax(0, (at.lambda[r] - driving) * u));
      }
      // What a joint gives is what it takes from a body that its owner moves.
      for (int side = 0; side < 2; ++side) {
        if (joint.body[size_t(side)] >= 0) continue;
        const Vector6d& v = island.unmovedBody(joint.body[size_t(side)]).v;
        work += at.lambda[r] * (end.G.L(side).dot(v.head<3>()) + end.G.A(side).dot(v.tail<3>()));
      }
    }
  }
  return work;
}

}  // namespace

double workOfJoints(const Island& island, const Component& component, const Iterate& at) {
  return workFrom(&IslandBody::v0, island, component, at);
}

double gainOverForces(const Island& island, const Component& component, const Iterate& at) {
  return workFrom(&IslandBody::v_free, island, component, at);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
