// Purpose: the bilateral joint rows of an island as one linear system,
//   (J M^-1 J^T + Sigma) lambda = deficit - J v,  Sigma = gamma / dt (document, 2.12),
// written in velocities u that are scaled by the root of the mass, v = S u with S S^T = M^-1: rows
// become J S, and both K and what an impulse does to the bodies are made of these alone.
#pragma once

#include <pintle/solver/block_factor.h>
#include <pintle/solver/geometric_stiffness.h>
#include <pintle/solver/topology.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rows of a joint, or some of them, that the system holds: one block of K.
struct JointBlock {
  btTypedConstraint* joint;
  int rows;
  int row[block_rows];           ///< in Bullet's pool
  int index[block_rows];         ///< among the rows of the joint
  int body[2];                   ///< among Bullet's solver bodies; -1: does not move
  double J[2][6][block_rows];    ///< J S of each body, by coordinate: linear, then angular
  double deficit[block_rows];    ///< what the velocity lacks before any impulse: target - J v
  double softness[block_rows];   ///< Sigma
  double impulse[block_rows];    ///< lambda
};

class JointSystem {
 public:
  /// Takes the bilateral rows out of Bullet's. Returns whether there are any.
  bool gather(const btAlignedObjectArray<btSolverBody>& bodies, const btConstraintArray& rows);
  /// K and its factor.
  void factorise();
  /// Adds the geometric stiffness of the impulses that the joints have now to the inertia of each body
  /// that needs it. Returns whether it has changed: then K is another one, and the joints are to be
  /// solved anew.
  bool stiffen(const btAlignedObjectArray<btSolverBody>& bodies, const btConstraintArray& rows,
               Scalar dt);

  /// Bullet's changes of velocity, to u and back.
  void read(const btAlignedObjectArray<btSolverBody>& bodies);
  void write(btAlignedObjectArray<btSolverBody>& bodies) const;
  void writeImpulses(btConstraintArray& rows) const;

  /// One exact solution: all rows meet their targets at what velocity the bodies have now. Returns
  /// the largest change of velocity that a row asked for, m/s or rad/s.
  double solve();

  std::vector<JointBlock>& blocks() { return m_blocks; }
  /// How many rows say what others say already.
  int dependent() const { return m_factor.dependent(); }
  /// Bytes held, of which an island needs its share.
  size_t bytes() const;

 private:
  struct Body {
    double linear[3];
    Matrix3d angular, inverse;  ///< S of the body alone, and its inverse
    Stiffening stiffening, next_stiffening;
    Matrix3d turn;  ///< from the coordinates u with the one to those with the next
    Matrix3d stiff_angular, stiff_inverse;  ///< the same with the stiffening
    Matrix3d stiffness;                     ///< of the levers of its joints, N m s
    Vector3d omega;                         ///< sum of its neighbours', rad/s
    int neighbours;
  };

  void scale(Body& body, const btSolverBody& of) const;
  void addLevers(const btConstraintArray& rows);
  void addNeighbours(const btAlignedObjectArray<btSolverBody>& bodies);
  void setRow(JointBlock& block, int side, const btSolverConstraint& row, int r) const;

  Topologies m_topologies;
  const Topology* m_topology = nullptr;
  struct Gathered {
    btTypedConstraint* joint;
    int row[block_rows], index[block_rows];
  };
  std::vector<Gathered> m_gathered;  ///< as they come
  std::vector<JointBlock> m_blocks;  ///< in the order of elimination
  std::vector<Topology::Joint> m_joints;
  std::vector<Body> m_bodies;
  std::vector<double> m_u;       ///< 6 a body
  std::vector<double> m_x;       ///< block_rows a block
  BlockFactor m_factor;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
