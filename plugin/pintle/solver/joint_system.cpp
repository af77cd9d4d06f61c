#include <pintle/solver/joint_system.h>

#include <pintle/body_pair.h>
#include <pintle/joint_rows.h>
#include <pintle/joints/joint.h>
#include <pintle/rows/block.h>
#include <pintle/solver_body.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A pivot below this part of its diagonal is rounding, and its row dependent: rounding of double, or the square of the
// difference of two equal rows that came in single precision.
constexpr double dependent_pivot = 1e-12;

// Softness of the rows of a loop, as a part of their diagonal: it keeps impulses small that no body would show.
// Rows that should be equal differ by some d where joints are open, or by 1e-6 in single precision. Their contradiction
// takes away d^2 / softness a step of a motion that the loop has, so the softness must be far above d^2; and it must be
// small enough for heavy loads on light links.
constexpr double min_norm_softness = 3e-8;
// Damping of corrections in a loop, as a part of the diagonal. Where rows are dependent but for d, a correction would
// make velocities of 1 / d of it. The damping bounds that factor by 1 / (2 sqrt(damping)) = 50.
constexpr double correction_damping = 1e-4;
// A joint with a pivot below this part of its diagonal is treated as a loop.
constexpr double nearly_dependent = 1e-6;
// A velocity below this part of the body's largest component is rounding.
constexpr double velocity_rounding = 1e-13;

// A row with bounds is iterated if its K is no more than this part of what the bodies could have: of all directions, or
// of K without the bodies' factors. The second is larger: a game in two dimensions only passes through such a row.
constexpr Scalar min_K_ratio = Scalar(1e-5), min_K_ratio_with_factors = Scalar(0.01);

Vector3d inDouble(const btVector3& v) { return {double(v[0]), double(v[1]), double(v[2])}; }

double changeOfVelocity(const btSolverConstraint& row,
                        const btAlignedObjectArray<btSolverBody>& bodies) {
  const btSolverBody &a = bodies[row.m_solverBodyIdA], &b = bodies[row.m_solverBodyIdB];
  return inDouble(row.m_contactNormal1).dot(inDouble(a.m_deltaLinearVelocity)) +
         inDouble(row.m_relpos1CrossNormal).dot(inDouble(a.m_deltaAngularVelocity)) +
         inDouble(row.m_contactNormal2).dot(inDouble(b.m_deltaLinearVelocity)) +
         inDouble(row.m_relpos2CrossNormal).dot(inDouble(b.m_deltaAngularVelocity));
}

// A bound of this size is none. Bullet's own infinity is larger: the largest number of its type.
constexpr Scalar no_bound = Scalar(BT_LARGE_FLOAT);

bool isBilateral(const btSolverConstraint& row) {
  return row.m_lowerLimit <= -no_bound && row.m_upperLimit >= no_bound;
}

// Whether the row is prepared for Bullet's iteration. Otherwise its m_rhs is its target velocity.
bool isPrepared(const btSolverConstraint& row) { return row.m_jacDiagABInv > 0; }

// J M^-1 J^T of a prepared row, as Bullet has it: without the bodies' factors.
double bulletK(const btSolverConstraint& row) { return 1 / double(row.m_jacDiagABInv); }

// Acts both ways, up to the breaking threshold at most. Bullet breaks a joint when a row's impulse is at that bound.
bool isEquality(const btSolverConstraint& row, const btTypedConstraint& joint) {
  const Scalar threshold = joint.getBreakingImpulseThreshold();
  return isBilateral(row) ||
         (threshold > 0 && row.m_lowerLimit == -threshold && row.m_upperLimit == threshold);
}
// Acts one way only, and asks for a speed that way.
bool isPushing(const btSolverConstraint& row, double speed) {
  return (row.m_lowerLimit >= 0 && speed > 0) || (row.m_upperLimit <= 0 && speed < 0);
}
// Has broken its joint in this step.
bool isPinned(const btSolverConstraint& row) {
  return row.m_lowerLimit == row.m_upperLimit && row.m_lowerLimit != 0;
}

// The change of J v that the row asks for before any impulse, when J v is -rest.
double rhs(const btSolverConstraint& row, double rest) {
  return isPrepared(row) ? double(row.m_rhs) * bulletK(row) : double(row.m_rhs) + rest;
}

bool hasLockedAxes(const btSolverBody& body) {
  const btVector3 one(1, 1, 1);
  return !body.internalGetInvMass().isZero() &&
         !(body.m_angularFactor == one && body.m_linearFactor == one);
}

// Whether K of a row is next to nothing of what the bodies could have, as about a needle: a limit held exactly there
// turns the needle about itself without bound. Or whether the bodies' factors, which Bullet's K leaves out, take away
// nearly all of it. K is computed here, as m_jacDiagABInv may be that of stiffened bodies.
bool isIllConditioned(const btSolverConstraint& row,
                      const btAlignedObjectArray<btSolverBody>& bodies) {
  Scalar K = 0, left = 0, all = 0;
  const auto add = [&](int id, const btVector3& L, const btVector3& A) {
    const btSolverBody& body = bodies[id];
    if (body.internalGetInvMass().isZero()) return;
    const Scalar inverse_mass = body.m_originalBody->getInvMass();
    const btMatrix3x3& I = body.m_originalBody->getInvInertiaTensorWorld();
    const btVector3 pushed = L * body.m_linearFactor, turned = A * body.m_angularFactor;
    K += inverse_mass * L.length2() + A.dot(I * A);
    left += inverse_mass * pushed.length2() + turned.dot(I * turned);
    all += inverse_mass * L.length2() + A.length2() * (I[0][0] + I[1][1] + I[2][2]);
  };
  add(row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal);
  add(row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal);
  return !(K > min_K_ratio * all) || !(left > min_K_ratio_with_factors * K);
}

// Warm start of stock joints' limits, as a part of the last impulse. A stock limit has no row in a step that begins
// inside it, so all of the impulse would close the limit, and the next step would let go.
constexpr Scalar stock_warm_start = Scalar(0.995);

// A row does not stay at its bound if that leaves more than this error, m or rad.
constexpr double max_bound_error = 5e-5;

// The value for Topology::at_bound.
Scalar atBound(const btSolverConstraint& row, Scalar impulse) {
  if (impulse > row.m_lowerLimit && impulse < row.m_upperLimit) return Topology::inside;
  return btMax(row.m_lowerLimit, btMin(impulse, row.m_upperLimit));
}

// (omega h)^2 of a body's swing under its load. Up to `stiff_swing` an explicit step resolves it. Beyond
// `unresolved_swing` an explicit step is unstable, and a turning load would feed the swing: a part of the body's turn
// against its neighbours, up to half, is then taken away in each step. A free component is stiffened from a higher
// threshold on, as changing stiffness would feed its spin.
constexpr double stiff_swing = 1, stiff_swing_if_free = 2.5, unresolved_swing = 4;

// The joints are solved again if 1 + mu of a body changes by more than this factor.
constexpr double stiffness_ratio = 1.5;

// Adds J J^T of a joint's rows for one body to the diagonal block of K, by two columns from the diagonal down. Linear
// parts are often zero, of angular rows and of rows along the world's axes.
template <int height, int first>
void addSquare(double* to, const double (&J)[6][block_rows], int end) {
  using Part = Column<height - first>;
  for (int q = first; q < end; ++q) {
    Eigen::Map<Part> column(to + q * height + first);
    Part sum = column;
    for (int k = 0; k < 6; ++k)
      if (k >= 3 || J[k][q] != 0) sum += J[k][q] * Eigen::Map<const Part>(J[k] + first);
    column = sum;
  }
}
void addSquare(double* to, const double (&J)[6][block_rows], int rows) {
  withHeight(rows, [&](auto height) {
    addSquare<height, 0>(to, J, std::min(rows, 2));
    addSquare<height, 2>(to, J, std::min(rows, 4));
    if constexpr (height > 4) addSquare<height, 4>(to, J, rows);
  });
}

// Adds A J^T of two joints' rows for one body to their block of K.
void addProduct(double* to, const double (&A)[6][block_rows], const double (&J)[6][block_rows],
                int rows, int columns) {
  withHeight(rows, [&](auto height) {
    for (int q = 0; q < columns; ++q) {
      Column<height> sum = column<height>(to, q);
      for (int k = 0; k < 6; ++k)
        if (k >= 3 || J[k][q] != 0) sum += J[k][q] * column<height>(A[k]);
      column<height>(to, q) = sum;
    }
  });
}

}  // namespace

Joint* AsJoint::operator()(btTypedConstraint* constraint) {
  if (m_last == nullptr || *m_last != typeid(*constraint)) {
    m_last = &typeid(*constraint);
    m_is_joint = dynamic_cast<Joint*>(constraint) != nullptr;
  }
  return m_is_joint ? static_cast<Joint*>(constraint) : nullptr;
}

bool JointSystem::gather(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
                         bool limits, int iterations) {
  m_gathered.clear();
  m_iterated_rows.clear();
  m_joints.clear();
  m_all = true;
  m_loops = m_loaded = m_bounded = m_has_locked_axes = false;
  m_max_correction_speed = m_spin2 = 0;
  if (rows.size() == 0) return false;
  m_bodies.resize(size_t(bodies.size()));
  for (int i = 0; i < bodies.size(); ++i) {
    Body& body = m_bodies[size_t(i)];
    body.load = body.known_load = 0;
    body.moves = !bodies[i].internalGetInvMass().isZero();
    body.has_locked_axes = hasLockedAxes(bodies[i]);
    body.v = inDouble(bodies[i].m_linearVelocity + bodies[i].m_externalForceImpulse);
    body.w = inDouble(bodies[i].m_angularVelocity + bodies[i].m_externalTorqueImpulse);
    if (!body.moves) continue;
    scale(body, bodies[i]);
    m_spin2 = std::max(m_spin2, body.w.squaredNorm());
  }
  const auto moving = [this](int body) { return m_bodies[size_t(body)].moves ? body : -1; };
  const btTypedConstraint* last = nullptr;
  AsJoint as_joint;
  size_t with_bounds = 0;
  int index = 0;
  for (int i = 0; i < rows.size(); ++i, ++index) {
    btSolverConstraint& row = rows[i];
    auto* joint = static_cast<btTypedConstraint*>(row.m_originalContactPoint);
    if (joint != last) {
      index = 0;
      // Most joints are bilateral as a whole.
      if (const int count = gatherBilateral(rows, i, as_joint); count > 0) {
        i += count - 1;
        continue;
      }
    }
    last = joint;
    const Body &a = m_bodies[size_t(row.m_solverBodyIdA)],
               &b = m_bodies[size_t(row.m_solverBodyIdB)];
    const bool bilateral = isBilateral(row);
    if (!a.moves && !b.moves) {
      row.m_overrideNumSolverIterations = 0;
      continue;
    }
    if (!bilateral) ++with_bounds;
    m_has_locked_axes = m_has_locked_axes || a.has_locked_axes || b.has_locked_axes;
    const bool known = !m_joints.empty() && m_gathered.back().joint == joint;
    const bool full = known && (m_gathered.back().rows == Topology::joint_rows ||
                                (bilateral && m_gathered.back().bilateral == block_rows));
    const auto fits = [&] {
      if (full) return false;
      if (isPinned(row) || isEquality(row, *joint)) return true;
      return (limits || (row.m_lowerLimit < 0 && row.m_upperLimit > 0)) &&
             row.m_lowerLimit < row.m_upperLimit && !isIllConditioned(row, bodies);
    };
    if (!bilateral && !fits()) {
      if (!leaveToBullet(bodies, row)) continue;
      m_all = false;
      m_iterated_rows.push_back({i, index});
      continue;
    }
    if (!known || full) {
      m_gathered.push_back({joint, as_joint(joint), 0, 0, {}, {}, {}});
      m_joints.push_back({{moving(row.m_solverBodyIdA), moving(row.m_solverBodyIdB)}});
    }
    Gathered& to = m_gathered.back();
    to.row[to.rows] = i;
    to.index[to.rows] = index;
    to.bound[to.rows] = bilateral ? -1 : to.rows;
    ++to.rows;
    if (bilateral) ++to.bilateral;
  }
  if (m_joints.empty()) return false;

  m_topology = &m_topologies.get(m_joints, m_gathered.front().joint);
  for (const IteratedRow& iterated : m_iterated_rows) {
    warmStart(rows[iterated.row], iterated.index, as_joint);
    m_loaded = m_loaded || rows[iterated.row].m_appliedImpulse != 0;
  }
  const Elimination& elimination = m_topology->elimination;
  const size_t n = m_joints.size();
  m_swings.clear();
  m_touched.clear();
  m_blocks.resize(n);
  m_rows.resize(n);
  for (size_t c = 0; c < n; ++c) {
    const int node = elimination.node(int(c));
    const Gathered& from = m_gathered[size_t(node)];
    const Topology::Joint& joint = m_joints[size_t(node)];
    JointBlock& block = m_blocks[c];
    std::memset(static_cast<void*>(&block), 0, sizeof(block));
    block.joint = from.joint;
    block.ours = from.ours;
    for (int side = 0; side < 2; ++side) block.body[side] = joint.body[side];
    int places = block_rows - from.bilateral;
    if (from.bilateral == from.rows) {
      block.rows = from.rows;
      for (int r = 0; r < from.rows; ++r) {
        btSolverConstraint& row = rows[from.row[r]];
        row.m_overrideNumSolverIterations = 0;
        block.row[r] = from.row[r];
        block.index[r] = from.index[r];
        block.bound[r] = -1;
        block.equality[r] = true;
        block.linear[r] = !row.m_contactNormal1.isZero();
      }
    }
    for (int i = block.rows; i < from.rows; ++i) {
      btSolverConstraint& row = rows[from.row[i]];
      const bool bounded = from.bound[i] >= 0;
      Scalar& before = m_topology->at_bound[Topology::joint_rows * c + size_t(i)];
      if (bounded && before == Topology::inside && places-- <= 0) before = 0;
      if (bounded && before != Topology::inside) {
        if (!leaveToBullet(bodies, row)) continue;
        m_all = false;
        if (row.m_overrideNumSolverIterations == 0) row.m_overrideNumSolverIterations = iterations;
        row.m_appliedImpulse = btMax(row.m_lowerLimit, btMin(before, row.m_upperLimit));
        m_loaded = m_loaded || row.m_appliedImpulse != 0;
        continue;
      }
      row.m_overrideNumSolverIterations = 0;
      m_bounded = m_bounded || bounded;
      const int r = block.rows++;
      block.row[r] = from.row[i];
      block.index[r] = from.index[i];
      block.bound[r] = from.bound[i];
      block.equality[r] = isEquality(row, *from.joint);
      block.linear[r] = !row.m_contactNormal1.isZero();
    }
    setRows(block, rows);
    m_rows[c] = block.rows;
    findPoint(block, rows);
    recallPointImpulse(block, c);
  }
  m_u.assign(6 * m_bodies.size(), 0);
  m_x.resize(block_rows * n);
  m_saved_u.reserve(m_u.size());
  m_max_correction_speeds.reserve(size_t(m_topology->components));
  m_saved_rows.reserve(2 * m_x.size());
  m_first_of.reserve(m_bodies.size());
  m_next_of.reserve(2 * n);
  m_path.reserve(n);
  m_over_relaxed.reserve(with_bounds);
  m_iterated_rows.reserve(with_bounds);
  m_topology->iterated.reserve(with_bounds);
  return true;
}

// Gathers all rows of the joint that begins at `first`, if they are bilateral, fit a block and move a body. Returns
// their number, or 0.
int JointSystem::gatherBilateral(const btConstraintArray& rows, int first, AsJoint& as_joint) {
  const btSolverConstraint& row = rows[first];
  const int max_count = std::min(rows.size() - first, block_rows + 1);
  int count = 0;
  while (count < max_count &&
         rows[first + count].m_originalContactPoint == row.m_originalContactPoint) {
    if (!isBilateral(rows[first + count])) return 0;
    ++count;
  }
  const Body &a = m_bodies[size_t(row.m_solverBodyIdA)], &b = m_bodies[size_t(row.m_solverBodyIdB)];
  if (count > block_rows || !(a.moves || b.moves)) return 0;
  m_has_locked_axes = m_has_locked_axes || a.has_locked_axes || b.has_locked_axes;
  auto* joint = static_cast<btTypedConstraint*>(row.m_originalContactPoint);
  m_gathered.push_back({joint, as_joint(joint), count, count, {}, {}, {}});
  for (int i = 0; i < count; ++i) {
    m_gathered.back().row[i] = first + i;
    m_gathered.back().index[i] = i;
    m_gathered.back().bound[i] = -1;
  }
  m_joints.push_back({{a.moves ? row.m_solverBodyIdA : -1, b.moves ? row.m_solverBodyIdB : -1}});
  return count;
}

// A joint of Pintle's keeps its limits' impulses itself. A stock joint may have another limit in this row now.
void JointSystem::warmStart(btSolverConstraint& row, int index, AsJoint& as_joint) const {
  if (row.m_appliedImpulse != 0) return;
  auto* joint = static_cast<btTypedConstraint*>(row.m_originalContactPoint);
  if (const Joint* ours = as_joint(joint)) {
    row.m_appliedImpulse = ours->warmLimit(index, 1);
    return;
  }
  const std::vector<Topology::Iterated>& all = m_topology->iterated;
  const Topology::Iterated sought{joint, index, 0, {}, {}};
  const auto known = std::lower_bound(all.begin(), all.end(), sought);
  if (known == all.end() || sought < *known) return;
  const auto dot = [](const btVector3& l, const btVector3& a, const btVector3& m,
                      const btVector3& b) { return double(l.dot(m) + a.dot(b)); };
  const btVector3 &L = row.m_contactNormal1, &A = row.m_relpos1CrossNormal;
  if (isSameDirection(dot(L, A, L, A), dot(L, A, known->linear, known->angular),
                      dot(known->linear, known->angular, known->linear, known->angular)))
    row.m_appliedImpulse = btMax(row.m_lowerLimit, btMin(known->impulse, row.m_upperLimit));
}

void JointSystem::rememberIteratedImpulses(const btConstraintArray& rows) {
  std::vector<Topology::Iterated>& known = m_topology->iterated;
  known.clear();
  AsJoint as_joint;
  for (const IteratedRow& iterated : m_iterated_rows) {
    const btSolverConstraint& row = rows[iterated.row];
    auto* joint = static_cast<btTypedConstraint*>(row.m_originalContactPoint);
    if (row.m_appliedImpulse != 0 && as_joint(joint) == nullptr)
      known.push_back({joint, iterated.index, stock_warm_start * row.m_appliedImpulse,
                       row.m_contactNormal1, row.m_relpos1CrossNormal});
  }
  std::sort(known.begin(), known.end());
}

// S is the Cholesky factor of the inverse inertia. A locked axis has a zero column.
void JointSystem::scale(Body& body, const btSolverBody& of) const {
  const btVector3 &mass = of.internalGetInvMass(), &f = of.m_angularFactor;
  const btMatrix3x3& I = of.m_originalBody->getInvInertiaTensorWorld();
  for (int i = 0; i < 3; ++i) {
    const double inverse = double(mass[i]) * double(of.m_linearFactor[i]);
    const bool as_before =
        i > 0 && mass[i] == mass[i - 1] && of.m_linearFactor[i] == of.m_linearFactor[i - 1];
    body.linear[i] = as_before ? body.linear[i - 1] : std::sqrt(inverse);
  }
  const auto A = [&](int i, int k) { return double(f[i]) * double(I[i][k]) * double(f[k]); };
  const auto reciprocalRoot = [](double pivot) { return pivot > 0 ? 1 / std::sqrt(pivot) : 0; };
  const double p0 = A(0, 0), r0 = reciprocalRoot(p0), l1 = A(1, 0) * r0, l2 = A(2, 0) * r0;
  const double p1 = A(1, 1) - l1 * l1, r1 = reciprocalRoot(p1), m2 = (A(2, 1) - l2 * l1) * r1;
  const double p2 = A(2, 2) - l2 * l2 - m2 * m2, r2 = reciprocalRoot(p2);
  body.angular << p0 * r0, 0, 0, l1, p1 * r1, 0, l2, m2, p2 * r2;
  const double i1 = -l1 * r0 * r1;
  body.inverse << r0, 0, 0, i1, r1, 0, -(l2 * r0 + m2 * i1) * r2, -m2 * r1 * r2, r2;
}

// A row's J S of one body.
void JointSystem::scaleRow(const Body& body, const Vector3d& L, const Vector3d& A, double (&j)[6]) {
  const Vector3d w = body.angular.transpose() * A;
  for (int k = 0; k < 3; ++k) {
    j[k] = L[k] * body.linear[k];
    j[3 + k] = w[k];
  }
}

// Returns false for a row without effect: nobody can move along it, or it holds NaN.
bool JointSystem::leaveToBullet(const btAlignedObjectArray<btSolverBody>& bodies,
                                btSolverConstraint& row) {
  if (!isPrepared(row))
    prepareToIterate(row, *static_cast<btTypedConstraint*>(row.m_originalContactPoint),
                     bodies[row.m_solverBodyIdA], bodies[row.m_solverBodyIdB]);
  const bool acts = isPrepared(row) && BodyPair::is_finite(row.m_rhs);
  if (!acts) row.m_overrideNumSolverIterations = 0;
  return acts;
}

// Sets J S, rest, rhs and softness. All rows of a joint have the same bodies.
void JointSystem::setRows(JointBlock& block, btConstraintArray& rows) {
  if (block.rows == 0) return;
  for (int r = 0; r < block.rows; ++r) {
    const btSolverConstraint& row = rows[block.row[r]];
    const auto set = [r](double(&J)[6][block_rows], const btVector3& L, const btVector3& A) {
      for (int k = 0; k < 3; ++k) {
        J[k][r] = double(L[k]);
        J[3 + k][r] = double(A[k]);
      }
    };
    set(block.J[0], row.m_contactNormal1, row.m_relpos1CrossNormal);
    set(block.J[1], row.m_contactNormal2, row.m_relpos2CrossNormal);
  }
  const int id[] = {rows[block.row[0]].m_solverBodyIdA, rows[block.row[0]].m_solverBodyIdB};
  BlockColumn rest = BlockColumn::Zero(), K = BlockColumn::Zero();
  for (int side = 0; side < 2; ++side) {
    const Body& body = m_bodies[size_t(id[side])];
    double(&J)[6][block_rows] = block.J[side];
    const BlockColumn A[] = {column(J[3]), column(J[4]), column(J[5])};
    BlockColumn velocity = BlockColumn::Zero();
    for (int k = 0; k < 3; ++k) velocity += body.v[k] * column(J[k]) + body.w[k] * A[k];
    rest -= velocity;
    if (block.body[side] < 0) {
      block.is_carried = block.is_carried || !velocity.isZero(0);
      std::memset(J, 0, sizeof(J));
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      column(J[k]) *= body.linear[k];
      // S is lower triangular while the body is not stiffened.
      BlockColumn turned = body.angular(k, k) * A[k];
      for (int i = k + 1; i < 3; ++i) turned += body.angular(i, k) * A[i];
      column(J[3 + k]) = turned;
    }
    for (int k = 0; k < 6; ++k) K += column(J[k]).cwiseProduct(column(J[k]));
  }
  const bool has_locked_axes =
      m_bodies[size_t(id[0])].has_locked_axes || m_bodies[size_t(id[1])].has_locked_axes;
  column(block.rest) = rest;
  for (int r = 0; r < block.rows; ++r) {
    btSolverConstraint& row = rows[block.row[r]];
    const double whole = isPrepared(row)   ? bulletK(row)
                         : has_locked_axes ? 1 / double(inverseK(row, *block.joint))
                                           : K[r];
    block.rhs[r] = rhs(row, rest[r]);
    if (!(whole > double(SIMD_EPSILON)) || !BodyPair::is_finite(Scalar(whole + block.rhs[r]))) {
      clearRow(block, r);
      continue;
    }
    const bool equality = block.equality[r];
    const bool corrected = equality || isPushing(row, block.rhs[r] - block.rest[r]);
    if (!corrected) block.rest[r] = block.rhs[r];
    block.softness[r] = double(row.m_cfm) * whole;
    block.damping[r] = corrected ? correction_damping * whole : 0;
    block.holds[r] = equality && !(row.m_cfm > 0);
    m_max_correction_speed =
        std::max(m_max_correction_speed, std::abs(block.rhs[r] - block.rest[r]));
  }
}

// For a row along which nobody can move, or that holds NaN.
void JointSystem::clearRow(JointBlock& block, int r) {
  for (auto& J : block.J)
    for (auto& of_coordinate : J) of_coordinate[r] = 0;
  block.rest[r] = block.rhs[r] = 0;
  block.equality[r] = false;
}

void JointSystem::factorise() {
  const Elimination& elimination = m_topology->elimination;
  m_factor.resize(elimination, m_rows);
  const int columns = elimination.columns();
  for (int c = 0; c < columns; ++c) {
    const JointBlock& block = m_blocks[size_t(c)];
    double* K = m_factor.block(c);
    m_factor.clear(c);
    for (int side = 0; side < 2; ++side)
      if (block.body[side] >= 0) addSquare(K, block.J[side], block.rows);
    for (int r = 0; r < block.rows; ++r)
      K[r * (column_height(block.rows) + 1)] += block.softness[r];
    for (int i = elimination.first(c); i < elimination.first(c + 1); ++i) {
      const JointBlock& other = m_blocks[size_t(elimination.row(i))];
      double* to = m_factor.block(i);
      m_factor.clear(i);
      for (int s = 0; s < 2; ++s) {
        for (int t = 0; t < 2; ++t) {
          if (block.body[s] >= 0 && block.body[s] == other.body[t])
            addProduct(to, other.J[t], block.J[s], other.rows, block.rows);
        }
      }
    }
  }
  if (!loops() && (m_topology->loops || m_has_locked_axes || dependsOnItself())) {
    m_loops = true;
    addMinNormSoftness();
  }
  if (loops()) {
    m_damped = m_factor;
    for (int c = 0; c < columns; ++c) {
      const JointBlock& block = m_blocks[size_t(c)];
      double* K = m_damped.block(c);
      for (int r = 0; r < block.rows; ++r)
        K[r * (column_height(block.rows) + 1)] += block.damping[r];
    }
    m_damped_is_factor = false;
  }
  m_factor.factorise(dependent_pivot);
  m_end_factor.reserve(m_factor);
}

// It becomes the rows' own softness, so that every later solve agrees.
void JointSystem::addMinNormSoftness() {
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    JointBlock& block = m_blocks[c];
    double* K = m_factor.block(int(c));
    for (int r = 0; r < block.rows; ++r) {
      double& diagonal = K[r * (column_height(block.rows) + 1)];
      const double softness =
          min_norm_softness * std::max(diagonal, block.damping[r] / correction_damping);
      diagonal += softness;
      block.softness[r] += softness;
    }
  }
}

void JointSystem::findPoint(JointBlock& block, const btConstraintArray& rows) {
  for (int i = 0; i < block.rows; ++i) {
    if (!block.equality[i]) continue;
    if (!block.linear[i]) {
      ++block.angular_rows;
    } else {
      if (block.linear_rows < 3) block.point[block.linear_rows] = i;
      ++block.linear_rows;
    }
  }
  if (block.linear_rows < 3) {
    block.point[0] = -1;
    return;
  }
  // The sum of L x (r x L) of three directions is 2 r.
  Vector3d twice[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double swing[2] = {0, 0};
  for (int k = 0; k < 3; ++k) {
    const int i = block.point[k];
    const btSolverConstraint& row = rows[block.row[i]];
    const Vector3d L[2] = {inDouble(row.m_contactNormal1), inDouble(row.m_contactNormal2)};
    Eigen::Map<Vector3d>(block.direction[k]) = L[0];
    twice[0] += L[0].cross(inDouble(row.m_relpos1CrossNormal));
    twice[1] += L[1].cross(inDouble(row.m_relpos2CrossNormal));
    for (int side = 0; side < 2; ++side)
      for (int j = 3; j < 6; ++j) swing[side] += block.J[side][j][i] * block.J[side][j][i];
  }
  for (int side = 0; side < 2; ++side) {
    const Vector3d r = twice[side] / 2;
    Eigen::Map<Vector3d>(block.lever[side]) = r;
    const double length = r.norm();
    block.swing[side] = length > 0 ? swing[side] / length : 0;
  }
}

Vector3d JointBlock::pointImpulse() const {
  Vector3d p = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) p += impulse[point[k]] * Eigen::Map<const Vector3d>(direction[k]);
  return p;
}

void JointSystem::addLoads(double dt) {
  for (Body& body : m_bodies) body.load = 0;
  for (const JointBlock& block : m_blocks) {
    if (block.point[0] < 0) continue;
    double p = 0;
    for (const int i : block.point) p += block.impulse[i] * block.impulse[i];
    p = dt * std::sqrt(p);
    for (int side = 0; side < 2; ++side)
      if (block.body[side] >= 0) m_bodies[size_t(block.body[side])].load += p * block.swing[side];
  }
}

bool JointSystem::isStiff(double swing, size_t body) const {
  return swing > stiff_swing_if_free ||
         (swing > stiff_swing && m_topology->grounded[size_t(m_topology->body_component[body])]);
}

// Whether a body's load has changed enough to find its stiffness again.
bool JointSystem::loadsChanged() const {
  for (size_t i = 0; i < m_bodies.size(); ++i) {
    const Body& body = m_bodies[i];
    if (body.known_load == 0) {
      if (isStiff(body.load, i)) return true;
      continue;
    }
    const double ratio = (1 + body.load) / (1 + body.known_load);
    if (ratio > stiffness_ratio || ratio * stiffness_ratio < 1) return true;
  }
  return false;
}

void JointSystem::addLevers() {
  for (Swing& swing : m_swings) swing.stiffness.setZero();
  for (const JointBlock& block : m_blocks) {
    if (block.point[0] < 0) continue;
    const Vector3d p = block.pointImpulse();
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0) continue;
      const auto body = size_t(block.body[side]);
      if (!isStiff(m_bodies[body].load, body)) continue;
      const Eigen::Map<const Vector3d> r(block.lever[side]);
      m_swings[body].stiffness += leverStiffness(side == 0 ? p : -p, r);
    }
  }
}

void JointSystem::addNeighbours() {
  for (Swing& swing : m_swings) {
    swing.omega.setZero();
    swing.neighbours = 0;
  }
  for (const JointBlock& block : m_blocks) {
    if (block.body[0] < 0 || block.body[1] < 0) continue;
    for (int side = 0; side < 2; ++side) {
      Swing& swing = m_swings[size_t(block.body[side])];
      swing.omega += m_bodies[size_t(block.body[1 - side])].w;
      ++swing.neighbours;
    }
  }
}

// Whether rows of one joint depend on each other. Only a joint that holds an orientation, or two points, can.
bool JointSystem::dependsOnItself() {
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const JointBlock& block = m_blocks[c];
    if (block.angular_rows < 3 && block.linear_rows <= 3) continue;
    double K[block_rows * block_rows];
    std::copy(m_factor.block(int(c)), m_factor.block(int(c) + 1), K);
    const bool depends = withHeight(block.rows, [&](auto height) {
      for (int p = 0; p < block.rows; ++p) {
        const double pivot = K[p * (height + 1)];
        const double whole = m_factor.block(int(c))[p * (height + 1)];
        if (!(pivot > nearly_dependent * whole)) return true;
        for (int q = p + 1; q < block.rows; ++q)
          column<height>(K, q) -= K[p * height + q] / pivot * column<height>(K, p);
      }
      return false;
    });
    if (depends) return true;
  }
  return false;
}

void JointSystem::beginSwings() {
  if (!m_swings.empty()) return;
  m_swings.resize(m_bodies.size());
  for (size_t i = 0; i < m_bodies.size(); ++i) {
    m_swings[i].angular = m_bodies[i].angular;
    m_swings[i].inverse = m_bodies[i].inverse;
  }
}

bool JointSystem::stiffen(Scalar dt) {
  addLoads(double(dt));
  if (!loadsChanged()) return false;
  beginSwings();
  addLevers();
  bool changed = false;
  for (size_t i = 0; i < m_bodies.size(); ++i) {
    Body& body = m_bodies[i];
    Swing& swing = m_swings[i];
    Stiffening& next = swing.next_stiffening;
    next = Stiffening();
    body.known_load = body.load;
    if (isStiff(body.load, i)) {
      next = Stiffening(double(dt) * swing.angular.transpose() * swing.stiffness * swing.angular);
      if (!isStiff(next.max(), i)) next = Stiffening();
    }
    const double ratio = (1 + next.max()) / (1 + swing.stiffening.max());
    changed = changed || ratio > stiffness_ratio || ratio * stiffness_ratio < 1;
  }
  if (!changed) return false;
  changeInertia();
  return true;
}

bool JointSystem::hasUnresolved() const {
  return std::any_of(m_swings.begin(), m_swings.end(),
                     [](const Swing& swing) { return swing.stiffening.max() > unresolved_swing; });
}

// Applies the next stiffening of each body.
void JointSystem::changeInertia() {
  for (size_t i = 0; i < m_swings.size(); ++i) {
    Swing& swing = m_swings[i];
    swing.turns = swing.stiffening.any() || swing.next_stiffening.any();
    if (!swing.turns) continue;
    const Matrix3d root = swing.next_stiffening.root();
    swing.turn = swing.stiffening.any() ? Matrix3d(swing.stiffening.inverseRoot() * root) : root;
    swing.stiffening = swing.next_stiffening;
    m_bodies[i].angular = swing.angular * root;
    m_bodies[i].inverse = swing.stiffening.inverseRoot() * swing.inverse;
  }
  for (JointBlock& block : m_blocks) {
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0 || !m_swings[size_t(block.body[side])].turns) continue;
      const Matrix3d& turn = m_swings[size_t(block.body[side])].turn;
      const auto J = &block.J[side][3];
      const BlockColumn before[] = {column(J[0]), column(J[1]), column(J[2])};
      for (int k = 0; k < 3; ++k)
        column(J[k]) = turn(0, k) * before[0] + turn(1, k) * before[1] + turn(2, k) * before[2];
    }
  }
  addNeighbours();
  for (size_t i = 0; i < m_swings.size(); ++i) {
    Swing& swing = m_swings[i];
    swing.kick.setZero();
    if (swing.neighbours == 0 || !(swing.stiffening.max() > unresolved_swing)) continue;
    const Vector3d behind = swing.omega / swing.neighbours - m_bodies[i].w;
    const auto part = [](double mu) {
      return mu > unresolved_swing ? (mu - unresolved_swing) / (2 * std::sqrt(1 + mu)) : 0;
    };
    swing.kick = swing.stiffening.matrix(part) * (swing.inverse * behind);
  }
  factorise();
}

void JointSystem::stiffenRows(btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
                              bool of_contacts) const {
  for (int i = 0; i < rows.size(); ++i) {
    btSolverConstraint& row = rows[i];
    if (!of_contacts && row.m_overrideNumSolverIterations == 0) continue;
    const auto stiffened = [&](int id, const btVector3& J, btVector3& component) {
      const btSolverBody& of = bodies[id];
      if (of.internalGetInvMass().isZero()) return Scalar(0);
      const Body& body = m_bodies[size_t(id)];
      const Vector3d w = body.angular * (body.angular.transpose() * inDouble(J));
      const Scalar before = J.dot(component);
      component.setValue(btScalar(w[0]), btScalar(w[1]), btScalar(w[2]));
      return J.dot(component) - before;
    };
    const Scalar change =
        stiffened(row.m_solverBodyIdA, row.m_relpos1CrossNormal, row.m_angularComponentA) +
        stiffened(row.m_solverBodyIdB, row.m_relpos2CrossNormal, row.m_angularComponentB);
    if (row.m_jacDiagABInv > 0) {
      // Where only rounding is left the row does nothing.
      const Scalar K = 1 / row.m_jacDiagABInv, left = K + change;
      const Scalar factor = left > rounding_of_K * K ? K / left : Scalar(0);
      row.m_jacDiagABInv *= factor;
      row.m_rhs *= factor;
      row.m_rhsPenetration *= factor;
      if (of_contacts) row.m_cfm *= factor;
    }
    btSolverBody &a = bodies[row.m_solverBodyIdA], &b = bodies[row.m_solverBodyIdB];
    a.internalApplyImpulse(row.m_contactNormal1 * a.internalGetInvMass(), row.m_angularComponentA,
                           row.m_appliedImpulse);
    b.internalApplyImpulse(row.m_contactNormal2 * b.internalGetInvMass(), row.m_angularComponentB,
                           row.m_appliedImpulse);
  }
}

void JointSystem::readBody(int i, const btSolverBody& from, double* u) const {
  const Body& body = m_bodies[size_t(i)];
  const btVector3 &v = from.m_deltaLinearVelocity, &w = from.m_deltaAngularVelocity;
  for (int k = 0; k < 3; ++k) {
    u[k] = body.linear[k] > 0 ? double(v[k]) / body.linear[k] : 0;
    u[3 + k] = body.inverse(k, 0) * double(w[0]) + body.inverse(k, 1) * double(w[1]) +
               body.inverse(k, 2) * double(w[2]);
  }
}

// Rounding is cut to zero: it would move a body out of its plane, and become a denormal number, which is slow.
void JointSystem::writeBody(int i, btSolverBody& to) const {
  const Body& body = m_bodies[size_t(i)];
  const double* u = &m_u[6 * size_t(i)];
  double v[6], largest = 0;
  for (int k = 0; k < 3; ++k) {
    v[k] = body.linear[k] * u[k];
    v[3 + k] = body.angular(k, 0) * u[3] + body.angular(k, 1) * u[4] + body.angular(k, 2) * u[5];
  }
  for (const double x : v) largest = std::max(largest, std::abs(x));
  for (double& x : v)
    if (std::abs(x) < velocity_rounding * largest) x = 0;
  for (int k = 0; k < 3; ++k) {
    to.m_deltaLinearVelocity[k] = btScalar(v[k]);
    to.m_deltaAngularVelocity[k] = btScalar(v[3 + k]);
  }
}

// Bodies without joints are not in the system.
bool JointSystem::read(const btAlignedObjectArray<btSolverBody>& bodies) {
  bool any = false;
  for (size_t i = 0; i < m_topology->body_component.size(); ++i) {
    if (m_topology->body_component[i] < 0) continue;
    const btSolverBody& body = bodies[int(i)];
    double* u = &m_u[6 * i];
    std::fill(u, u + 6, 0.);
    if (body.m_deltaLinearVelocity.isZero() && body.m_deltaAngularVelocity.isZero()) continue;
    readBody(int(i), body, u);
    any = true;
  }
  return any;
}

void JointSystem::write(btAlignedObjectArray<btSolverBody>& bodies) const {
  for (size_t i = 0; i < m_topology->body_component.size(); ++i)
    if (m_topology->body_component[i] >= 0) writeBody(int(i), bodies[int(i)]);
}

void JointSystem::touch(const btConstraintArray& rows, bool of_contacts) {
  const auto& components = m_topology->body_component;
  for (int i = 0; i < rows.size(); ++i) {
    if (!of_contacts && rows[i].m_overrideNumSolverIterations == 0) continue;
    for (const int body : {rows[i].m_solverBodyIdA, rows[i].m_solverBodyIdB}) {
      const auto at = size_t(body);
      if (at >= components.size() || components[at] < 0 || m_is_touched[at]) continue;
      m_is_touched[at] = true;
      m_touched.push_back(body);
    }
  }
}

void JointSystem::beginReactions(const btAlignedObjectArray<btSolverBody>& bodies,
                                 std::initializer_list<const btConstraintArray*> contacts,
                                 btConstraintArray& rows) {
  m_is_touched.assign(size_t(bodies.size()), false);
  m_touched.clear();
  touch(rows, false);
  for (const btConstraintArray* of : contacts) touch(*of, true);

  m_reacts.assign(m_blocks.size(), false);
  m_first_reacting.clear();
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    for (const int body : m_blocks[c].body)
      if (body >= 0 && m_is_touched[size_t(body)]) m_reacts[c] = true;
    if (m_reacts[c]) m_first_reacting.push_back(int(c));
  }
  m_topology->elimination.close(m_reacts, m_reacting);
  m_unreacted.clear();
  for (const int body : m_touched)
    m_unreacted.insert(m_unreacted.end(), &m_u[6 * size_t(body)], &m_u[6 * size_t(body)] + 6);
  m_change.assign(m_u.size(), 0.);
  overRelax(bodies, rows);
}

void JointSystem::clearLists() {
  m_first_of.assign(m_bodies.size(), -1);
  m_next_of.resize(2 * m_blocks.size());
}
void JointSystem::listJoint(int c) {
  for (int side = 0; side < 2; ++side) {
    const int body = m_blocks[size_t(c)].body[side];
    if (body < 0) continue;
    m_next_of[size_t(2 * c + side)] = m_first_of[size_t(body)];
    m_first_of[size_t(body)] = 2 * c + side;
  }
}

// Calls f with each listed joint of a body, and the body's side there.
template <class Function>
void JointSystem::eachJoint(int body, const Function& f) const {
  for (int i = m_first_of[size_t(body)]; i >= 0; i = m_next_of[size_t(i)]) f(i / 2, i % 2);
}

// The Schur complement: K of a row with the reaction of all joints.
double JointSystem::reactingK(const btSolverConstraint& row) {
  double whole = 0;
  const auto each = [&](const auto& f) {
    f(row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal);
    f(row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal);
  };
  m_path.clear();
  each([&](int body, const btVector3&, const btVector3&) {
    eachJoint(body, [&](int c, int) { m_topology->elimination.climb(c, m_is_on_path, m_path); });
  });
  std::sort(m_path.begin(), m_path.end());
  for (const int c : m_path) column(m_x.data(), c).setZero();
  each([&](int id, const btVector3& linear, const btVector3& angular) {
    const Body& body = m_bodies[size_t(id)];
    if (!body.moves) return;
    double j[6];
    scaleRow(body, inDouble(linear), inDouble(angular), j);
    for (const double x : j) whole += x * x;
    eachJoint(id, [&](int c, int side) {
      for (int k = 0; k < 6; ++k)
        column(m_x.data(), c) += j[k] * column(m_blocks[size_t(c)].J[side][k]);
    });
  });
  const double taken = m_factor.product(m_x.data(), m_path);
  for (const int c : m_path) m_is_on_path[size_t(c)] = false;
  return whole - taken;
}

// The joints' reaction makes K of a row smaller than Bullet's, so plain steps would reach its target slowly. A whole
// pass is iterated before the joints react. That converges as long as no step exceeds twice Bullet's.
void JointSystem::overRelax(const btAlignedObjectArray<btSolverBody>& bodies,
                            btConstraintArray& rows) {
  m_over_relaxed.clear();
  if (m_all || m_has_locked_axes) return;
  m_is_on_path.assign(m_blocks.size(), false);
  clearLists();
  for (const int c : m_first_reacting) listJoint(c);
  for (int i = 0; i < rows.size(); ++i) {
    btSolverConstraint& row = rows[i];
    if (row.m_overrideNumSolverIterations == 0 || !isPrepared(row)) continue;
    if (isIllConditioned(row, bodies)) continue;
    const double K = bulletK(row), softness = double(row.m_cfm) * K;
    const Scalar factor = Scalar((K + softness) / (std::max(reactingK(row), K / 2) + softness));
    if (!(factor > 1)) continue;
    m_over_relaxed.push_back({i, row.m_jacDiagABInv, row.m_rhs, row.m_cfm});
    row.m_jacDiagABInv *= factor;
    row.m_rhs *= factor;
    row.m_cfm *= factor;
  }
}

void JointSystem::readTouched(const btAlignedObjectArray<btSolverBody>& bodies) {
  double* unreacted = m_unreacted.data();
  for (const int body : m_touched) {
    double* u = &m_u[6 * size_t(body)];
    double* change = &m_change[6 * size_t(body)];
    readBody(body, bodies[body], change);
    for (int k = 0; k < 6; ++k) {
      const double now = change[k];
      change[k] -= u[k];
      u[k] = now;
      *unreacted++ += change[k];
    }
  }
}

void JointSystem::react(btAlignedObjectArray<btSolverBody>& bodies) {
  readTouched(bodies);
  for (const int c : m_reacting) column(m_x.data(), c).setZero();
  for (const int c : m_first_reacting) {
    const JointBlock& block = m_blocks[size_t(c)];
    BlockColumn x = BlockColumn::Zero();
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0 || !m_is_touched[size_t(block.body[side])]) continue;
      const double* change = &m_change[6 * size_t(block.body[side])];
      for (int k = 0; k < 6; ++k) x -= change[k] * column(block.J[side][k]);
    }
    column(m_x.data(), c) = x;
  }
  m_factor.solve(m_x.data(), m_reacting);
  for (const int c : m_first_reacting) {
    const JointBlock& block = m_blocks[size_t(c)];
    const BlockColumn x = column(m_x.data(), c);
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0 || !m_is_touched[size_t(block.body[side])]) continue;
      double* u = &m_u[6 * size_t(block.body[side])];
      for (int k = 0; k < 6; ++k) u[k] += x.dot(column(block.J[side][k]));
    }
  }
  for (const int body : m_touched) writeBody(body, bodies[body]);
}

void JointSystem::endReactions(const btAlignedObjectArray<btSolverBody>& bodies,
                               btConstraintArray& rows) {
  for (const OverRelaxed& as : m_over_relaxed) {
    rows[as.row].m_jacDiagABInv = as.inverse_K;
    rows[as.row].m_rhs = as.rhs;
    rows[as.row].m_cfm = as.cfm;
  }
  readTouched(bodies);
  const double* unreacted = m_unreacted.data();
  for (const int body : m_touched)
    for (int k = 0; k < 6; ++k) m_u[6 * size_t(body) + size_t(k)] = *unreacted++;
  solve();
}

void JointSystem::restoreMomentum(const btAlignedObjectArray<btSolverBody>& bodies) {
  if (m_has_locked_axes || std::none_of(m_swings.begin(), m_swings.end(),
                                        [](const Swing& swing) { return swing.stiffening.any(); }))
    return;
  const std::vector<int>& component = m_topology->body_component;
  m_rigid_components.assign(size_t(m_topology->components), RigidComponent());
  for (size_t i = 0; i < m_rigid_components.size(); ++i)
    m_rigid_components[i].held = m_topology->grounded[i];
  for (const int body : m_touched) m_rigid_components[size_t(component[size_t(body)])].held = true;
  const auto each = [&](const auto& f) {
    for (size_t i = 0; i < component.size(); ++i) {
      if (component[i] < 0 || m_rigid_components[size_t(component[i])].held) continue;
      const btVector3& x = bodies[int(i)].m_worldTransform.getOrigin();
      const double mass = 1 / double(bodies[int(i)].internalGetInvMass()[0]);
      f(m_rigid_components[size_t(component[i])], i, inDouble(x), mass);
    }
  };
  each([](RigidComponent& rigid, size_t, const Vector3d& x, double mass) {
    rigid.mass += mass;
    rigid.centre += mass * x;
  });
  for (RigidComponent& rigid : m_rigid_components) rigid.centre /= rigid.mass;
  each([this](RigidComponent& rigid, size_t i, const Vector3d& x, double mass) {
    const Swing& swing = m_swings[i];
    const Vector3d r = x - rigid.centre;
    const Matrix3d inertia = swing.inverse.transpose() * swing.inverse;
    rigid.inertia += inertia + mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
    if (!swing.stiffening.any()) return;
    const Eigen::Map<const Vector3d> u(&m_u[6 * i + 3]);
    rigid.lost +=
        m_bodies[i].inverse.transpose() * (u - swing.kick) - inertia * (m_bodies[i].angular * u);
  });
  each([this](const RigidComponent& rigid, size_t i, const Vector3d& x, double) {
    const Vector3d w = rigid.inertia.inverse() * rigid.lost;
    if (!w.allFinite()) return;
    const Vector3d v = w.cross(x - rigid.centre), u = m_bodies[i].inverse * w;
    for (int k = 0; k < 3; ++k) {
      m_u[6 * i + size_t(k)] += v[k] / m_bodies[i].linear[k];
      m_u[6 * i + 3 + size_t(k)] += u[k];
    }
  });
}

// In world space, as rows may turn until the next step.
void JointSystem::rememberPointImpulses() {
  m_topology->impulses.resize(3 * m_blocks.size());
  for (size_t c = 0; c < m_blocks.size(); ++c)
    Eigen::Map<Vector3d>(&m_topology->impulses[3 * c]) =
        m_blocks[c].point[0] < 0 ? Vector3d(Vector3d::Zero()) : m_blocks[c].pointImpulse();
}

void JointSystem::recallPointImpulse(JointBlock& block, size_t c) const {
  if (m_topology->impulses.empty() || block.point[0] < 0) return;
  const Eigen::Map<const Vector3d> p(&m_topology->impulses[3 * c]);
  for (int k = 0; k < 3; ++k)
    block.impulse[block.point[k]] = p.dot(Eigen::Map<const Vector3d>(block.direction[k]));
}

void JointSystem::writeImpulses(btConstraintArray& rows) const {
  for (const JointBlock& block : m_blocks)
    for (int r = 0; r < block.rows; ++r)
      rows[block.row[r]].m_appliedImpulse = btScalar(block.impulse[r]);
}

BlockColumn JointSystem::velocity(const JointBlock& block) const {
  BlockColumn x = BlockColumn::Zero();
  for (int side = 0; side < 2; ++side) {
    if (block.body[side] < 0) continue;
    const double* u = &m_u[6 * size_t(block.body[side])];
    for (int k = 0; k < 6; ++k) x += u[k] * column(block.J[side][k]);
  }
  return x;
}

BlockColumn JointSystem::residual(const JointBlock& block) const {
  return column(block.rhs) - column(block.softness).cwiseProduct(column(block.impulse)) -
         velocity(block);
}

// Each joint is visited twice only, once up and once down the elimination: a large island does not fit the cache.
template <class Factor, class Change>
void JointSystem::apply(const Factor& factor, const Change& change) {
  m_x.assign(block_rows * m_blocks.size(), 0.);
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    column(m_x.data(), int(c)) += change(c);
    factor.eliminate(int(c), m_x.data());
  }
  for (size_t c = m_blocks.size(); c-- > 0;) {
    factor.substitute(int(c), m_x.data());
    JointBlock& block = m_blocks[c];
    const BlockColumn x = column(m_x.data(), int(c));
    column(block.impulse) += x;
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0) continue;
      double* u = &m_u[6 * size_t(block.body[side])];
      for (int k = 0; k < 6; ++k) u[k] += x.dot(column(block.J[side][k]));
    }
  }
}

void JointSystem::begin(const btAlignedObjectArray<btSolverBody>& bodies) {
  bool changed = read(bodies);
  for (size_t i = 0; i < m_swings.size(); ++i) {
    if (m_swings[i].kick.isZero(0)) continue;
    for (int k = 0; k < 3; ++k) m_u[6 * i + 3 + size_t(k)] += m_swings[i].kick[k];
    changed = true;
  }
  for (JointBlock& block : m_blocks) column(block.impulse).setZero();
  // All rows of a loop can come to rest together, even where their corrections contradict each other.
  apply(m_factor, [this, changed](size_t c) -> BlockColumn {
    const JointBlock& block = m_blocks[c];
    const auto target = column(loops() ? block.rest : block.rhs);
    return changed ? target - velocity(block) : BlockColumn(target);
  });
}

void JointSystem::solveLoopTargets() {
  if (!loops()) return;
  applyDamped([this](size_t c) -> BlockColumn {
    return column(m_blocks[c].rhs) - column(m_blocks[c].rest);
  });
}

// The rhs becomes what the rows have reached: all but their damping.
template <class Change>
void JointSystem::applyDamped(const Change& change) {
  if (!m_damped_is_factor) m_damped.factorise(dependent_pivot);
  m_damped_is_factor = true;
  apply(m_damped, change);
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    JointBlock& block = m_blocks[c];
    column(block.rhs) -= column(block.damping).cwiseProduct(column(m_x.data(), int(c)));
  }
}

void JointSystem::solve() {
  apply(m_factor, [this](size_t c) { return residual(m_blocks[c]); });
}

// Rows are solved before they are corrected, so the residual is the correction alone.
void JointSystem::correct(const std::vector<double>& change) {
  const auto add = [&](size_t c) -> BlockColumn {
    const auto more = column(change.data(), int(c));
    column(m_blocks[c].rhs) += more;
    return more;
  };
  if (loops())
    applyDamped(add);
  else
    apply(m_factor, add);
}

void JointSystem::beginEndRows() {
  m_end_factor.begin(m_factor);
  clearLists();
  for (size_t c = 0; c < m_blocks.size(); ++c) listJoint(int(c));
}

void JointSystem::scaleRow(const JointBlock& block, int r, const Vector3d (&linear)[2],
                           const Vector3d (&angular)[2], ScaledRows& J) const {
  for (int side = 0; side < 2; ++side) {
    if (block.body[side] < 0) continue;
    double j[6];
    scaleRow(m_bodies[size_t(block.body[side])], linear[side], angular[side], j);
    for (int k = 0; k < 6; ++k) J[side][k][r] = j[k];
  }
}

// Adds a block's rows of J_end M^-1 J^T: with itself, and with each block that shares a body.
void JointSystem::addEndRows(size_t c, const ScaledRows& J) {
  const Elimination& elimination = m_topology->elimination;
  const JointBlock& block = m_blocks[c];
  double* K = m_end_factor.lower(int(c));
  for (int r = 0; r < block.rows; ++r)
    K[r * (column_height(block.rows) + 1)] += block.softness[r] + (loops() ? block.damping[r] : 0);
  for (int side = 0; side < 2; ++side) {
    if (block.body[side] < 0) continue;
    eachJoint(block.body[side], [&](int i, int side_of_other) {
      const JointBlock& other = m_blocks[size_t(i)];
      const auto& J_other = other.J[side_of_other];
      const int at = elimination.block(int(c), i);
      if (i <= int(c))
        addProduct(m_end_factor.lower(at), J[side], J_other, block.rows, other.rows);
      else
        addProduct(m_end_factor.upper(at), J_other, J[side], other.rows, block.rows);
    });
  }
}

void JointSystem::correctAtEnd(const std::vector<double>& change) {
  m_end_factor.factorise();
  apply(m_end_factor, [&](size_t c) -> BlockColumn { return column(change.data(), int(c)); });
  // The rows of the start keep the velocities that result.
  for (JointBlock& block : m_blocks)
    column(block.rhs) =
        velocity(block) + column(block.softness).cwiseProduct(column(block.impulse));
}

void JointSystem::saveState() {
  m_saved_u = m_u;
  m_saved_rows.clear();
  for (const JointBlock& block : m_blocks) {
    m_saved_rows.insert(m_saved_rows.end(), block.impulse, block.impulse + block_rows);
    m_saved_rows.insert(m_saved_rows.end(), block.rhs, block.rhs + block_rows);
  }
}

void JointSystem::restoreState(double part, const std::vector<char>& components) {
  const auto go = [part](double& now, double saved) {
    now = part > 0 ? saved + part * (now - saved) : saved;
  };
  for (size_t i = 0; i < m_topology->body_component.size(); ++i) {
    const int component = m_topology->body_component[i];
    if (component < 0 || !components[size_t(component)]) continue;
    for (size_t k = 6 * i; k < 6 * i + 6; ++k) go(m_u[k], m_saved_u[k]);
  }
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    if (!components[size_t(m_topology->component[c])]) continue;
    const double* saved = &m_saved_rows[2 * block_rows * c];
    for (double& impulse : m_blocks[c].impulse) go(impulse, *saved++);
    for (double& rhs : m_blocks[c].rhs) go(rhs, *saved++);
  }
}

void JointSystem::energies(const btAlignedObjectArray<btSolverBody>& bodies,
                           std::vector<Energy>& each) const {
  each.assign(size_t(m_topology->components), Energy());
  for (size_t i = 0; i < m_topology->body_component.size(); ++i) {
    if (m_topology->body_component[i] < 0) continue;
    Energy& sum = each[size_t(m_topology->body_component[i])];
    const Body& body = m_bodies[i];
    const Matrix3d& inverse = m_swings.empty() ? body.inverse : m_swings[i].inverse;
    const btSolverBody& of = bodies[int(i)];
    const auto energy = [&](const btVector3& v, const btVector3& w) {
      double twice = (inverse * inDouble(w)).squaredNorm();
      for (int k = 0; k < 3; ++k)
        if (body.linear[k] > 0)
          twice += double(v[k]) * double(v[k]) / (body.linear[k] * body.linear[k]);
      return twice / 2;
    };
    const btVector3 v = of.m_linearVelocity + of.m_externalForceImpulse;
    const btVector3 w = of.m_angularVelocity + of.m_externalTorqueImpulse;
    const btVector3 v_end = linearVelocity(of), w_end = angularVelocity(of);
    const btVector3 &dv = of.m_deltaLinearVelocity, &dw = of.m_deltaAngularVelocity;
    const double added = energy(dv, dw);
    sum.free += energy(v, w);
    sum.spin = std::max(sum.spin, double(w.length()));
    sum.spin_at_end = std::max(sum.spin_at_end, double(w_end.length()));
    sum.now += energy(v_end, w_end);
    sum.added += added;
    // The work of a velocity change d at v: d M v = E(v + d) - E(v) - E(d)
    const btVector3 twice_v = of.m_linearVelocity + v_end, twice_w = of.m_angularVelocity + w_end;
    sum.given += (energy(twice_v + dv, twice_w + dw) - energy(twice_v, twice_w) - added) / 2;
    sum.unit += energy(btVector3(1, 0, 0), btVector3(1, 1, 1) / btSqrt(3));
  }
  // An impulse works on the mean of the velocities before and after it. Moving frames count in these.
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const JointBlock& block = m_blocks[c];
    const BlockColumn change = velocity(block);
    Energy& sum = each[size_t(m_topology->component[c])];
    for (int r = 0; r < block.rows; ++r) {
      if (block.equality[r]) sum.work += block.impulse[r] * (change[r] / 2 - block.rest[r]);
      sum.is_rigid = sum.is_rigid && block.holds[r];
    }
    sum.is_rigid = sum.is_rigid && !block.is_carried;
  }
}

void JointSystem::undoCorrections(const btConstraintArray& rows,
                                  const std::vector<char>& components) {
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    JointBlock& block = m_blocks[c];
    if (!components[size_t(m_topology->component[c])]) continue;
    for (int r = 0; r < block.rows; ++r) {
      const btSolverConstraint& row = rows[block.row[r]];
      const bool corrected = block.damping[r] > 0;
      block.rhs[r] = corrected ? rhs(row, block.rest[r]) : block.rest[r];
    }
  }
}

void JointSystem::limitCorrectionSpeed(const std::vector<char>& components,
                                       const std::vector<double>& speed) {
  std::vector<double>& largest = m_max_correction_speeds;
  largest.assign(components.size(), 0);
  const auto component = [&](size_t c) { return size_t(m_topology->component[c]); };
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const JointBlock& block = m_blocks[c];
    const BlockColumn correction = column(block.rhs) - column(block.rest);
    largest[component(c)] = std::max(largest[component(c)], correction.cwiseAbs().maxCoeff());
  }
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const size_t of = component(c);
    if (!components[of] || !(largest[of] > speed[of])) continue;
    JointBlock& block = m_blocks[c];
    const BlockColumn correction = column(block.rhs) - column(block.rest);
    column(block.rhs) = column(block.rest) + speed[of] / largest[of] * correction;
  }
  if (m_swings.empty()) return;
  for (Swing& swing : m_swings) swing.next_stiffening = Stiffening();
  changeInertia();
}

void JointSystem::scaleVelocities(const btAlignedObjectArray<btSolverBody>& bodies,
                                  const std::vector<double>& parts) {
  const std::vector<int>& component = m_topology->body_component;
  const auto velocity = [this](size_t i) {
    const Body& body = m_bodies[i];
    const Eigen::Map<const Vector3d> u(&m_u[6 * i]), linear(body.linear);
    return Vector3d(body.v + linear.cwiseProduct(u));
  };
  m_rigid_components.assign(parts.size(), RigidComponent());
  for (size_t i = 0; i < component.size(); ++i) {
    if (component[i] < 0 || m_topology->grounded[size_t(component[i])]) continue;
    RigidComponent& rigid = m_rigid_components[size_t(component[i])];
    const double mass = 1 / double(bodies[int(i)].m_originalBody->getInvMass());
    rigid.mass += mass;
    rigid.velocity += mass * velocity(i);
  }
  for (RigidComponent& rigid : m_rigid_components)
    if (rigid.mass > 0) rigid.velocity /= rigid.mass;
  for (size_t i = 0; i < component.size(); ++i) {
    const double less = component[i] < 0 ? 0 : 1 - parts[size_t(component[i])];
    if (less == 0) continue;
    const Body& body = m_bodies[i];
    const Vector3d v = velocity(i) - m_rigid_components[size_t(component[i])].velocity;
    const Eigen::Map<const Vector3d> u(&m_u[6 * i + 3]);
    const Vector3d turn = body.inverse * (body.w + body.angular * u);
    for (int k = 0; k < 3; ++k) {
      if (body.linear[k] > 0) m_u[6 * i + size_t(k)] -= less * v[k] / body.linear[k];
      m_u[6 * i + 3 + size_t(k)] -= less * turn[k];
    }
  }
}

void JointSystem::scaleImpulses(const std::vector<double>& parts) {
  for (size_t i = 0; i < m_topology->body_component.size(); ++i) {
    const int component = m_topology->body_component[i];
    if (component < 0) continue;
    for (size_t k = 6 * i; k < 6 * i + 6; ++k) m_u[k] *= parts[size_t(component)];
  }
  for (size_t c = 0; c < m_blocks.size(); ++c)
    column(m_blocks[c].impulse) *= parts[size_t(m_topology->component[c])];
}

bool JointSystem::finite() const {
  const double sum = Eigen::Map<const Eigen::VectorXd>(m_u.data(), Eigen::Index(m_u.size())).sum();
  return sum - sum == 0;
}

bool JointSystem::releaseSaturated(btConstraintArray& rows, bool all) {
  if (!m_bounded) return false;
  const auto each = [&](const auto& f) {
    for (size_t c = 0; c < m_blocks.size(); ++c) {
      const JointBlock& block = m_blocks[c];
      for (int r = 0; r < block.rows; ++r)
        if (block.bound[r] >= 0)
          f(rows[block.row[r]], block.equality[r], Scalar(block.impulse[r]),
            m_topology->at_bound[Topology::joint_rows * c + size_t(block.bound[r])]);
    }
  };
  bool any = false;
  each([&](const btSolverConstraint& row, bool equality, Scalar impulse, Scalar& at_bound) {
    at_bound = equality ? Topology::inside : atBound(row, impulse);
    any = any || at_bound != Topology::inside;
  });
  // Breaking is looked at once no other row exceeds its bounds: such an excess would break joints for nothing.
  if (!any)
    each([&](btSolverConstraint& row, bool equality, Scalar impulse, Scalar& at_bound) {
      if (equality) at_bound = atBound(row, impulse);
      if (at_bound == Topology::inside) return;
      any = true;
      row.m_lowerLimit = row.m_upperLimit = at_bound;
    });
  if (any && all)
    each([](const btSolverConstraint&, bool, Scalar impulse, Scalar& at_bound) {
      if (at_bound == Topology::inside) at_bound = impulse;
    });
  return any;
}

bool JointSystem::reclaimUnsaturated(const btAlignedObjectArray<btSolverBody>& bodies,
                                     const btConstraintArray& rows, Scalar dt) {
  if (m_all) return false;
  // Whether the row's residual would draw it off its bound.
  const double much = max_bound_error / double(dt);
  const auto isDrawnOff = [&](const btSolverConstraint& row) {
    const double lacks = double(row.m_rhs - row.m_cfm * row.m_appliedImpulse) * bulletK(row) -
                         changeOfVelocity(row, bodies);
    return row.m_appliedImpulse > row.m_lowerLimit ? lacks < -much : lacks > much;
  };
  bool any = false;
  const Elimination& elimination = m_topology->elimination;
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const Gathered& from = m_gathered[size_t(elimination.node(int(c)))];
    int places = block_rows - m_blocks[c].rows;
    for (int i = 0; i < from.rows; ++i) {
      Scalar& at_bound = m_topology->at_bound[Topology::joint_rows * c + size_t(i)];
      if (from.bound[i] < 0 || at_bound == Topology::inside) continue;
      const btSolverConstraint& row = rows[from.row[i]];
      if (isPinned(row)) continue;
      const Scalar impulse = row.m_appliedImpulse;
      at_bound = isDrawnOff(row) ? Topology::inside : atBound(row, impulse);
      if (at_bound != Topology::inside) continue;
      if (places-- > 0)
        any = true;
      else
        at_bound = impulse;
    }
  }
  return any;
}

void JointSystem::report(btAlignedObjectArray<btSolverBody>& bodies, const btConstraintArray& rows,
                         Scalar dt) const {
  if (!m_bounded) return;
  for (const JointBlock& block : m_blocks) {
    if (std::none_of(block.bound, block.bound + block.rows, [](int i) { return i >= 0; })) continue;
    const btSolverConstraint& row = rows[block.row[0]];
    block.joint->solveConstraintObsolete(bodies[row.m_solverBodyIdA], bodies[row.m_solverBodyIdB],
                                         dt);
  }
}

void JointSystem::releaseAll(btConstraintArray& rows, int iterations) {
  m_topology->impulses.clear();
  m_topology->iterated.clear();
  std::fill(m_topology->at_bound.begin(), m_topology->at_bound.end(), Topology::inside);
  for (const JointBlock& block : m_blocks) {
    for (int r = 0; r < block.rows; ++r) {
      rows[block.row[r]].m_overrideNumSolverIterations = iterations;
      rows[block.row[r]].m_appliedImpulse = 0;
    }
  }
}

size_t JointSystem::bytes() const {
  return m_topologies.bytes() + m_factor.bytes() + m_damped.bytes() + m_end_factor.bytes() +
         m_blocks.capacity() * sizeof(JointBlock) + m_gathered.capacity() * sizeof(Gathered) +
         m_iterated_rows.capacity() * sizeof(IteratedRow) +
         m_joints.capacity() * sizeof(Topology::Joint) + m_rows.capacity() * sizeof(int) +
         m_bodies.capacity() * sizeof(Body) + m_swings.capacity() * sizeof(Swing) +
         m_rigid_components.capacity() * sizeof(RigidComponent) +
         (m_u.capacity() + m_x.capacity() + m_saved_u.capacity() + m_saved_rows.capacity() +
          m_unreacted.capacity() + m_change.capacity()) *
             sizeof(double) +
         m_is_touched.capacity() + m_reacts.capacity() + m_is_on_path.capacity() +
         m_over_relaxed.capacity() * sizeof(OverRelaxed) +
         (m_touched.capacity() + m_reacting.capacity() + m_first_reacting.capacity() +
          m_first_of.capacity() + m_next_of.capacity() + m_path.capacity()) *
             sizeof(int);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
