// Purpose: where a step ends, and how far the joints are from holding there.
#pragma once

#include <pintle/rows/row.h>
#include <pintle/solver/joint_system.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class EndOfStep {
 public:
  /// Begins a step of so many blocks.
  void begin(size_t blocks, const btAlignedObjectArray<btSolverBody>& bodies);
  /// The poses that Bullet integrates to from the velocities that the bodies have now.
  void predict(const btAlignedObjectArray<btSolverBody>& bodies, const btContactSolverInfo& info);

  /// Of each row of each block, the change of its velocity (m/s, rad/s) that makes it hold at the end
  /// of the step, as far as a step is to go, and a limit end where its row sends it; 0 for rows that are
  /// soft or no matter of position.
  /// The largest one of each component of the topology, times the step, is `largest`, m or rad: but for what
  /// positions so far from the origin are rounded by.
  void errors(const JointSystem& joints, const btConstraintArray& rows, std::vector<double>& error,
              std::vector<double>& largest);
  /// The largest of rows that have turned away from those of the start, and by these cannot be corrected.
  double largestTurned() const { return m_largest_turned; }
  void clearTurned(std::vector<double>& error) const;
  /// Adds to the joints their rows at the predicted poses, by what these change with the bodies' velocities.
  void addEndRows(JointSystem& joints, const btConstraintArray& rows,
                  const btAlignedObjectArray<btSolverBody>& bodies);

 private:
  /// `far`: whether it begins further off than the step may close.
  void errors(const JointBlock& block, const btConstraintArray& rows, double* error, char& far,
              unsigned char& turned);
  const btTransform& pose(const btRigidBody& body, int solver_body) const {
    return solver_body < 0 ? body.getCenterOfMassTransform() : m_poses[size_t(solver_body)];
  }
  template <class Set>
  void endRows(const JointBlock& block, const btConstraintArray& rows, const Set& set);
  /// Whether a row at the end tells of what the joint holds at the start: as the same row, or as one that has turned.
  enum class Match { none, same, turned };
  static Match match(const Joint& joint, const Rows& end, int row);
  static Match match(const JointBlock& block, const btConstraintArray& rows, int r,
                     const btSolverConstraint& end);
  using Speeds = double[block_rows];
  /// Those of the whole error, with the bodies at the given poses; of a limit, of what is missing on the way
  /// to where its row sends it.
  void speeds(const JointBlock& block, const btConstraintArray& rows, const btTransform& pose_a,
              const btTransform& pose_b, Speeds& speed, Speeds& max_speed, unsigned char& turned);
  /// How many of the joint's rows come before those of free coordinates, which only Pintle's tell of.
  static int equalities(const JointBlock& block);
  static Scalar ownersVelocity(const Joint& joint, const Row& row);
  /// Of the velocity of a rigid limit's row in the mean over a step that ends with the rows `end`.
  Scalar missing(const Joint& joint, int row, const Rows& end) const;

  RowMemory<most_joint_rows, most_joint_rows> m_memory;
  std::vector<btTransform> m_poses;
  std::vector<char> m_far;              ///< of each block
  std::vector<unsigned char> m_turned;  ///< of each block, a bit for each row
  double m_largest_turned = 0;
  Scalar m_dt = 0, m_erp = 0;
  double m_rounding = 0;  ///< of positions, m
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
