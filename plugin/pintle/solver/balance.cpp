#include <pintle/solver/balance.h>

#include <pintle/solver/energy_ledger.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A body at the end of the step: changed, and then moved.
struct AtEnd {
  Vector3d x;
  Matrix3d turn, inertia;

  AtEnd(const IslandBody& body, const Vector6d& v, const PoseChange& change, double dt)
      : x(inDouble(body.start.getOrigin()) + dt * v.head<3>() + change.head<3>()),
        turn(RotationOfStep(v.tail<3>(), dt).matrix() * turnBy(change.tail<3>())),
        inertia(turn * body.inertia * turn.transpose()) {}
};

// The motion of all bodies as one, with their momenta.
class AsOne {
 public:
  AsOne(const Island& island, const IslandBody* bodies, const std::vector<Vector6d>& v,
        const PoseChange* changes) {
    double mass = 0;
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = bodies[i].mass;
      mass += m;
      m_center += m * AtEnd(bodies[i], v[i], changes[i], island.dt).x;
      m_velocity += m * v[i].head<3>();
    }
    m_center /= mass;
    m_velocity /= mass;
    Vector3d spin = Vector3d::Zero();
    Matrix3d inertia = Matrix3d::Zero();
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = bodies[i].mass;
      const AtEnd end(bodies[i], v[i], changes[i], island.dt);
      const Vector3d d = end.x - m_center;
      spin += m * cross(d, v[i].head<3>()) + end.inertia * v[i].tail<3>();
      inertia += end.inertia + m * (d.dot(d) * Matrix3d::Identity() - d * d.transpose());
    }
    m_spin = inertia.ldlt().solve(spin);
  }
  Vector6d of(const AtEnd& body) const {
    Vector6d v;
    v << m_velocity + cross(m_spin, Vector3d(body.x - m_center)), m_spin;
    return v;
  }

 private:
  Vector3d m_center = Vector3d::Zero(), m_velocity = m_center, m_spin = m_center;
};

// Whether nothing holds one of its bodies but its joints.
bool isFree(const Island& island, const Component& component) {
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i)
    for (const bool is_locked : island.bodies[size_t(i)].locked)
      if (is_locked) return false;
  return true;
}

// J: the most that arcs hold, by the velocities with which the step ends: 2 S.
double energyOfArcs(const Island& island, const Component& component, const Workspace& end) {
  double sum = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector6d by = end.v[size_t(i)] - body.v_free;
    sum += body.product(by, by);
  }
  return sum / 4;
}

// J: of the same, what is by turns alone, and by no load: 1/4 phi^2 of the kinetic energy, of the largest turn phi of a body in the step.
double energyOfTurns(const Island& island, const Component& component, const Workspace& end) {
  double turn2 = 0;
  for (const Vector6d& v : end.v)
    turn2 = std::fmax(turn2, v.tail<3>().squaredNorm() * island.dt * island.dt);
  return turn2 / 4 * kineticEnergy(island, component, end.v);
}

// Whether that is all that joints give and take: not where a stop bears something, which takes, nor where a body turns further than
// Bullet follows it (turn.h).
bool actsByArcs(const Island& island, const Component& component, const Workspace& end) {
  for (const Vector6d& v : end.v)
    if (!RotationOfStep::follows(v.tail<3>(), island.dt)) return false;
  for (int c = component.first_joint; c < component.first_joint + component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(c)];
    if (joint.bounded == 0) continue;
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      const auto r = size_t(joint.row_of_component + i);
      if (row.law.isEquality() || end.lambda[r] == 0) continue;
      const AxisLaw::Parts impulse = end.split(row.law, r);
      for (int k = 0; k < row.law.parts(); ++k)
        if (row.law.part(k).role == Axis::limit &&
            std::abs(impulse[size_t(k)]) > rounding_share * std::abs(end.lambda[r]))
          return false;
    }
  }
  return true;
}

// J: what joints may do that are open by `tolerance` (m or rad) at the end of the step.
double workOfGaps(const Workspace& end, double tolerance, double dt) {
  double sum = 0;
  for (const double lambda : end.lambda) sum += std::abs(lambda);
  return sum * tolerance / dt;
}

// Whether what arcs hold is more than joints do by their gaps, and nothing but arcs.
bool mayWhirl(const Island& island, const Component& component, double gaps, const Workspace& end) {
  return energyOfTurns(island, component, end) > gaps && actsByArcs(island, component, end);
}

// v = r + w, of which w is scaled. All impulses work by (v' - v*) M (v' + v0) / 2, and poses, which end where they did, are moved against
// the forces by what v' goes less: with v' = r + s w, both by
//   (s - 1) ((s + 1) w M w + w M (2 r + v* - v0)) / 2
// more than with v. That is to be -`energy`, or as much of it as can be: it doubles at most what there is. Returns its work.
double scale(const Island& island, const Component& component, bool is_free, double energy,
             Workspace& work, PoseChange* changes) {
  const IslandBody* const bodies = &island.bodies[size_t(component.first_body)];
  std::vector<Vector6d>&v = work.v, &stays = work.stays;
  stays.assign(v.size(), Vector6d::Zero());
  if (is_free) {
    const AsOne as_one(island, bodies, v, changes);
    for (size_t i = 0; i < v.size(); ++i)
      stays[i] = as_one.of(AtEnd(bodies[i], v[i], changes[i], island.dt));
  }
  double a = 0, b = 0, by_forces = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vector6d w = v[i] - stays[i], forces = bodies[i].v_free - bodies[i].v0;
    a += bodies[i].product(w, w);
    b += bodies[i].product(w, 2 * stays[i] + forces);
    by_forces += bodies[i].product(w, forces);
  }
  if (!(a > 0)) return 0;
  const double root2 = b * b + 4 * a * (a + b - 2 * std::fmax(energy, -a / 2));
  // Of two roots the one that leads to s = 1 where the energy is none.
  const double root = std::copysign(std::sqrt(std::fmax(root2, 0)), 2 * a + b);
  const double part = std::clamp((root - b) / (2 * a), 0., std::sqrt(2.));
  const double by_velocities = (part - 1) * ((part + 1) * a + b - 2 * by_forces) / 2,
               by_poses = workOfPoses(island, component, changes);
  for (size_t i = 0; i < v.size(); ++i) {
    const Vector6d next = stays[i] + part * (v[i] - stays[i]);
    changes[i] = stays[i].isZero(0) && changes[i].isZero(0)
                     ? changeForPart(part, v[i], island.dt)
                     : changeFor(next, v[i], changes[i], island.dt);
    v[i] = next;
  }
  return by_velocities + workOfPoses(island, component, changes) - by_poses;
}

// Both are impulses along the rows of the start: l = -A^-1 J^T K^-1 J (v_base - v0) stops what forces would do to them, and c follows
// their bend. Returns the most that c holds, 2 S of it, J: 0 where bodies swing.
double findWhirls(const Island& island, const Component& component, double least_pivot,
                  JointMatrix& K, Workspace& work) {
  if (!K.factorise(least_pivot)) return 0;  // what was foreseen may have needed none
  const IslandBody* const bodies = &island.bodies[size_t(component.first_body)];
  std::vector<Vector6d>& change = work.stays;
  std::vector<double>&x = work.x, &by_forces = work.by_forces, &by_joints = work.by_joints;
  const auto measure = [&](std::vector<double>& to) {
    setZero(x.size(), to);
    K.subtractVelocities(change.data(), to.data());
  };
  change.clear();
  for (int i = 0; i < component.bodies; ++i) change.push_back(work.base[size_t(i)] - bodies[i].v0);
  measure(by_forces);
  change.clear();
  double all2 = 0;
  for (int i = 0; i < component.bodies; ++i) {
    change.push_back(work.base[size_t(i)] - work.v[size_t(i)]);
    all2 += bodies[i].product(change.back(), change.back());
  }
  measure(by_joints);
  x = by_forces;
  K.solve(x.data());
  // l M l = x . J l, and c M l = x . J c: for l is an impulse x. (Of bodies with load stiffness, M has it here, and not in all2: so
  // less of their motion counts as c.)
  double ll = 0, al = 0;
  for (size_t k = 0; k < x.size(); ++k) {
    ll += x[k] * by_forces[k];
    al += x[k] * by_joints[k];
  }
  const double cc = all2 - 2 * al + ll;
  return cc > 2 * std::abs(al - ll) ? cc / 4 : 0;
}

double whirls(const Island& island, const Component& component, const SolverOptions& options,
              ComponentMemory& kept) {
  if (!kept.whirls)
    kept.whirls = findWhirls(island, component, options.least_pivot, kept.K, kept.work);
  return *kept.whirls;
}

bool isOfArcs(double energy, const Island& island, const Component& component,
              const SolverOptions& options, ComponentMemory& kept) {
  const double gaps = workOfGaps(kept.work, options.newton_tolerance, island.dt);
  return std::abs(energy) > gaps &&
         std::abs(energy) <= energyOfArcs(island, component, kept.work) &&
         (component.is_anchored || isFree(island, component)) &&
         mayWhirl(island, component, gaps, kept.work) &&
         std::abs(energy) <= whirls(island, component, options, kept);
}

}  // namespace

void keepWhirls(const Island& island, const Component& component, const SolverOptions& options,
                ComponentMemory& kept) {
  const double gaps = workOfGaps(kept.work, options.newton_tolerance, island.dt);
  kept.whirls =
      mayWhirl(island, component, gaps, kept.work) ? whirls(island, component, options, kept) : 0;
}

bool isOfArcs(const Island& island, const Component& component, const SolverOptions& options,
              ComponentMemory& kept) {
  return isOfArcs(kept.ledger.given + kept.work_done, island, component, options, kept);
}

double balance(const Island& island, const Component& component, const SolverOptions& options,
               ComponentMemory& kept, PoseChange* changes) {
  EnergyLedger& ledger = kept.ledger;
  if (ledger.taken > 0)
    ledger.taken = std::fmin(ledger.taken, energyOfArcs(island, component, kept.work));
  const double of_arcs = std::fmax(ledger.given + kept.work_done, -ledger.taken),
               too_much = excess(island, component, kept.work_done, options.ledger_share, ledger);
  const bool by_arcs = kept.holds_end && isOfArcs(of_arcs, island, component, options, kept);
  const double energy = by_arcs ? of_arcs : too_much;
  if (energy == 0) return 0;
  const bool is_free = !component.is_anchored;
  if (is_free && !isFree(island, component)) return 0;
  const double for_rebounds = keptForRebounds(island, component, kept.work),
               work = scale(island, component, is_free, energy, kept.work, changes);
  if (by_arcs) ledger.taken = std::fmax(0, ledger.taken - work);
  return work + keptForRebounds(island, component, kept.work) - for_rebounds;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
