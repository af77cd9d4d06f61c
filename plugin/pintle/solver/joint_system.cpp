#include <pintle/solver/joint_system.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bodies take numbers of this size for no bound; Bullet's own is the largest of its type.
constexpr Scalar unbounded = Scalar(BT_LARGE_FLOAT);

// What is left of a pivot after this part of its row is rounding: of double, or, where rows came in
// single precision, of what two of them that say the same differ by, squared.
constexpr double dependent_row = 1e-12;

bool isBilateral(const btSolverConstraint& row) {
  return row.m_lowerLimit <= -unbounded && row.m_upperLimit >= unbounded && row.m_jacDiagABInv > 0;
}

double dot3(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

bool JointSystem::gather(const btAlignedObjectArray<btSolverBody>& bodies,
                         const btConstraintArray& rows) {
  m_gathered.clear();
  m_joints.clear();
  const auto moving = [&](int body) { return bodies[body].internalGetInvMass().isZero() ? -1 : body; };
  const btTypedConstraint* last = nullptr;
  int index = 0;
  for (int i = 0; i < rows.size(); ++i, ++index) {
    const btSolverConstraint& row = rows[i];
    auto* joint = static_cast<btTypedConstraint*>(row.m_originalContactPoint);
    const bool next = joint != last;
    if (next) index = 0;
    if (!isBilateral(row)) {
      if (next) last = nullptr;
      continue;
    }
    if (joint != last || m_joints.back().rows == block_rows) {
      m_gathered.push_back({joint, {}, {}});
      m_joints.push_back({0, {moving(row.m_solverBodyIdA), moving(row.m_solverBodyIdB)}});
    }
    last = joint;
    const int r = m_joints.back().rows++;
    m_gathered.back().row[r] = i;
    m_gathered.back().index[r] = index;
  }
  if (m_joints.empty()) return false;

  m_topology = &m_topologies.get(m_joints);
  const Elimination& elimination = m_topology->elimination;
  const size_t n = m_joints.size();
  m_bodies.resize(size_t(bodies.size()));
  for (int i = 0; i < bodies.size(); ++i)
    if (moving(i) >= 0) scale(m_bodies[size_t(i)], bodies[i]);
  m_blocks.resize(n);
  for (size_t c = 0; c < n; ++c) {
    const int node = elimination.node(int(c));
    const Gathered& from = m_gathered[size_t(node)];
    const Topology::Joint& joint = m_joints[size_t(node)];
    JointBlock& block = m_blocks[c];
    std::memset(static_cast<void*>(&block), 0, sizeof(block));
    block.joint = from.joint;
    block.rows = joint.rows;
    for (int side = 0; side < 2; ++side) block.body[side] = joint.body[side];
    for (int r = 0; r < block.rows; ++r) {
      const btSolverConstraint& row = rows[from.row[r]];
      block.row[r] = from.row[r];
      block.index[r] = from.index[r];
      for (int side = 0; side < 2; ++side)
        if (block.body[side] >= 0) setRow(block, side, row, r);
      const double K = 1 / double(row.m_jacDiagABInv);
      block.deficit[r] = double(row.m_rhs) * K;
      block.softness[r] = double(row.m_cfm) * K;
    }
  }
  m_u.assign(6 * m_bodies.size(), 0);
  m_x.resize(block_rows * n);
  return true;
}

void JointSystem::scale(Body& body, const btSolverBody& of) const {
  const btVector3& mass = of.internalGetInvMass();
  const btMatrix3x3& I = of.m_originalBody->getInvInertiaTensorWorld();
  double A[3][3];
  for (int i = 0; i < 3; ++i) {
    body.linear[i] = std::sqrt(double(mass[i]) * double(of.m_linearFactor[i]));
    for (int k = 0; k < 3; ++k)
      A[i][k] = double(of.m_angularFactor[i]) * double(I[i][k]) * double(of.m_angularFactor[k]);
  }
  // Cholesky; an axis about which the body cannot turn has no column.
  double(&S)[3][3] = body.angular;
  double(&inverse)[3][3] = body.inverse;
  for (int k = 0; k < 3; ++k) {
    const double pivot = A[k][k];
    const double root = pivot > 0 ? std::sqrt(pivot) : 0, reciprocal = root > 0 ? 1 / root : 0;
    for (int i = 0; i < 3; ++i) S[k][i] = i < k ? 0 : A[i][k] * reciprocal;
    for (int i = k + 1; i < 3; ++i)
      for (int j = k + 1; j < 3; ++j) A[i][j] -= S[k][i] * S[k][j];
    for (int j = 0; j < 3; ++j) inverse[j][k] = j == k ? reciprocal : 0;
    for (int j = 0; j < k; ++j) {
      double sum = 0;
      for (int i = j; i < k; ++i) sum -= S[i][k] * inverse[j][i];
      inverse[j][k] = sum * reciprocal;
    }
  }
}

void JointSystem::setRow(JointBlock& block, int side, const btSolverConstraint& row, int r) const {
  const Body& body = m_bodies[size_t(block.body[side])];
  const btVector3& linear = side == 0 ? row.m_contactNormal1 : row.m_contactNormal2;
  const btVector3& angular = side == 0 ? row.m_relpos1CrossNormal : row.m_relpos2CrossNormal;
  const double w[3] = {double(angular[0]), double(angular[1]), double(angular[2])};
  for (int k = 0; k < 3; ++k) {
    block.J[side][k][r] = double(linear[k]) * body.linear[k];
    block.J[side][3 + k][r] = dot3(body.angular[k], w);
  }
}

void JointSystem::factorise() {
  const Elimination& elimination = m_topology->elimination;
  m_factor.resize(elimination, m_topology->rows);
  m_factor.clear();
  const int columns = elimination.columns();
  for (int c = 0; c < columns; ++c) {
    const JointBlock& block = m_blocks[size_t(c)];
    double* K = m_factor.block(c);
    for (int q = 0; q < block.rows; ++q) {
      BlockColumn sum = BlockColumn::Zero();
      for (int side = 0; side < 2; ++side)
        for (int k = 0; k < 6; ++k)
          sum += block.J[side][k][q] * column(block.J[side][k]);
      sum[q] += block.softness[q];
      column(K, q) = sum;
    }
    for (int i = elimination.first(c); i < elimination.first(c + 1); ++i) {
      const JointBlock& other = m_blocks[size_t(elimination.row(i))];
      double* to = m_factor.block(i);
      for (int s = 0; s < 2; ++s) {
        for (int t = 0; t < 2; ++t) {
          if (block.body[s] < 0 || block.body[s] != other.body[t]) continue;
          for (int q = 0; q < block.rows; ++q) {
            BlockColumn sum = column(to, q);
            for (int k = 0; k < 6; ++k)
              sum += block.J[s][k][q] * column(other.J[t][k]);
            column(to, q) = sum;
          }
        }
      }
    }
  }
  m_factor.factorise(dependent_row);
}

void JointSystem::read(const btAlignedObjectArray<btSolverBody>& bodies) {
  for (size_t i = 0; i < m_bodies.size(); ++i) {
    const btSolverBody& from = bodies[int(i)];
    if (from.internalGetInvMass().isZero()) continue;
    const Body& body = m_bodies[i];
    double* u = &m_u[6 * i];
    const btVector3 &v = from.m_deltaLinearVelocity, &w = from.m_deltaAngularVelocity;
    for (int k = 0; k < 3; ++k) {
      u[k] = body.linear[k] > 0 ? double(v[k]) / body.linear[k] : 0;
      u[3 + k] = body.inverse[0][k] * double(w[0]) + body.inverse[1][k] * double(w[1]) +
                 body.inverse[2][k] * double(w[2]);
    }
  }
}

void JointSystem::write(btAlignedObjectArray<btSolverBody>& bodies) const {
  for (size_t i = 0; i < m_bodies.size(); ++i) {
    btSolverBody& to = bodies[int(i)];
    if (to.internalGetInvMass().isZero()) continue;
    const Body& body = m_bodies[i];
    const double* u = &m_u[6 * i];
    for (int k = 0; k < 3; ++k) {
      to.m_deltaLinearVelocity[k] = btScalar(body.linear[k] * u[k]);
      to.m_deltaAngularVelocity[k] = btScalar(body.angular[0][k] * u[3] + body.angular[1][k] * u[4] +
                                              body.angular[2][k] * u[5]);
    }
  }
}

void JointSystem::writeImpulses(btConstraintArray& rows) const {
  for (const JointBlock& block : m_blocks)
    for (int r = 0; r < block.rows; ++r)
      rows[block.row[r]].m_appliedImpulse = btScalar(block.impulse[r]);
}

double JointSystem::solve() {
  double largest = 0;
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    const JointBlock& block = m_blocks[c];
    BlockColumn x = column(block.deficit) -
                    column(block.softness).cwiseProduct(column(block.impulse));
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0) continue;
      const double* u = &m_u[6 * size_t(block.body[side])];
      for (int k = 0; k < 6; ++k) x -= u[k] * column(block.J[side][k]);
    }
    largest = std::max(largest, x.lpNorm<Eigen::Infinity>());
    column(m_x.data(), int(c)) = x;
  }
  m_factor.solve(m_x.data());
  for (size_t c = 0; c < m_blocks.size(); ++c) {
    JointBlock& block = m_blocks[c];
    const BlockColumn x = column(m_x.data(), int(c));
    column(block.impulse) += x;
    for (int side = 0; side < 2; ++side) {
      if (block.body[side] < 0) continue;
      double* u = &m_u[6 * size_t(block.body[side])];
      for (int k = 0; k < 6; ++k) u[k] += x.dot(column(block.J[side][k]));
    }
  }
  return largest;
}

size_t JointSystem::bytes() const {
  return m_topologies.bytes() + m_factor.bytes() + m_blocks.capacity() * sizeof(JointBlock) +
         m_gathered.capacity() * sizeof(Gathered) + m_joints.capacity() * sizeof(Topology::Joint) +
         m_bodies.capacity() * sizeof(Body) + (m_u.capacity() + m_x.capacity()) * sizeof(double);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
