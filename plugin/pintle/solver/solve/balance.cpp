#include <pintle/solver/solve/balance.h>

#include <pintle/solver/energy/energy_ledger.h>
#include <pintle/solver/model/free_rotor.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// a M b, by the inertia that a body has when it is turned.
double product(const IslandBody& body, const Matrix3d& turn, const Vector6d& a, const Vector6d& b) {
  const Vector3d w_a = turn.transpose() * a.tail<3>(), w_b = turn.transpose() * b.tail<3>();
  return body.mass * a.head<3>().dot(b.head<3>()) + w_a.dot(body.inertia * w_b);
}

// The motion of all bodies as one, with their momenta.
class AsOne {
 public:
  AsOne(const IslandBody* bodies, const std::vector<Vector6d>& v,
        const std::vector<MovedBody>& end) {
    double mass = 0;
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = bodies[i].mass;
      mass += m;
      m_center += m * centerOf(bodies[i], end[i]);
      m_velocity += m * v[i].head<3>();
    }
    m_center /= mass;
    m_velocity /= mass;
    Vector3d spin = Vector3d::Zero();
    Matrix3d inertia = Matrix3d::Zero();
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = bodies[i].mass;
      const Matrix3d own = end[i].turn * bodies[i].inertia * end[i].turn.transpose();
      const Vector3d d = centerOf(bodies[i], end[i]) - m_center;
      spin += m * cross(d, v[i].head<3>()) + own * v[i].tail<3>();
      inertia += own + m * (d.dot(d) * Matrix3d::Identity() - d * d.transpose());
    }
    m_spin = inertia.ldlt().solve(spin);
  }
  Vector6d of(const IslandBody& body, const MovedBody& end) const {
    Vector6d v;
    v << m_velocity + cross(m_spin, Vector3d(centerOf(body, end) - m_center)), m_spin;
    return v;
  }

 private:
  static Vector3d centerOf(const IslandBody& body, const MovedBody& end) {
    return inDouble(body.start.getOrigin()) + end.move;
  }
  Vector3d m_center = Vector3d::Zero(), m_velocity = m_center, m_spin = m_center;
};

// Whether nothing holds one of its bodies but its joints.
bool isFree(const Island& island, const Component& component) {
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i)
    for (const bool is_locked : island.bodies[size_t(i)].locked)
      if (is_locked) return false;
  return true;
}

// v = r + w, of which w is scaled. All impulses work by (v' - v*) M (v' + v0) / 2, and poses, which end where they did, are moved against
// the forces by what v' goes less: with v' = r + s w, both by
//   (s - 1) ((s + 1) w M w + w M (2 r + by_forces)) / 2,   M that of the end
// more than with v. That is to be -`energy`, or as much of it as can be: it doubles at most what there is. Returns its work.
double scale(const Island& island, const Component& component, bool is_free, double energy,
             Workspace& work) {
  const IslandBody* const bodies = &island.bodies[size_t(component.first_body)];
  std::vector<Vector6d>&v = work.v, &stays = work.change;
  stays.assign(v.size(), Vector6d::Zero());
  if (is_free) {
    const AsOne as_one(bodies, v, work.moved);
    for (size_t i = 0; i < v.size(); ++i) stays[i] = as_one.of(bodies[i], work.moved[i]);
  }
  double a = 0, b = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vector6d w = v[i] - stays[i];
    const Matrix3d& turn = work.moved[i].turn;
    a += product(bodies[i], turn, w, w);
    // (Forces in halves are booked by how far bodies go.)
    if (!bodies[i].acts_in_halves) b += bodies[i].product(w, bodies[i].by_forces);
    if (is_free) b += 2 * product(bodies[i], turn, w, stays[i]);
  }
  if (!(a > 0)) return 0;
  const double root2 = b * b + 4 * a * (a + b - 2 * std::fmax(energy, -a / 2));
  // Of two roots the one that leads to s = 1 where the energy is none.
  const double root = std::copysign(std::sqrt(std::fmax(root2, 0)), 2 * a + b);
  const double part = std::clamp((root - b) / (2 * a), 0., std::sqrt(2.));
  for (size_t i = 0; i < v.size(); ++i) {
    const Vector6d change = (part - 1) * (v[i] - stays[i]);
    v[i] += change;
    work.way[i] += change;  // the next one begins with as much less
  }
  return (part - 1) * ((part + 1) * a + b) / 2;
}

}  // namespace

double energyOfTurns(const Island& island, const Component& component, const Workspace& end) {
  double sum = 0;
  for (size_t i = 0; i < end.v.size(); ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body) + i];
    const Matrix3d by_way = turnOfStep(body, end.way[i].tail<3>(), island.dt);
    sum += product(body, end.moved[i].turn, end.v[i], end.v[i]) -
           product(body, by_way, end.v[i], end.v[i]);
  }
  return sum / 2;
}

double balance(const Island& island, const Component& component, const SolverOptions& options,
               ComponentMemory& kept) {
  if (kept.solution == Solution::even && actsInHalves(island, component)) return 0;
  const double energy =
      kept.solution == Solution::even
          ? std::fmax(kept.ledger.given, 0) + kept.work_done
          : excess(island, component, kept.work_done, options.ledger_share, kept.ledger);
  if (energy == 0) return 0;
  const bool is_free = !component.is_anchored;
  if (is_free && !isFree(island, component)) return 0;
  const double for_rebounds = keptForRebounds(island, component, kept.work),
               work = scale(island, component, is_free, energy, kept.work);
  return work + keptForRebounds(island, component, kept.work) - for_rebounds;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
