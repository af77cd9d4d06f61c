#include <pintle/solver/solve/step.h>

#include <pintle/finite.h>
#include <pintle/solver/bullet/joint_report.h>
#include <pintle/solver/constants.h>
#include <pintle/solver/model/row_velocities.h>
#include <pintle/solver/solve/balance.h>
#include <pintle/solver/solve/chord.h>
#include <pintle/solver/solve/end_velocities.h>
#include <pintle/solver/solve/overflow.h>
#include <pintle/solver/system/load_stiffness.h>
#include <pintle/solver/system/softness.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Less than a rounding error of a rounding error is nothing: its products would be denormal numbers, with which a processor is slow.
Vector3d rounded(const Vector3d& change, double of) {
  const double error = double(SIMD_EPSILON), least = error * error * of;
  return (change.array().abs() < least).select(0, change);
}

void move(btRigidBody& body, const PoseChange& by) {
  btTransform to = body.getWorldTransform();
  to.setOrigin(to.getOrigin() + toBullet(rounded(by.head<3>(), inDouble(to.getOrigin()).norm())));
  // (Bullet makes the axes orthogonal in each step.)
  const Matrix3d turn = turnBy(by.tail<3>()), R = turn * inDouble(to.getBasis());
  for (int i = 0; i < 3; ++i) to.getBasis()[i] = toBullet(rounded(R.row(i), 1));
  body.setWorldTransform(to);
}

// By impulses, of the velocity of one of Bullet's bodies.
Vector6d changeOf(const btSolverBody& of) {
  Vector6d change;
  change << inDouble(of.m_deltaLinearVelocity), inDouble(of.m_deltaAngularVelocity);
  return change;
}

// The velocity of one of Bullet's bodies.
void write(const Vector6d& v, btSolverBody& to) {
  const Vector6d change = v - freeVelocity(to);
  to.m_deltaLinearVelocity = toBullet(rounded(change.head<3>(), v.head<3>().norm()));
  to.m_deltaAngularVelocity = toBullet(rounded(change.tail<3>(), v.tail<3>().norm()));
}

}  // namespace

size_t IslandStep::bytes() const {
  return m_builder.bytes() + m_pass_memory.bytes() + m_poses_memory.bytes() +
         m_chord_memory.bytes() + m_end_memory.bytes() + m_projection_memory.bytes() +
         m_groups.bytes() + m_island.bytes() +
         bytesOf(m_components, m_kept, m_contacts, m_velocities, m_pose_changes, m_before_others,
                 m_counted, m_bodies_alone, m_blocks, m_free_moved, m_free_velocity) +
         m_free_forces.bytes();
}

void IslandStep::begin(const btContactSolverInfo& info) {
  m_builder.begin(info);
  m_contacts.clear();
  m_pose_changes.clear();
}

bool IslandStep::endJoints() {
  m_builder.finish(m_components);
  return !m_components.empty();
}

void IslandStep::addContacts(btConstraintArray& rows, const SolverBodies& bodies,
                             bool are_friction) {
  m_builder.addContacts(rows, bodies, are_friction, m_contacts);
}

void IslandStep::solve(const btContactSolverInfo& info, SolverBodies& bodies,
                       const PassOverOthers& others, WorldMemory& memory) {
  m_report = {};
  m_report.components = int(m_components.size());
  m_report.tier = 1;
  m_sweeps = info.m_numIterations;
  m_turn_share = double(info.m_splitImpulseTurnErp);
  m_has_others = bool(others);
  if (others)
    for (IslandBody& of : m_island.bodies) {
      const Vector6d change = changeOf(bodies[of.solver_body]);
      of.v_free += change;
      of.by_forces += change;
    }
  m_pose_changes.assign(m_island.bodies.size(), PoseChange::Zero());
  beginComponents(memory);
  do {
    solveInTurns(bodies, others);
  } while (breakOverloaded());
  finishComponents(bodies);
  writeVelocities(bodies);
  // The impulse of what equalities hold says nothing of the next step.
  for (const ContactRow& row : m_contacts)
    row.from->m_appliedImpulse = row.is_held ? 0 : Scalar(row.impulse);
  memory.add(m_report);
}

void IslandStep::writeVelocities(SolverBodies& bodies) const {
  for (size_t i = 0; i < m_island.bodies.size(); ++i)
    write(m_velocities[i], bodies[m_island.bodies[i].solver_body]);
}

// Passes over other rows come before bodies that overflow are left to forces.
void IslandStep::writeVelocitiesForOthers(SolverBodies& bodies) const {
  for (size_t i = 0; i < m_island.bodies.size(); ++i) {
    const IslandBody& of = m_island.bodies[i];
    btSolverBody& to = bodies[of.solver_body];
    write(overflows(of, to, m_velocities[i], PoseChange::Zero(), m_island.dt) ? of.v_free
                                                                              : m_velocities[i],
          to);
  }
}

// What the island knows of other rows is how they change the velocities to which forces lead.
void IslandStep::solveInTurns(SolverBodies& bodies, const PassOverOthers& others) {
  double unmet =
      infinity;  // m and rad: by how much others have changed what joints and contacts were solved for
  for (int pass = 0;; ++pass) {
    const bool is_last = !others || pass == m_sweeps;
    if (unmet > (is_last ? 0 : m_options.contact_tolerance)) {
      solveJoints();
      unmet = 0;
    }
    if (is_last) return;
    writeVelocitiesForOthers(bodies);
    std::vector<Vector6d>& before = m_before_others;
    before.clear();
    for (const IslandBody& of : m_island.bodies) before.push_back(changeOf(bodies[of.solver_body]));
    others(pass);
    for (size_t i = 0; i < before.size(); ++i) {
      IslandBody& of = m_island.bodies[i];
      const Vector6d change = changeOf(bodies[of.solver_body]) - before[i];
      of.v_free += change;
      of.by_forces += change;
      m_velocities[i] += change;
      unmet = std::fmax(unmet, change.norm() * m_island.dt);
    }
  }
}

void IslandStep::moveFreely(SolverBodies& bodies, WorldMemory& memory) {
  m_counted.assign(size_t(bodies.size()), false);
  for (const IslandBody& body : m_island.bodies) m_counted[size_t(body.solver_body)] = true;
  HalfForces& forces = m_free_forces;
  std::vector<MovedBody>& moved = m_free_moved;
  std::vector<Vector6d>& v = m_free_velocity;
  for (int number = 0; number < bodies.size(); ++number) {
    if (m_counted[size_t(number)]) continue;
    const int i = m_builder.body(bodies, number);
    if (i < 0) continue;
    const Component alone{i, 1, 0, 0, 0};
    const IslandBody& body = m_island.bodies[size_t(i)];
    PoseChange& change = m_pose_changes.emplace_back(PoseChange::Zero());
    forces.begin(m_island, alone,
                 [&](const btRigidBody& of) -> MotionsOfBody& { return memory.motionsOf(of); });
    if (!forces.areTouched()) {
      forces.split(m_island, alone);
      moveBodies(m_island, alone, &body.v_free, moved);
      v.assign(1, velocityAtEnd(body, moved.front().turn, body.v_free));
      findChanges(m_island, alone, v, moved, &change);
      if (isFinite(v.front().sum()) &&
          !overflows(body, bodies[number], v.front(), change, m_island.dt)) {
        write(v.front(), bodies[number]);
      } else {
        change.setZero();
        forces.join(m_island, alone);
      }
    }
    const Vector6d left = freeVelocity(bodies[number]) + changeOf(bodies[number]);
    forces.keep(m_island, alone, &left);
  }
}

void IslandStep::movePoses() const {
  for (size_t i = 0; i < m_pose_changes.size(); ++i) {
    const IslandBody& of = m_island.bodies[i];
    const auto moveBy = [&](const PoseChange& by) {
      if (!by.isZero(0)) move(*const_cast<btRigidBody*>(of.body), by);
    };
    if (m_are_pushed) moveBy(m_island.dt * of.push);
    moveBy(m_pose_changes[i]);
  }
}

// Where a solve begins, with what its joints bore in the last steps.
ComponentMemory& IslandStep::begin(const Component& component) {
  ComponentMemory& kept = memoryOf(component);
  kept.begin(m_island, component);
  findSoftness(m_island, component, m_options, kept.in_loop, kept.work);
  findStiffness(m_island, component, m_options.stable_swing, kept.work);
  return kept;
}

// The first tier. Returns false where it does not converge, or where its joints would give too much.
bool IslandStep::solveByChord(const Component& component) {
  ComponentMemory& kept = begin(component);
  const SolveReport done = pintle::solveByChord(
      m_island, component, m_options, kept.ledger.with_forces, kept.K, kept.work, m_chord_memory);
  m_report.newton_steps += done.steps;
  kept.is_settled = done.converged;
  kept.solves = done.converged ? done.steps : std::max(done.steps, 2);
  if (!done.converged) return false;
  kept.residual = done.error;
  kept.solution = Solution::of_way;
  kept.work_done = workOfJoints(m_island, component, kept.work);
  const EndVelocities end =
      finishVelocities(m_island, component, m_options, kept.K, kept.work, m_end_memory);
  // From rest no load is known, and so not whether steps resolve how bodies swing about it.
  const bool in_halves = actsInHalves(m_island, component);
  if (in_halves &&
      (!end.differ || foreseeLoad(m_island, component, m_options.stable_swing, kept.work)))
    return false;
  kept.work_done += end.work;
  if (end.differ) {
    const bool is_even = kept.work_done <= end.of_arcs && -kept.work_done <= end.of_first &&
                         isEven(m_island, component, m_options.loose_pose_tolerance, kept.work);
    kept.solution = is_even ? Solution::even : Solution::at_end;
  }
  if (kept.solution != Solution::even)
    return excess(m_island, component, kept.work_done, m_options.ledger_share, kept.ledger) == 0;
  // In halves what joints give comes back by itself. From rest it is more than a share of what moves.
  return !in_halves || kept.ledger.excess(kept.work_done, m_options.ledger_share) <= end.of_arcs;
}

// With forces in halves, where that leads to an end.
bool IslandStep::solveInHalves(const Component& component) {
  HalfForces& forces = memoryOf(component).forces;
  if (!forces.areTouched() && mayActInHalves(m_island, component)) {
    forces.split(m_island, component);
    if (solveByChord(component)) return true;
  }
  forces.join(m_island, component);
  return false;
}

void IslandStep::solveAlone(const Component& component) {
  if (m_options.second_order && !m_has_others && solveInHalves(component)) return;
  if (solveByChord(component)) return;
  const Component* const alone = &component;
  solveInVelocity({{&alone, 1}, bodiesOf(component), {}});
}

// J: what all impulses gave to the velocities that forces lead to. Contacts may give what they aim at: rebounds, and ways out of each
// other.
double IslandStep::gainInVelocity(const ContactGroup& group) {
  double gain = 0, rebounds = 0, fastest = 0, mass = 0;
  m_counted.resize(m_island.bodies.size());
  for (const int i : group.bodies) m_counted[size_t(i)] = false;
  for (const Component* of : group.components) {
    gain += gainOverForces(m_island, *of, memoryOf(*of).work);
    std::fill_n(m_counted.begin() + of->first_body, of->bodies, true);
  }
  for (const int i : group.bodies) {
    const IslandBody& body = m_island.bodies[size_t(i)];
    mass += body.mass;
    if (!m_counted[size_t(i)]) gain += gainOf(body, body.v_free, m_velocities[size_t(i)]);
  }
  for (const ContactRow& row : group.rows) {
    rebounds += std::fmax(row.impulse * row.target, 0);
    fastest = std::fmax(fastest, std::abs(row.target));
  }
  return gain - std::fmin(rebounds, mass * fastest * fastest / 2);
}

// The second tier: one component alone, or what contacts join.
void IslandStep::solveInVelocity(const ContactGroup& group) {
  const auto& those = group.components;
  const auto& rows = group.rows;
  m_report.second_tier += int(those.size());
  m_report.tier = std::max(m_report.tier, 2);
  m_blocks.clear();
  double largest = 0;
  for (const Component* of : those) {
    ComponentMemory& kept = memoryOf(*of);
    m_blocks.push_back({of, &kept.K, &kept.work});
    largest += kept.ledger.largest();
  }
  for (const int i : group.bodies)
    if (!rows.empty())
      largest +=
          gainOf(m_island.bodies[size_t(i)], Vector6d::Zero(), m_island.bodies[size_t(i)].v_free);
  SolveReport done;
  const auto solve = [&](Sweep sweep) {
    const int most = rows.empty() && sweep == Sweep::one_by_one ? m_options.max_sweeps : m_sweeps;
    done = pintle::solveInVelocity(m_island, m_blocks, group.bodies, rows, m_options, sweep, most,
                                   m_velocities, m_pass_memory);
    m_report.newton_steps += done.steps * int(those.size());
    return done.is_solvable;
  };
  // Again, where bodies swing fast under another load than was predicted.
  const auto attempt = [&](Sweep sweep) {
    for (const Component* of : those) begin(*of);
    if (!solve(sweep)) return false;
    bool again = false;
    for (const Component* of : those)
      again = foreseeLoad(m_island, *of, m_options.stable_swing, memoryOf(*of).work) || again;
    if (again && m_options.max_factors > 1 && !solve(sweep)) return false;  // one is for poses
    return gainInVelocity(group) <= rounding_share * largest;
  };
  // Limits that many bodies meet at once, or whose rows become short, may give back more than they took (Kane 1984): then they give
  // back nothing.
  const auto attemptWithoutRebounds = [&] {
    bool any = false;
    for (const Component* of : those) any = stopRebounds(m_island, *of) || any;
    return any && attempt(Sweep::passes);
  };
  const bool is_sound = attempt(Sweep::passes) || attemptWithoutRebounds();
  if (!is_sound) {
    m_report.one_by_one += int(those.size());
    m_report.tier = 3;
    attempt(Sweep::one_by_one);
  }
  for (const Component* of : those) {
    ComponentMemory& kept = memoryOf(*of);
    kept.work.way = kept.work.v;
    kept.solution = is_sound ? Solution::in_velocity : Solution::one_by_one;
    kept.is_settled = done.converged;
    kept.solves = rows.empty() ? std::max(kept.solves, 1) : 1;
    kept.work.is_missed = false;
    kept.work_done = rows.empty() ? workOfJoints(m_island, *of, kept.work)
                                  : workAmongContacts(m_island, *of, kept.work);
  }
}

void IslandStep::finish(const Component& component, ComponentMemory& kept) {
  Workspace& work = kept.work;
  kept.arrives = true;
  if (!std::all_of(work.v.begin(), work.v.end(),
                   [](const Vector6d& v) { return isFinite(v.sum()); })) {
    kept.solution = Solution::overflows;  // leaveOverflows
    return;
  }
  kept.keepImpulses(m_island, component, m_groups.has(component), m_options.least_pivot);
  PoseChange* const changes = m_pose_changes.data() + component.first_body;
  bool moves = kept.solution <= Solution::at_end;  // beside velocities
  // What is left and what is open already are a tolerance together.
  if (!kept.holdsEnd() || isOpen(m_island, component, work, m_options.pose_tolerance / 2)) {
    const PosesReport done = projectPoses(m_island, component, m_options, work, kept.K,
                                          kept.hasFactor(), m_projection_memory);
    kept.residual = done.open;
    kept.arrives = done.arrives;
    if (done.moves) {
      moves = true;
      findChanges(m_island, component, work.way, work.moved, changes);
      kept.work_done +=
          workOfPoses(m_island, component, changes) + energyOfTurns(m_island, component, work);
    }
  }
  const double by_balance = balance(m_island, component, m_options, kept);
  kept.work_done += by_balance;
  if (by_balance != 0 && !m_groups.has(component))
    kept.followVelocities(m_island, component, m_options.least_pivot);
  if (moves || by_balance != 0) findChanges(m_island, component, work.v, work.moved, changes);
  kept.ledger.book(kept.work_done, m_options.ledger_share,
                   kineticEnergy(m_island, component, work.v));
  kept.keep(m_island, component);
  if (m_options.second_order) kept.forces.keep(m_island, component, kept.work.v.data());
  pintle::report(m_island, component, work);
}

void IslandStep::report(const Component& component, ComponentMemory& kept) {
  m_report.factorisations += kept.K.takeFactorisations();
  m_report.residual = std::max(m_report.residual, kept.residual);
  const bool overflows = kept.solution == Solution::overflows;
  m_report.overflowed += overflows;
  m_report.unsettled += !kept.is_settled;
  m_report.not_converged += overflows || !(kept.residual <= m_options.pose_tolerance);
  for (int c = 0; c < component.joints; ++c)
    m_report.open =
        std::max(m_report.open, m_island.joints[size_t(component.first_joint + c)].error);
  m_report.work += kept.work_done;
  m_report.ledger += kept.ledger.given;
  m_report.ledger_limit += kept.ledger.limit(m_options.ledger_share) + kept.ledger.rounding;
}

void IslandStep::beginComponents(WorldMemory& memory) {
  const size_t bodies = m_island.bodies.size(), components = m_components.size();
  size_t bounds = 0;  // parts of rows that contacts may take
  if (!m_contacts.empty())
    for (const IslandJoint& joint : m_island.joints)
      bounds += size_t(AxisLaw::max_parts * joint.bounded);
  m_pass_memory.reserve(components, bounds);
  reserve(components, m_blocks);
  reserve(bodies, m_counted, m_bodies_alone, m_velocities);
  m_groups.reserve(bodies, components);
  m_groups.find(m_components, bodies, m_contacts);
  m_kept.clear();
  for (const Component& component : m_components) {
    std::unique_ptr<ComponentMemory>& slot =
        memory.slot(m_island.joints[size_t(component.first_joint)].constraint);
    remember(m_island, component, slot);
    m_kept.push_back(slot.get());
    // For any way that a solve may take: hardly a step allocates because it is the first one that takes another.
    const auto of_it = size_t(component.bodies), rows = size_t(component.rows);
    m_chord_memory.reserve(of_it, slot->K.vectorSize());
    m_end_memory.reserve(rows, slot->K.vectorSize());
    m_projection_memory.reserve(of_it, rows, slot->K.vectorSize());
    slot->followTurns(m_island, component);
    if (m_options.second_order) {
      slot->forces.begin(m_island, component, [&](const btRigidBody& body) -> MotionsOfBody& {
        return memory.motionsOf(body);
      });
      if (m_has_others) slot->forces.join(m_island, component);
    }
    slot->stretchSprings(m_island, component);
    turnStops(m_island, component);
    slot->ledger.begin(m_island, component, m_options.ledger_share);
  }
}

void IslandStep::solveJoints() {
  m_velocities.clear();
  for (const IslandBody& body : m_island.bodies) m_velocities.push_back(body.v_free);
  m_pass_memory.response.begin(m_island.bodies.size());
  for (const Component& component : m_components)
    if (!m_groups.has(component)) solveAlone(component);
  for (size_t group = 0; group < m_groups.count(); ++group) solveInVelocity(m_groups[group]);
  for (const Component& component : m_components) gatherVelocities(component);
}

void IslandStep::gatherVelocities(const Component& component) {
  const std::vector<Vector6d>& v = memoryOf(component).work.v;
  std::copy(v.begin(), v.end(), m_velocities.begin() + component.first_body);
}

// A joint breaks at what it bears when all else is solved, and the step is then solved without it.
bool IslandStep::breakOverloaded() {
  bool any = false;
  for (const Component& component : m_components)
    any = pintle::breakOverloaded(m_island, component, memoryOf(component).work) || any;
  return any;
}

void IslandStep::holdJoints(std::vector<Vector6d>& velocities) {
  for (const Component& component : m_components) {
    ComponentMemory& kept = memoryOf(component);
    if (!m_groups.has(component) || !kept.hasFactor()) continue;
    Vector6d* const v = velocities.data() + component.first_body;
    if (std::all_of(v, v + component.bodies, [](const Vector6d& of) { return of.isZero(0); }))
      continue;
    kept.K.hold(v, kept.work.x);
  }
}

void IslandStep::finishComponents(const SolverBodies& bodies) {
  m_are_pushed = pushApart(
      m_island, m_contacts, m_velocities, m_sweeps, m_turn_share, m_pass_memory.response,
      [this](std::vector<Vector6d>& v) { holdJoints(v); }, m_poses_memory);
  for (const Component& component : m_components) {
    finish(component, memoryOf(component));
    gatherVelocities(component);
  }
  followPoses();
  leaveOverflows(bodies);
  for (const Component& component : m_components) report(component, memoryOf(component));
}

void IslandStep::leaveOverflows(const SolverBodies& bodies) {
  for (const Component& component : m_components) {
    const Component* const alone = &component;
    if (!m_groups.has(component)) leaveOverflow({{&alone, 1}, bodiesOf(component), {}}, bodies);
  }
  for (size_t group = 0; group < m_groups.count(); ++group) leaveOverflow(m_groups[group], bodies);
}

// Where impulses lead to numbers that Bullet cannot hold, none acts in this step, and nothing of it is kept for the next one.
void IslandStep::leaveOverflow(const ContactGroup& group, const SolverBodies& bodies) {
  const auto ofComponent = [&](const Component* of) {
    const ComponentMemory& kept = memoryOf(*of);
    return kept.solution == Solution::overflows || overflows(kept.work.lambda, m_island.dt);
  };
  const auto ofBody = [&](int i) {
    const IslandBody& of = m_island.bodies[size_t(i)];
    return overflows(of, bodies[of.solver_body], m_velocities[size_t(i)], m_pose_changes[size_t(i)],
                     m_island.dt);
  };
  const auto ofRow = [](const ContactRow& row) { return !isRepresentable(row.impulse); };
  if (std::none_of(group.components.begin(), group.components.end(), ofComponent) &&
      std::none_of(group.bodies.begin(), group.bodies.end(), ofBody) &&
      std::none_of(group.rows.begin(), group.rows.end(), ofRow))
    return;
  for (const Component* of : group.components)
    if (actsInHalves(m_island, *of)) memoryOf(*of).forces.join(m_island, *of);
  for (const int i : group.bodies) {
    m_velocities[size_t(i)] = m_island.bodies[size_t(i)].v_free;
    m_island.bodies[size_t(i)].push.setZero();
    m_pose_changes[size_t(i)].setZero();
  }
  for (ContactRow& row : group.rows) row.impulse = 0;
  for (const Component* of : group.components) {
    reportNothing(m_island, *of);
    memoryOf(*of).reset();
    memoryOf(*of).solution = Solution::overflows;
  }
}

Span<const int> IslandStep::bodiesOf(const Component& component) {
  m_bodies_alone.resize(size_t(component.bodies));
  std::iota(m_bodies_alone.begin(), m_bodies_alone.end(), component.first_body);
  return m_bodies_alone;
}

void IslandStep::followPoses() {
  const auto mayKeepVelocities = [&](const Component* of) {
    return memoryOf(*of).work.is_resolved && memoryOf(*of).arrives;
  };
  for (const Component& component : m_components)
    if (!memoryOf(component).arrives && !m_groups.has(component))
      pintle::followPoses(m_island, bodiesOf(component), m_velocities, m_pose_changes);
  for (size_t g = 0; g < m_groups.count(); ++g) {
    const ContactGroup group = m_groups[g];
    if (!std::all_of(group.components.begin(), group.components.end(), mayKeepVelocities))
      pintle::followPoses(m_island, group.bodies, m_velocities, m_pose_changes);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
