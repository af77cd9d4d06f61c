// Purpose: where a step ends, and how far the joints are from holding there.
#pragma once

#include <pintle/rows/row.h>
#include <pintle/solver/joint_system.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class EndOfStep {
 public:
  /// Begins a step with this number of blocks.
  void begin(size_t blocks, const btAlignedObjectArray<btSolverBody>& bodies);
  /// The poses that Bullet integrates to from the velocities that the bodies have now.
  void predict(const btAlignedObjectArray<btSolverBody>& bodies, const btContactSolverInfo& info);

  /// `error`: of each row of each block, the change of velocity (m/s, rad/s) by which it holds at the end of the
  /// step, or corrects as much as a step should. For a limit, by which it ends where its row sends it. 0 for rows
  /// that are soft or do not hold a position.
  /// `largest`: of each component, the largest error times the step, m or rad, less the rounding of positions.
  void errors(const JointSystem& joints, const btConstraintArray& rows, std::vector<double>& error,
              std::vector<double>& largest);
  /// The largest error, m or rad, of rows that have turned since the start: the start's rows cannot correct them.
  double largestTurned() const { return m_largest_turned; }
  /// Sets the errors of those rows to zero.
  void clearTurned(std::vector<double>& error) const;
  /// Adds the joints' rows at the predicted poses, as rows of the bodies' velocities (byVelocity).
  void addEndRows(JointSystem& joints, const btConstraintArray& rows,
                  const btAlignedObjectArray<btSolverBody>& bodies);

 private:
  /// `far`: the joint starts further off than one step may close.
  void errors(const JointBlock& block, const btConstraintArray& rows, double* error, char& far,
              unsigned char& turned);
  const btTransform& pose(const btRigidBody& body, int solver_body) const {
    return solver_body < 0 ? body.getCenterOfMassTransform() : m_poses[size_t(solver_body)];
  }
  template <class Set>
  void endRows(const JointBlock& block, const btConstraintArray& rows, const Set& set);
  /// Whether a row of the end belongs to what the joint holds at the start: as the same row, or as a turned one.
  enum class Match { none, same, turned };
  static Match match(const Joint& joint, const Rows& end, int row);
  static Match match(const JointBlock& block, const btConstraintArray& rows, int r,
                     const btSolverConstraint& end);
  using Speeds = double[block_rows];
  /// The speeds that close all of each row's error at the given poses; of a limit, what its row is short of.
  void speeds(const JointBlock& block, const btConstraintArray& rows, const btTransform& pose_a,
              const btTransform& pose_b, Speeds& speed, Speeds& max_speed, unsigned char& turned);
  /// The number of the joint's rows before those of free coordinates; a stock joint does not tell these apart.
  static int equalities(const JointBlock& block);
  static Scalar ownersVelocity(const Joint& joint, const Row& row);
  /// The mean velocity over the step that a rigid limit's row is short of, if the step ends with the rows `end`.
  Scalar missing(const Joint& joint, int row, const Rows& end) const;

  RowMemory<max_joint_rows, max_joint_rows> m_memory;
  std::vector<btTransform> m_poses;
  std::vector<char> m_far;              ///< of each block
  std::vector<unsigned char> m_turned;  ///< of each block, a bit for each row
  double m_largest_turned = 0;
  Scalar m_dt = 0, m_erp = 0;
  double m_rounding = 0;  ///< of positions, m
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
