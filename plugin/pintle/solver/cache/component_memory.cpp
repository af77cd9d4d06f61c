#include <pintle/solver/cache/component_memory.h>

#include <pintle/solver/system/load_stiffness.h>
#include <pintle/solver/system/softness.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

void remember(const Island& island, const Component& component,
              std::unique_ptr<ComponentMemory>& memory) {
  const IslandJoint* const joints = &island.joints[size_t(component.first_joint)];
  const auto bodiesOf = [&](const IslandJoint& joint) {
    std::array<int, 2> of = joint.body;
    for (int& body : of) body = body < 0 ? -1 : body - component.first_body;
    return of;
  };
  const auto locksOf = [&](int i) -> const std::array<bool, 6>& {
    return island.bodies[size_t(component.first_body + i)].locked;
  };
  bool same = memory != nullptr && int(memory->constraints.size()) == component.joints &&
              int(memory->locks.size()) == component.bodies;
  for (int i = 0; same && i < component.bodies; ++i) same = memory->locks[size_t(i)] == locksOf(i);
  for (int c = 0; same && c < component.joints; ++c)
    same = memory->constraints[size_t(c)] == joints[c].constraint &&
           memory->bodies[size_t(c)] == bodiesOf(joints[c]);
  if (!same) {
    EnergyLedger ledger;
    if (memory != nullptr) ledger = memory->ledger;
    memory = std::make_unique<ComponentMemory>();
    memory->ledger = ledger;
    for (int c = 0; c < component.joints; ++c) {
      memory->constraints.push_back(joints[c].constraint);
      memory->bodies.push_back(bodiesOf(joints[c]));
    }
    // What the factors of a body hold hangs on the world, too: joints between two such bodies may repeat each other.
    std::vector<std::array<int, 2>> held = memory->bodies;
    for (int i = 0; i < component.bodies; ++i) {
      const auto& lock = locksOf(i);
      memory->locks.push_back(lock);
      if (std::find(lock.begin(), lock.end(), true) != lock.end()) held.push_back({i, -1});
    }
    memory->in_loop = findLoops(component.bodies, held);
    memory->K.analyse(memory->bodies, memory->locks);
  }
  std::vector<int>& sizes = memory->sizes;
  bool same_sizes = same && int(sizes.size()) == component.joints;
  sizes.resize(size_t(component.joints));
  for (int c = 0; c < component.joints; ++c) {
    same_sizes = same_sizes && sizes[size_t(c)] == joints[c].rows;
    sizes[size_t(c)] = joints[c].rows;
  }
  if (same_sizes) return;
  memory->K.setSizes(sizes);
  memory->forecast.reserve(size_t(component.bodies));
  memory->work.reserve(size_t(component.bodies), size_t(component.joints), size_t(component.rows),
                       memory->K.vectorSize());
}

int ComponentMemory::knownRows(int c, const IslandJoint& joint) const {
  if (size_t(c) >= m_rows.size()) return 0;
  const int before = m_rows[size_t(c)];
  return before == joint.rows ? before : std::min(std::min(before, joint.rows), joint.equalities);
}

namespace {

// All momentum that there is.
class MostImpulse {
 public:
  /// Rows of a joint bear what its points bear on their levers, too: `lever` is the longest.
  MostImpulse(const IslandBody& first, double lever)
      : m_low(first.start.getOrigin()), m_high(m_low), m_radius(lever) {}
  void add(const IslandBody& body, const Vector6d& v) {
    const double radius = body.radius();
    m_linear += body.mass * (v.head<3>().norm() + radius * v.tail<3>().norm());
    m_radius = std::max(m_radius, radius);
    m_low.setMin(body.start.getOrigin());
    m_high.setMax(body.start.getOrigin());
  }
  /// After the last one.
  void finish() { m_angular = m_linear * (double((m_high - m_low).length()) + m_radius); }
  double of(const IslandRow& row, double impulse) const {
    if (std::abs(impulse) <= std::min(m_linear, m_angular)) return impulse;
    const bool is_linear = row.J.L_a != Vector3d::Zero() || row.J.L_b != Vector3d::Zero();
    const double most = is_linear ? m_linear : m_angular;
    return std::clamp(impulse, -most, most);
  }

 private:
  double m_linear = 0, m_angular = 0;  ///< N s and N m s
  btVector3 m_low, m_high;             ///< of centres of mass
  double m_radius;                     ///< m: the largest one of gyration, or the lever
};

}  // namespace

// Velocities are those that are foreseen.
void ComponentMemory::begin(const Island& island, const Component& component) {
  const bool known = int(forecast.size()) == component.bodies;
  work.v.resize(size_t(component.bodies));
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    work.v[size_t(i)] =
        known ? Vector6d(body.v0 + forecast.change(size_t(i), island.dt)) : body.v_free;
  }
  work.lambda.resize(size_t(component.rows));
  setZero(size_t(component.rows), work.at_end);
  work.last_at_end.resize(size_t(component.rows));
  work.load.resize(size_t(component.rows));
  size_t before = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const int rows = knownRows(c, joint);
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      work.last_at_end[r] = i < rows ? m_at_end[before + size_t(i)] : 0;
      work.lambda[r] = i < rows ? m_lambda[before + size_t(i)] - work.last_at_end[r] : 0;
      work.load[r] = i < rows ? m_load[before + size_t(i)] : 0;
    }
    if (size_t(c) < m_rows.size()) before += size_t(m_rows[size_t(c)]);
  }
}

// To first order: -dt I^-1 (w x I w) of both.
void ComponentMemory::followTurns(Island& island, const Component& component) const {
  if (int(forecast.size()) != component.bodies) return;
  for (int i = 0; i < component.bodies; ++i) {
    IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector3d ahead = forecast.ahead(size_t(i)).tail<3>(), w = body.v0.tail<3>();
    if (ahead.isZero(0) || !isGyroscopic(*body.body)) continue;
    const Vector3d by = cross(ahead, Vector3d(body.inertia * (w + ahead))) +
                        cross(w, Vector3d(body.inertia * ahead));
    body.v_free.tail<3>() -= island.dt * (body.inverse_inertia * by);
  }
}

// They are stretched no longer than they are, and with no more energy than they have stored, however their softness has changed
// (which is relative to K).
void ComponentMemory::stretchSprings(Island& island, const Component& component) {
  m_last_stretch.swap(m_stretch);
  m_stretch.clear();
  const IslandJoint* const joints = &island.joints[size_t(component.first_joint)];
  if (std::none_of(joints, joints + component.joints,
                   [](const IslandJoint& joint) { return joint.has_springs; }))
    return;
  m_stretch.resize(size_t(component.rows));
  size_t before = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = joints[c];
    const int rows = joint.has_springs && !m_last_stretch.empty() ? knownRows(c, joint) : 0;
    for (int i = 0; i < rows; ++i) {
      IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.isSoft()) continue;
      RowSpring& spring = row.extras->spring;
      const Stretch& last = m_last_stretch[before + size_t(i)];
      const double most = spring.stretchOf(last.energy, row.softness(), island.dt);
      spring.stretch = std::clamp(std::clamp(last.length, -most, most), std::fmin(spring.open, 0),
                                  std::fmax(spring.open, 0));
      row.law.setTarget(spring.part, row.law.part(spring.part).target - spring.stretch / island.dt);
      row.open -= spring.stretch;
    }
    if (size_t(c) < m_rows.size()) before += size_t(m_rows[size_t(c)]);
  }
}

// What forces ask of joints is as much as levers make of it: a taut rope bears many times its weight. Of the rest, which are blows, and
// what joints that contradict each other do to each other, and which would grow from step to step, the next step begins with no more than all
// momentum that there is. Contacts begin with impulses of their own. But what lies on bodies is a load that their joints bear.
void ComponentMemory::keepImpulses(const Island& island, const Component& component,
                                   bool has_contacts, double least_pivot) {
  m_lambda = work.lambda;
  m_at_end = work.at_end;
  if (holdsEnd())
    for (size_t r = 0; r < m_lambda.size(); ++r) m_lambda[r] += work.last_at_end[r] - m_at_end[r];
  m_borne.clear();
  if (solves == 0) return;  // so they were before
  MostImpulse most(island.bodies[size_t(component.first_body)], component.lever);
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    most.add(body, work.v[size_t(i)] + body.v_free - body.v0);
  }
  most.finish();
  bool is_allowed = true;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    is_allowed = is_allowed && (row.law.hasDrives() || most.of(row, m_lambda[r]) == m_lambda[r]);
  });
  if (is_allowed) return;
  const bool knows_forces = hasFactor() && K.factorise(least_pivot);
  const auto bound = [&](bool with_contacts, std::vector<double>& impulses) {
    impulses = work.lambda;
    if (knows_forces) findWhatOthersAsk(island, component, with_contacts);
    forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t r) {
      if (row.law.hasDrives()) return;
      const double by_others =
          knows_forces && work.pieces[r].acts ? work.x[K.row(c, i)] * row.by_root_K : 0;
      impulses[r] = by_others + most.of(row, impulses[r] - by_others);
    });
  };
  bound(false, m_lambda);
  if (has_contacts) bound(true, m_borne);
}

Vector6d ComponentMemory::leftOf(const IslandBody& body, int i, const Vector6d& v) {
  Vector6d to = v;
  to.tail<3>() = K.bodies()[size_t(i)].angular * (body.inertia * v.tail<3>());
  return to;
}

void ComponentMemory::findImpulses(const std::vector<Vector6d>& change) {
  setZero(K.vectorSize(), work.x);
  K.subtractVelocities(change.data(), work.x.data());
  K.solve(work.x.data());
}

// work.x = -K^-1 J of what forces do to velocities, A^-1 M (v* - v_0), or of what contacts do, too: all but what joints do,
// v - A^-1 (M v_0 + J^T lambda).
void ComponentMemory::findWhatOthersAsk(const Island& island, const Component& component,
                                        bool with_contacts) {
  std::vector<Vector6d>& change = work.change;
  change.assign(size_t(component.bodies), Vector6d::Zero());
  if (with_contacts) K.addResponse(work.y.data(), change.data());
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    Vector6d& of = change[size_t(i)];
    of = with_contacts ? Vector6d(work.v[size_t(i)] - of - leftOf(body, i, body.v0))
                       : leftOf(body, i, body.v_free - body.v0);
  }
  findImpulses(change);
}

// Else the load that is foreseen is that of another motion, and what was taken comes back: a taut cable would quiver for ever. Where a row
// is bounded or gives, its impulse does not follow from velocities.
void ComponentMemory::followVelocities(const Island& island, const Component& component,
                                       double least_pivot) {
  bool are_rigid = true;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    are_rigid = are_rigid && row.law.isEquality() && !(work.pieces[r].softness > 0);
  });
  if (!are_rigid || !K.factorise(least_pivot)) return;
  std::vector<Vector6d>& change = work.change;
  change.clear();
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    change.push_back(leftOf(body, i, body.v_free - work.v[size_t(i)]));
  }
  findImpulses(change);
  forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t r) {
    if (work.pieces[r].acts) m_lambda[r] = work.lambda[r] = work.x[K.row(c, i)] * row.by_root_K;
  });
}

void ComponentMemory::keep(const Island& island, const Component& component) {
  forecast.take(&island.bodies[size_t(component.first_body)], work.way, work.v, island.dt,
                solves <= 1);
  m_rows = sizes;
  addLoad(m_borne.empty() ? m_lambda : m_borne, work);
  m_load.swap(work.load);  // begin fills it anew
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (!joint.has_springs) continue;
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.isSoft()) continue;
      const double u = work.u[r];
      const RowSpring& spring = row.extras->spring;
      m_stretch[r] = {
          spring.length(u, island.dt),
          spring.energyAfter(u, work.impulseOfSpring(row, r), row.softness(), island.dt)};
    }
  }
}

void ComponentMemory::reset() {
  constraints.clear();  // those of no component
  ledger = {};
  residual = work_done = 0;
  is_settled = false;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
