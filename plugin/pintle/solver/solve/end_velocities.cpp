#include <pintle/solver/solve/end_velocities.h>

#include <pintle/solver/cache/half_forces.h>
#include <pintle/solver/constants.h>
#include <pintle/solver/model/row_velocities.h>
#include <pintle/solver/model/stops.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A row that acts at a stop which it comes to in this step. Where it goes from there is known in the next one. (So it is at the tip of a cone.)
bool arrivesAtStop(const IslandRow& row, const LawPiece& piece, double tolerance, double dt) {
  if (!hasRigidStops(row.law)) return false;
  for (int i = 0; i < row.law.parts(); ++i) {
    const LawPart& part = row.law.part(i);
    if (part.isRigidStop() && !part.rebounds() && part.target == piece.target)
      return row.mayTurnStops() || std::abs(part.target) * dt > tolerance;
  }
  return false;
}

// Signorini's and Coulomb's laws and their like: the row may end with this impulse at the velocity at which it acts.
bool allows(const IslandRow& row, const LawPiece& piece, double impulse) {
  if (row.law.isEquality()) return true;
  const LawPiece to = row.law.meet(piece.target - row.K * impulse, row.K);
  return to.acts && to.target == piece.target;
}

// Where steps do not resolve how some bodies swing, or which way they turn against each other, their velocities belong to no pose.
bool areFollowed(const Island& island, const Workspace& work) {
  const double most = followed_turn * 2 * pi / island.dt;
  return work.is_resolved && std::all_of(work.way.begin(), work.way.end(), [&](const Vector6d& v) {
           return v.tail<3>().squaredNorm() <= most * most;
         });
}

// Rotation of rows while bodies go their way may exceed the tolerance (m or rad): it is d^2 of a body that moves by d (m and rad), by a lever.
bool mayBend(const Island& island, double tolerance, const Workspace& work) {
  double most2 = 0;
  for (const Vector6d& v : work.way) most2 = larger(most2, v.squaredNorm());
  return most2 * island.dt * island.dt > least_lever * tolerance || island.anyUnmovedMoves();
}

// Returns whether any of the rows that hold has bounds.
bool findRows(const Island& island, const Component& component, double tolerance, Workspace& work,
              EndMemory& memory) {
  std::vector<char>& holds_end = memory.holds;
  holds_end.resize(size_t(component.rows));
  bool any_bounded = false;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    const LawPiece& piece = work.pieces[r];
    const bool is =
        piece.acts && !(piece.softness > 0) && !arrivesAtStop(row, piece, tolerance, island.dt);
    holds_end[r] = is;
    any_bounded = any_bounded || (is && !row.law.isEquality());
  });
  differentiateAtEnd(island, component, work.moved, holds_end, memory.J);
  return any_bounded;
}

// Target of a row that holds, less the velocity of static and kinematic bodies.
double targetOf(const Island& island, const Component& component, int c, size_t r,
                const Workspace& work, const EndMemory& memory) {
  const double target = work.pieces[r].target;
  if (!island.anyUnmovedMoves()) return target;
  const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
  return target - island.velocityOfUnmoved(joint, memory.J[r]);
}

void turnInertia(const Island& island, const Component& component, JointMatrix& K,
                 const Workspace& work) {
  K.bodies().clear();
  for (int i = 0; i < component.bodies; ++i)
    K.bodies().push_back(InverseInertia::turned(island.bodies[size_t(component.first_body + i)],
                                                work.moved[size_t(i)].turn));
}

// In the units of the next step, of which this is the start.
void setRows(const Island& island, const Component& component, JointMatrix& K, Workspace& work,
             EndMemory& memory) {
  const std::vector<char>& holds_end = memory.holds;
  std::vector<double>&target = memory.target, &left = memory.lack_of_way;
  target.resize(size_t(component.rows));
  setZero(K.vectorSize(), left);
  forEachRow(island, component, [&](int c, int i, const IslandRow& row, size_t r) {
    Workspace::Scale& of = work.scales[r];
    of.root_K = K.setRowByItsK(c, i, memory.J[r], row.root_K);
    of.by_root_K = 1 / of.root_K;
    K.setActing(of.at, holds_end[r], work.softness[r]);
    if (!holds_end[r]) return;
    target[r] = targetOf(island, component, c, r, work, memory);
    left[of.at] = target[r] * of.by_root_K;
  });
  K.subtractVelocities(work.v.data(), left.data());
}

// Returns whether the laws of all rows allow their impulses. Others hold no longer.
bool solve(const Island& island, const Component& component, bool any_bounded, JointMatrix& K,
           const Workspace& work, EndMemory& memory) {
  std::vector<char>& holds_end = memory.holds;
  std::vector<double>&x = memory.impulses, &left = memory.lack_of_way;
  x = left;
  K.solve(x.data());
  bool all_allowed = true;
  if (!any_bounded) return all_allowed;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    const Workspace::Scale& of = work.scales[r];
    if (!holds_end[r] || allows(row, work.pieces[r], work.lambda[r] + x[of.at] * of.by_root_K))
      return;
    holds_end[r] = all_allowed = false;
    K.setActing(of.at, false, work.softness[r]);
    left[of.at] = 0;
  });
  return all_allowed;
}

// m or rad: the largest of velocities in the units of K, in a step.
double largest(const Island& island, const std::vector<double>& u, const Workspace& work) {
  double most = 0;
  for (const Workspace::Scale& of : work.scales) most = larger(most, of.root_K * u[of.at]);
  return most * island.dt;
}

// m or rad: what velocities of the end lack of their targets in a step. Those of rows that contradict each other do.
double missOfEnd(const Island& island, const JointMatrix& K, const Workspace& work,
                 EndMemory& memory) {
  std::vector<double>& missed = memory.lack_of_end;
  setZero(K.vectorSize(), missed);
  const std::vector<char>& holds_end = memory.holds;
  for (size_t r = 0; r < work.scales.size(); ++r)
    if (holds_end[r]) missed[work.scales[r].at] = memory.target[r] * work.scales[r].by_root_K;
  K.subtractVelocities(work.v.data(), missed.data());
  return largest(island, missed, work);
}

EndVelocities book(const Island& island, const Component& component, Workspace& work,
                   const EndMemory& memory) {
  EndVelocities end;
  end.differ = true;
  const std::vector<char>& holds_end = memory.holds;
  const std::vector<double>&x = memory.impulses, &left = memory.lack_of_way,
        &missed = memory.lack_of_end;
  forEachRow(island, component, [&](int, int, const IslandRow& row, size_t r) {
    if (!holds_end[r]) return;
    const Workspace::Scale& of = work.scales[r];
    const double y = x[of.at], miss = (left[of.at] + missed[of.at]) / 2;
    work.at_end[r] = y * of.by_root_K;
    work.lambda[r] += work.at_end[r];
    end.of_arcs += y * (left[of.at] - missed[of.at]) / 2;
    // Work of drives is no joint's. Each other impulse works by the mean of the velocities before and after it.
    if (!row.law.hasDrives()) end.work += y * (work.pieces[r].target * of.by_root_K - miss);
  });
  for (size_t i = 0; i < work.v.size(); ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body) + i];
    const Vector6d by_first = work.way[i] - body.v_free;
    end.of_first += body.product(by_first, by_first) / 2;
    if (body.acts_in_halves)
      end.work += (body.product(body.by_forces_at_end, body.v0 - work.way[i]) +
                   body.product(body.by_forces_at_end, body.by_forces_at_end)) /
                  2;
    else
      end.work += body.product(body.by_forces, work.v[i] - work.way[i]) / 2;
  }
  return end;
}

// Solves for impulses along the rows of the end. Returns whether there are any.
bool solve(const Island& island, const Component& component, const SolverOptions& options,
           bool any_bounded, JointMatrix& K, const Workspace& work, EndMemory& memory) {
  for (int factors = 0;; ++factors) {
    const double most = largest(island, memory.lack_of_way, work);
    if (!(most > end_margin * options.newton_tolerance) ||
        factors >= std::max(options.max_factors, 1) || !K.factorise(options.least_pivot))
      return false;
    if (solve(island, component, any_bounded, K, work, memory)) return true;
  }
}

}  // namespace

EndVelocities finishVelocities(const Island& island, const Component& component,
                               const SolverOptions& options, JointMatrix& K, Workspace& work,
                               EndMemory& memory) {
  work.way = work.v;
  const bool in_halves = actsInHalves(island, component);
  if (!areFollowed(island, work)) return {};
  if (!in_halves && !mayBend(island, options.newton_tolerance, work)) return {};
  const bool any_bounded = findRows(island, component, options.pose_tolerance, work, memory);
  turnInertia(island, component, K, work);
  if (in_halves)
    for (size_t i = 0; i < work.v.size(); ++i)
      work.v[i] = velocityAtEnd(island.bodies[size_t(component.first_body) + i], work.moved[i].turn,
                                work.way[i]);
  setRows(island, component, K, work, memory);
  const bool any = solve(island, component, options, any_bounded, K, work, memory);
  if (!any && !in_halves) return {};
  if (any)
    K.addResponse(memory.impulses.data(), work.v.data());
  else
    setZero(K.vectorSize(), memory.impulses);
  const double missed = missOfEnd(island, K, work, memory);
  if (missed <= (any ? options.loose_pose_tolerance : end_margin * options.newton_tolerance))
    return book(island, component, work, memory);
  work.v = work.way;
  return {};
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
