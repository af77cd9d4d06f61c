#include <pintle/solver/end_of_step.h>

#include <pintle/body_pair.h>
#include <pintle/joint_rows.h>
#include <pintle/joints/joint.h>
#include <pintle/joints/joint_passes.h>
#include <pintle/prefetch.h>
#include <pintle/solver_body.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// An error that this speed (m/s, rad/s) closes in one step is corrected whole: a step of motion makes errors of that
// size. A joint that starts further off closes by its ERP and its largest correction speed.
constexpr double free_correction_speed = 1;

// A limit that sends its coordinate further inside than this, m or rad, rebounds. A rebound is a velocity, with no
// position to hold.
constexpr Scalar min_rebound = Scalar(1e-6);

// Joints and bodies are scattered in memory, and of thousands none is still in the cache. Joints are prefetched this
// number of blocks ahead, then the bodies to which they point.
constexpr size_t prefetch_joints = 12, prefetch_bodies = 6;
constexpr size_t prefetch_joint_bytes = 384, prefetch_row_bytes = 384;  // enough for most joints

constexpr int max_stock_rows = 16;  // of a stock joint

// The bit of a row among those of a block.
constexpr unsigned char rowBit(int r) { return static_cast<unsigned char>(1u << r); }

double dot(const btSolverConstraint& a, const btSolverConstraint& b) {
  return double(a.m_contactNormal1.dot(b.m_contactNormal1) +
                a.m_relpos1CrossNormal.dot(b.m_relpos1CrossNormal) +
                a.m_contactNormal2.dot(b.m_contactNormal2) +
                a.m_relpos2CrossNormal.dot(b.m_relpos2CrossNormal));
}
double dot(const Row& a, const Row& b) {
  return double(a.L.dot(b.L) + a.A_a.dot(b.A_a) + a.A_b.dot(b.A_b));
}

bool isSameRow(const btSolverConstraint& a, const btSolverConstraint& b) {
  return isSameDirection(dot(a, a), dot(a, b), dot(b, b));
}

// Of the square of a.
template <class AnyRow>
double partAlong(const AnyRow& a, const AnyRow& b) {
  const double product = dot(a, b), square = dot(b, b);
  return square > 0 ? product * product / square : 0;
}

class PoseGuard {
 public:
  PoseGuard(btRigidBody& body, const btTransform& pose)
      : m_body(body), m_before(body.getWorldTransform()) {
    if (!body.isStaticOrKinematicObject()) body.setWorldTransform(pose);
  }
  ~PoseGuard() {
    if (!m_body.isStaticOrKinematicObject()) m_body.setWorldTransform(m_before);
  }
  PoseGuard(const PoseGuard&) = delete;
  PoseGuard& operator=(const PoseGuard&) = delete;

 private:
  btRigidBody& m_body;
  btTransform m_before;
};

}  // namespace

void EndOfStep::begin(size_t blocks, const btAlignedObjectArray<btSolverBody>& bodies) {
  m_far.assign(blocks, false);
  m_turned.assign(blocks, 0);
  Scalar furthest = 0;
  for (int i = 0; i < bodies.size(); ++i)
    if (!bodies[i].internalGetInvMass().isZero())
      furthest = btMax(furthest, bodies[i].m_worldTransform.getOrigin().length2());
  m_rounding = double(SIMD_EPSILON * btSqrt(furthest)) / 2;
}

void EndOfStep::predict(const btAlignedObjectArray<btSolverBody>& bodies,
                        const btContactSolverInfo& info) {
  m_dt = info.m_timeStep;
  m_erp = info.m_erp;
  m_poses.resize(size_t(bodies.size()));
  for (int i = 0; i < bodies.size(); ++i) {
    const btSolverBody& body = bodies[i];
    if (body.m_originalBody == nullptr || body.internalGetInvMass().isZero()) continue;
    const btTransform* start = &body.m_worldTransform;
    btTransform pushed;
    if (info.m_splitImpulse && !(body.m_pushVelocity.isZero() && body.m_turnVelocity.isZero())) {
      btTransformUtil::integrateTransform(*start, body.m_pushVelocity,
                                          body.m_turnVelocity * info.m_splitImpulseTurnErp, m_dt,
                                          pushed);
      start = &pushed;
    }
    endOfStep(*start, body, m_dt, m_poses[size_t(i)]);
  }
}

// J v of kinematic bodies: their pose is that of the end of the step already.
Scalar EndOfStep::ownersVelocity(const Joint& joint, const Row& row) {
  const btRigidBody &a = joint.getRigidBodyA(), &b = joint.getRigidBodyB();
  const auto owners = [](const btRigidBody& body, const btVector3& v) -> Vec3 {
    return body.isStaticOrKinematicObject() ? Vec3(view(v)) : Vec3::Zero();
  };
  return velocity(row, owners(b, b.getLinearVelocity()) - owners(a, a.getLinearVelocity()),
                  owners(a, a.getAngularVelocity()), owners(b, b.getAngularVelocity()));
}

int EndOfStep::equalities(const JointBlock& block) {
  return block.ours != nullptr ? block.ours->m_rows.equalities() : max_stock_rows;
}

// 0 for a limit that the step leaves: `end` has no row of it. 0 for the document's form, too: it does not predict, and
// a body that turns this far would pass the limit by far to be sent back to it.
Scalar EndOfStep::missing(const Joint& joint, int row, const Rows& end) const {
  const Row* const limit = joint.limitAt(row);
  if (limit == nullptr) return 0;
  const Row& start = *limit;
  const AxisState& state = joint.m_rows.axis(start.axis);
  if (!joint.isLimit(start) || !(joint.curvedPart() > 0) ||
      joint.getFormulation() == Formulation::document)
    return 0;
  const Scalar sign = state.sign;
  const Scalar velocity = sign * start.target + joint.m_curved_time * start.curvature;
  const Scalar goal = start.position + m_dt * velocity;
  if (state.axis->distance(goal) > min_rebound) return 0;
  for (int i = end.equalities(); i < end.size(); ++i)
    if (end[i].axis == start.axis && isSameRow(start, end[i]))
      return sign * (end[i].position - goal) / m_dt + ownersVelocity(joint, start);
  return 0;
}

// A row may differ from the start's row of the same number, and still lie in the span of all rows there: tangents of a
// plane, for instance, are chosen anew at each pose.
inline EndOfStep::Match EndOfStep::match(const Joint& joint, const Rows& end, int i) {
  const RowList& start = joint.m_rows;
  if (i >= start.equalities() || i >= end.equalities()) return Match::none;
  if (isSameRow(end[i], start[i])) return Match::same;
  if (end.equalities() != start.equalities()) return Match::none;
  double along = 0;
  for (int k = 0; k < start.equalities(); ++k) along += partAlong(end[i], start[k]);
  return 2 * along > dot(end[i], end[i]) ? Match::turned : Match::none;
}
EndOfStep::Match EndOfStep::match(const JointBlock& block, const btConstraintArray& rows, int r,
                                  const btSolverConstraint& end) {
  if (isSameRow(end, rows[block.row[r]])) return Match::same;
  double along = 0;
  for (int k = 0; k < block.rows; ++k)
    if (block.holds[k]) along += partAlong(end, rows[block.row[k]]);
  return 2 * along > dot(end, end) ? Match::turned : Match::none;
}

void EndOfStep::speeds(const JointBlock& block, const btConstraintArray& rows,
                       const btTransform& pose_a, const btTransform& pose_b, Speeds& speed,
                       Speeds& max_speed, unsigned char& turned) {
  turned = 0;
  btRigidBody &a = block.joint->getRigidBodyA(), &b = block.joint->getRigidBodyB();
  const Scalar fps = 1 / m_dt;
  for (int r = 0; r < block.rows; ++r) {
    speed[r] = 0;
    max_speed[r] = double(infinity);
  }
  if (block.ours != nullptr) {
    // A damped row leaves a velocity on purpose.
    if (block.ours->impulseSetting().damping != 1) return;
    const BodyPair pair(a, pose_a, b, pose_b);
    const StepMotion motion = block.ours->motion(pair);
    Rows now(m_memory, &motion);
    block.ours->addRows(pair, now);
    const int first_axis = equalities(block);
    for (int r = 0; r < block.rows; ++r) {
      const int i = block.index[r];
      if (i >= first_axis) {
        if (!(rows[block.row[r]].m_cfm > 0)) speed[r] = double(missing(*block.ours, i, now));
      } else if (block.holds[r]) {
        const Match as = match(*block.ours, now, i);
        if (as == Match::none) continue;
        speed[r] = double(fps) * double(now[i].position);
        max_speed[r] = double(now[i].max_speed);
        if (as == Match::turned) turned |= rowBit(r);
      }
    }
    return;
  }
  PoseGuard at_a(a, pose_a), at_b(b, pose_b);
  // A stock joint's speed is the difference of its rows with ERP 1 and with ERP 0.
  btSolverConstraint with[max_stock_rows], without[max_stock_rows];
  if (askRows(*block.joint, {fps, 1, 0, 1, 1}, with, max_stock_rows) != 1) return;
  askRows(*block.joint, {fps, 0, 0, 1, 1}, without, max_stock_rows);
  for (int r = 0; r < block.rows; ++r) {
    const int i = block.index[r];
    if (i >= max_stock_rows || !block.holds[r]) continue;
    const Match as = match(block, rows, r, with[i]);
    if (as == Match::none) continue;
    speed[r] = double(with[i].m_rhs) - double(without[i].m_rhs);
    if (as == Match::turned) turned |= rowBit(r);
  }
}

void EndOfStep::addEndRows(JointSystem& joints, const btConstraintArray& rows,
                           const btAlignedObjectArray<btSolverBody>& bodies) {
  joints.beginEndRows();
  const std::vector<JointBlock>& blocks = joints.blocks();
  for (size_t c = 0; c < blocks.size(); ++c) {
    const JointBlock& block = blocks[c];
    JointSystem::ScaledRows J;
    std::memcpy(J, block.J, sizeof(J));
    const auto inDouble = [](const auto& v) {
      return Vector3d(double(v[0]), double(v[1]), double(v[2]));
    };
    const auto set = [&](int r, const auto& L_a, const auto& A_a, const auto& L_b,
                         const auto& A_b) {
      Vector3d angular[] = {inDouble(A_a), inDouble(A_b)};
      for (int side = 0; side < 2; ++side)
        if (block.body[side] >= 0)
          angular[side] = byVelocity(bodies[block.body[side]], m_dt, angular[side]);
      joints.scaleRow(block, r, {inDouble(L_a), inDouble(L_b)}, angular, J);
    };
    endRows(block, rows, set);
    joints.addEndRows(c, J);
  }
}

// Calls `set` with each row that holds a position.
template <class Set>
void EndOfStep::endRows(const JointBlock& block, const btConstraintArray& rows, const Set& set) {
  btRigidBody &a = block.joint->getRigidBodyA(), &b = block.joint->getRigidBodyB();
  const btTransform &pose_a = pose(a, block.body[0]), &pose_b = pose(b, block.body[1]);
  if (block.ours != nullptr) {
    if (block.ours->impulseSetting().damping != 1) return;
    const BodyPair pair(a, pose_a, b, pose_b);
    const StepMotion motion = block.ours->motion(pair);
    Rows now(m_memory, &motion);
    block.ours->addRows(pair, now);
    for (int r = 0; r < block.rows; ++r) {
      const int i = block.index[r];
      if (block.holds[r] && match(*block.ours, now, i) != Match::none)
        set(r, now[i].L, now[i].A_a, Vec3(-now[i].L), Vec3(-now[i].A_b));
    }
    return;
  }
  PoseGuard at_a(a, pose_a), at_b(b, pose_b);
  btSolverConstraint now[max_stock_rows];
  if (askRows(*block.joint, {1 / m_dt, 1, 0, 1, 1}, now, max_stock_rows) != 1) return;
  for (int r = 0; r < block.rows; ++r) {
    const int i = block.index[r];
    if (i < max_stock_rows && block.holds[r] && match(block, rows, r, now[i]) != Match::none)
      set(r, now[i].m_contactNormal1, now[i].m_relpos1CrossNormal, now[i].m_contactNormal2,
          now[i].m_relpos2CrossNormal);
  }
}

void EndOfStep::errors(const JointSystem& joints, const btConstraintArray& rows,
                       std::vector<double>& error, std::vector<double>& largest) {
  const std::vector<JointBlock>& blocks = joints.blocks();
  error.assign(block_rows * blocks.size(), 0.);
  largest.assign(size_t(joints.topology().components), 0.);
  m_largest_turned = 0;
  for (size_t c = 0; c < blocks.size(); ++c) {
    if (c + prefetch_joints < blocks.size())
      prefetch(blocks[c + prefetch_joints].joint, prefetch_joint_bytes);
    if (c + prefetch_bodies < blocks.size()) {
      const btTypedConstraint& joint = *blocks[c + prefetch_bodies].joint;
      prefetch(&joint.getRigidBodyA().getLinearVelocity());
      prefetch(&joint.getRigidBodyB().getLinearVelocity());
      const Joint* ours = blocks[c + prefetch_bodies].ours;
      if (ours != nullptr) prefetch(&ours->m_rows[0], prefetch_row_bytes);
    }
    double* of = &error[block_rows * c];
    errors(blocks[c], rows, of, m_far[c], m_turned[c]);
    double& largest_here = largest[size_t(joints.topology().component[c])];
    for (int r = 0; r < blocks[c].rows; ++r) {
      double size = double(m_dt) * std::abs(of[r]);
      if ((m_turned[c] & rowBit(r)) != 0) m_largest_turned = std::max(m_largest_turned, size);
      if (size <= largest_here) continue;
      if (blocks[c].linear[r]) size -= m_rounding;
      if (!(size <= largest_here)) largest_here = size;  // also NaN
    }
  }
}

void EndOfStep::clearTurned(std::vector<double>& error) const {
  if (m_largest_turned == 0) return;
  for (size_t c = 0; c < m_turned.size(); ++c)
    for (int r = 0; r < block_rows; ++r)
      if ((m_turned[c] & rowBit(r)) != 0) error[block_rows * c + size_t(r)] = 0;
}

void EndOfStep::errors(const JointBlock& block, const btConstraintArray& rows, double* error,
                       char& far, unsigned char& turned) {
  const btRigidBody &a = block.joint->getRigidBodyA(), &b = block.joint->getRigidBodyB();
  const int first_axis = equalities(block);
  Speeds end, max_speed;
  speeds(block, rows, pose(a, block.body[0]), pose(b, block.body[1]), end, max_speed, turned);
  for (int r = 0; r < block.rows; ++r) {
    error[r] = end[r];
    far = far || (block.index[r] < first_axis &&
                  !(std::abs(error[r]) <= std::min(free_correction_speed, max_speed[r] / 2)));
  }
  if (!far) return;
  Speeds start;
  unsigned char turned_at_start;
  speeds(block, rows, a.getCenterOfMassTransform(), b.getCenterOfMassTransform(), start, max_speed,
         turned_at_start);
  // A row beyond its largest speed gives a direction, but no distance, and neither do the angular rows beside it. Their
  // own speeds are right.
  bool turns_back = false, leaves = false;
  for (int r = 0; r < block.rows; ++r) {
    if (block.index[r] >= first_axis) continue;
    const double whole = std::abs(start[r]);
    if (double(m_erp) * whole > max_speed[r]) {
      turns_back = true;
      continue;
    }
    const double speed =
        std::min(std::max(double(m_erp) * whole, free_correction_speed), max_speed[r]);
    if (!(whole > speed)) continue;
    error[r] -= start[r] * (1 - speed / whole);
    leaves = true;
  }
  if (!turns_back && !leaves) return;
  // A turned row does not tell how much of the error at the start may stay.
  for (int r = 0; r < block.rows; ++r)
    if ((turned & rowBit(r)) != 0 ||
        (turns_back && (max_speed[r] < double(infinity) || !block.linear[r])))
      error[r] = 0;
  turned = 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
