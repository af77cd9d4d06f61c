#include <pintle/solver/balance.h>

#include <pintle/solver/energy_ledger.h>
#include <pintle/solver/joint_matrix.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

Matrix3d turnOf(const Vector3d& by) {
  const double angle = by.norm();
  return Eigen::AngleAxisd(angle, angle > 0 ? Vector3d(by / angle) : Vector3d::UnitX())
      .toRotationMatrix();
}

// A body at the end of the step: changed, and then moved.
struct AtEnd {
  Vector3d x;
  Matrix3d turn, inertia;

  AtEnd(const IslandBody& body, const Vector6d& v, const PoseChange& change, double dt)
      : x(inDouble(body.start.getOrigin()) + dt * v.head<3>() + change.head<3>()),
        turn(RotationOfStep(v.tail<3>(), dt).matrix() * turnOf(change.tail<3>())),
        inertia(turn * body.inertia * turn.transpose()) {}
};

// The motion of all bodies as one, with their momenta.
class AsOne {
 public:
  AsOne(const Island& island, const Component& component, const std::vector<AtEnd>& end,
        const std::vector<Vector6d>& v) {
    double mass = 0;
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = island.bodies[size_t(component.first_body) + i].mass;
      mass += m;
      m_center += m * end[i].x;
      m_velocity += m * v[i].head<3>();
    }
    m_center /= mass;
    m_velocity /= mass;
    Vector3d spin = Vector3d::Zero();
    Matrix3d inertia = Matrix3d::Zero();
    for (size_t i = 0; i < v.size(); ++i) {
      const double m = island.bodies[size_t(component.first_body) + i].mass;
      const Vector3d d = end[i].x - m_center;
      spin += m * cross(d, v[i].head<3>()) + end[i].inertia * v[i].tail<3>();
      inertia += end[i].inertia + m * (d.dot(d) * Matrix3d::Identity() - d * d.transpose());
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

// The change of pose before a step with v that leads to the same end.
PoseChange changeTo(const AtEnd& end, const IslandBody& body, const Vector6d& v, double dt) {
  const Eigen::AngleAxisd turn(
      Matrix3d(RotationOfStep(v.tail<3>(), dt).matrix().transpose() * end.turn));
  PoseChange change;
  change << end.x - inDouble(body.start.getOrigin()) - dt * v.head<3>(), turn.angle() * turn.axis();
  return change;
}

}  // namespace

double energyOfArcs(const Island& island, const Component& component, const Workspace& end) {
  double sum = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector6d by = end.v[size_t(i)] - body.v_free;
    sum += body.product(by, by);
  }
  return sum / 4;
}

double energyOfTurns(const Island& island, const Component& component, const Workspace& end) {
  double turn2 = 0, kinetic = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const Vector6d& v = end.v[size_t(i)];
    kinetic += gainOf(island.bodies[size_t(component.first_body + i)], Vector6d::Zero(), v);
    turn2 = std::fmax(turn2, v.tail<3>().squaredNorm() * island.dt * island.dt);
  }
  return turn2 / 4 * kinetic;
}

bool actsByArcs(const Island& island, const Component& component, const Workspace& end) {
  for (const Vector6d& v : end.v)
    if (!RotationOfStep::follows(v.tail<3>(), island.dt)) return false;
  bool by_stops = false;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    by_stops = by_stops || (!row.law.isEquality() && end.lambda[r] != 0);
  });
  return !by_stops;
}

double workOfGaps(const Island& island, const Component& component, const Workspace& end,
                  double tolerance) {
  double sum = 0;
  forEachRow(island, component,
             [&](int, int, const IslandRow&, size_t r) { sum += std::abs(end.lambda[r]); });
  return sum * tolerance / island.dt;
}

// v = r + w, of which w is scaled. All impulses work by (v' - v*) M (v' + v0) / 2: with v' = r + s w, by
//   (s - 1) ((s + 1) w M w + w M (2 r + v0 - v*)) / 2
// more than with v.
double balance(const Island& island, const Component& component, bool is_free, double energy,
               std::vector<Vector6d>& v, PoseChange* changes) {
  const IslandBody* const bodies = &island.bodies[size_t(component.first_body)];
  std::vector<AtEnd> end;
  for (size_t i = 0; i < v.size(); ++i) end.emplace_back(bodies[i], v[i], changes[i], island.dt);
  std::vector<Vector6d> stays(v.size(), Vector6d::Zero());
  if (is_free) {
    const AsOne as_one(island, component, end, v);
    for (size_t i = 0; i < v.size(); ++i) stays[i] = as_one.of(end[i]);
  }
  double a = 0, b = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vector6d w = v[i] - stays[i];
    a += bodies[i].product(w, w);
    b += bodies[i].product(w, 2 * stays[i] + bodies[i].v0 - bodies[i].v_free);
  }
  if (!(a > 0)) return 0;
  const double root2 = b * b + 4 * a * (a + b - 2 * std::fmax(energy, -a / 2));
  const double scale =
      std::clamp((std::sqrt(std::fmax(root2, 0)) - b) / (2 * a), 0., std::sqrt(2.));
  double work = (scale - 1) * ((scale + 1) * a + b) / 2 - workOfPoses(island, component, changes);
  for (size_t i = 0; i < v.size(); ++i) {
    v[i] = stays[i] + scale * (v[i] - stays[i]);
    changes[i] = changeTo(end[i], bodies[i], v[i], island.dt);
  }
  work += workOfPoses(island, component, changes);
  return work;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
