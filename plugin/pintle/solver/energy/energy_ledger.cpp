#include <pintle/solver/energy/energy_ledger.h>

#include <pintle/solver/model/row_velocities.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace pintle {
inline namespace PINTLE_PRECISION {

double gainOf(const IslandBody& body, const Vector6d& from, const Vector6d& to) {
  return body.product(to - from, to + from) / 2;
}

double kineticEnergy(const Island& island, const Component& component, Vector6d IslandBody::*v) {
  double sum = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    sum += gainOf(body, Vector6d::Zero(), body.*v);
  }
  return sum;
}

double kineticEnergy(const Island& island, const Component& component,
                     const std::vector<Vector6d>& v) {
  double sum = 0;
  for (size_t i = 0; i < v.size(); ++i)
    sum += gainOf(island.bodies[size_t(component.first_body) + i], Vector6d::Zero(), v[i]);
  return sum;
}

void EnergyLedger::begin(const Island& island, const Component& component, double share) {
  now = with_forces = 0;  // in one loop: both need the inertia
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    now += body.product(body.v0, body.v0) / 2;
    with_forces += body.product(body.v_free, body.v_free) / 2;
  }
  // It is forgotten within a second or so.
  peak = std::fmax(peak * std::fmax(1 - island.dt, 0), std::fmin(m_left, now));
  given = std::fmin(given, share * peak + rounding);
  rounding = 0;
}

namespace {

// The impulses of a law's parts that drive, of those of them that brake, and of its limits.
struct PartImpulses {
  double of_drives = 0, of_brakes = 0, of_limits = 0;

  PartImpulses(const IslandRow& row, const Workspace& end, size_t r) {
    const AxisLaw& law = row.law;
    if (!law.hasDrives() && !row.keepsForRebound()) return;
    const AxisLaw::Parts of = end.split(law, r);
    for (int k = 0; k < law.parts(); ++k) {
      const LawPart& part = law.part(k);
      if (part.role == Axis::limit) of_limits += of[size_t(k)];
      if (!part.drives) continue;
      of_drives += of[size_t(k)];
      if (part.brakes()) of_brakes += of[size_t(k)];
    }
  }
  // J: what is not the joint's, at the mean velocity u. A brake takes by the way of its row in the step. Where along the directions of the
  // start it would give, that is the joint's.
  double work(double u) const { return of_drives * u - std::max(0., of_brakes * u); }
  // N s: without brakes, which give nothing to velocities to which forces lead.
  double pull() const { return of_drives - of_brakes; }
  // J: what its limit takes for a rebound.
  double kept(const Island& island, const Component& component, const IslandRow& row,
              double u) const {
    if (!row.keepsForRebound() || !(of_limits * u < 0)) return 0;
    return std::fmin(kineticEnergy(island, component, &IslandBody::v_free), -of_limits * u);
  }
};

// J: what the spring of a soft row has stored in the step.
double stored(const Island& island, const IslandRow& row, const Workspace& end, size_t r) {
  if (!row.isSoft()) return 0;
  const RowSpring& spring = row.extras->spring;
  const double softness = row.softness();
  return spring.energyAfter(end.u[r], end.impulseOfSpring(row, r), softness, island.dt) -
         spring.energy(softness, island.dt);
}

// J: the most that a drive does to velocities v* that its joints may not hold yet. Joints alone would lead to a w of no more energy, and
// from there it works by lambda (u + J w) / 2.
double mostWork(double lambda, double u, double K, double energy) {
  return (lambda * u + std::abs(lambda) * std::sqrt(2 * K * energy)) / 2;
}

// An impulse p that changes velocities from v to v1 works by p . (v + v1) / 2.
double workFrom(Vector6d IslandBody::*start, const Island& island, const Component& component,
                const Workspace& end) {
  double work = 0;
  const bool over_forces = start == &IslandBody::v_free;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector6d& v = end.v[size_t(i)];
    const Vector6d from = body.*start;
    work += body.product(v - from, v + from) / 2;
    if (!over_forces) work -= body.product(body.by_forces, v + from) / 2 + body.gyroscopic_work;
  }
  const bool any_moves = island.anyUnmovedMoves();
  std::optional<double> energy;  // J: with which it begins, where a row asks for it
  const auto energyAtStart = [&] {
    if (!energy) energy = kineticEnergy(island, component, start);
    return *energy;
  };
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (!joint.drives && !joint.has_springs && !any_moves && !joint.keeps_for_rebound) continue;
    const auto mean = [&](int side) {
      return meanVelocity(island, joint, side, component, end.v, start);
    };
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (row.extras == nullptr && !row.law.hasDrives() && !any_moves) continue;
      work += stored(island, row, end, r);
      const PartImpulses parts(row, end, r);
      if (parts.of_drives != 0 || row.reboundEnergy() > 0 || parts.of_limits != 0) {
        const double u = row.J.along(mean(0), mean(1));
        if (!over_forces)
          work -= parts.work(u) + row.reboundEnergy() - parts.kept(island, component, row, u);
        else
          work -=
              (parts.pull() != 0 ? mostWork(parts.pull(), end.u[r], row.K, energyAtStart()) : 0) +
              std::fmin(row.reboundEnergy(), std::fmax(0, (end.lambda[r] - parts.of_drives) * u));
      }
      // What a joint gives is what it takes from a body that its owner moves.
      if (any_moves) work += end.lambda[r] * island.velocityOfUnmoved(joint, row.J);
    }
  }
  return work;
}

}  // namespace

double keptForRebound(const Island& island, const Component& component, const IslandRow& row,
                      const Workspace& end, size_t r, double u) {
  return PartImpulses(row, end, r).kept(island, component, row, u);
}

double keptForRebounds(const Island& island, const Component& component, const Workspace& end) {
  double sum = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (!joint.keeps_for_rebound) continue;
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.keepsForRebound()) continue;
      const double u = row.J.along(meanVelocity(island, joint, 0, component, end.v),
                                   meanVelocity(island, joint, 1, component, end.v));
      sum += keptForRebound(island, component, row, end, size_t(joint.row_of_component + i), u);
    }
  }
  return sum;
}

double workOfJoints(const Island& island, const Component& component, const Workspace& end) {
  return workFrom(&IslandBody::v0, island, component, end);
}

double workAmongContacts(const Island& island, const Component& component, const Workspace& end) {
  double work = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const Vector6d a = meanVelocity(island, joint, 0, component, end.v),
                   b = meanVelocity(island, joint, 1, component, end.v);
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      const double u = row.J.along(a, b);
      const PartImpulses parts(row, end, r);
      work += end.lambda[r] * u - parts.work(u) + stored(island, row, end, r) +
              parts.kept(island, component, row, u) - row.reboundEnergy();
    }
  }
  return work;
}

double workOfPoses(const Island& island, const Component& component, const Vector6d* changes) {
  double work = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    Vector6d by_forces = body.by_forces;
    if (body.acts_in_halves) by_forces += body.by_forces_at_end;
    work -= body.product(by_forces / island.dt, changes[i]);
  }
  return work;
}

bool isEven(const Island& island, const Component& component, double tolerance,
            const Workspace& end) {
  if (!end.is_resolved || island.anyUnmovedMoves()) return false;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const Vector6d &a = island.velocity(joint.body[0], &IslandBody::v0),
                   &b = island.velocity(joint.body[1], &IslandBody::v0);
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.law.isEquality()) {
        if (end.pieces[r].acts || end.lambda[r] != 0) return false;
        continue;
      }
      if (end.pieces[r].softness > 0 || !(std::abs(row.J.along(a, b)) * island.dt <= tolerance))
        return false;
    }
  }
  return true;
}

double beyondRounding(const Island& island, const Component& component, double excess,
                      EnergyLedger& ledger) {
  double sum = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    const double force = body.mass * (body.v_free - body.v0).head<3>().norm() / island.dt;
    sum += force * (inDouble(body.start.getOrigin()).norm() + body.radius());
  }
  ledger.rounding = double(SIMD_EPSILON) * sum;
  return excess > ledger.rounding ? excess : 0;
}

double gainOverForces(const Island& island, const Component& component, const Workspace& end) {
  return workFrom(&IslandBody::v_free, island, component, end);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
