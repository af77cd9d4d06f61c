// Purpose: from Bullet's bodies and joints to an Island: called once a step.
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/contacts.h>
#include <pintle/solver/model/island.h>
#include <pintle/solver/solver_options.h>

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <LinearMath/btAlignedObjectArray.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using SolverBodies = btAlignedObjectArray<btSolverBody>;

class IslandBuilder {
 public:
  IslandBuilder(Island& island, const SolverOptions& options)
      : m_island(island), m_options(options) {}

  void begin(const btContactSolverInfo& info);
  /// A joint, with the one of Pintle's that stands for it, or null, and the numbers of its bodies among Bullet's. Bodies that do not
  /// move are left out.
  void add(btTypedConstraint& joint, Joint* upgraded, const SolverBodies& bodies, int solver_body_a,
           int solver_body_b);
  /// Sorts all by components.
  void finish(std::vector<Component>& components);
  /// Thereafter: Bullet's contacts, or friction, which is bounded by the contacts and comes after them.
  void addContacts(btConstraintArray& rows, const SolverBodies& bodies, bool are_friction,
                   std::vector<ContactRow>& to);
  /// The number of one of Bullet's bodies in the island, added if it is not there yet; below 0: it does not move.
  int body(const SolverBodies& bodies, int solver_body);
  size_t bytes() const {
    return bytesOf(m_body_of, m_springs, m_root, m_number, m_to, m_joints_to, m_sorted_bodies,
                   m_sorted_joints);
  }

 private:
  /// `rate`: of its equalities (EqualityState).
  void addOurs(IslandJoint& to, double rate = 0);
  /// What equalities of one group of a joint have in common.
  struct EqualitySettings {
    int group;
    double erp, cfm, bound;
    double left;  ///< what damping leaves of the velocity that forces lead to
  };
  EqualitySettings settingsOf(const Joint& joint, int group) const;
  /// The C of an equality (m or rad), which is to be closed at no more than max_speed, while it changes by what is no body of
  /// its joint.
  struct EqualityState {
    double position, max_speed, rate = 0;
  };
  void setEqualityLaw(const IslandJoint& of, const EqualitySettings& settings,
                      const EqualityState& state, IslandRow& row) const;
  void setAxisLaw(const IslandJoint& of, const BodyPair& pair, IslandRow& row) const;
  void addLimit(const IslandJoint& of, const Axis& axis, const AxisMotion& motion, AxisState& state,
                IslandRow& row) const;
  /// A gear of Pintle's. A row whose forces are not equal and opposite is known at the start of the step alone.
  void addGear(IslandJoint& to);
  struct StockRows;
  /// Asks a joint for its rows by its virtual methods, as Bullet does.
  void askStock(btTypedConstraint& joint, const btSolverBody& a, const btSolverBody& b,
                StockRows& to) const;
  /// Those from `first` on.
  void addStock(IslandJoint& to, const StockRows& rows, int first);
  /// A joint of a type that is derived from one of ours.
  void addClients(IslandJoint& to, const btSolverBody& a, const btSolverBody& b);
  /// A row of the joint, which is to be filled, and then kept or not.
  IslandRow& newRow() { return m_island.rows.emplace_back(); }
  /// Whether it is a row: then it counts.
  bool keepRow(IslandJoint& to, IslandRow& row);
  void findShapes(const IslandJoint& joint);
  bool isClosed(const IslandRow& row) const;
  void findAngles(const IslandJoint& joint);
  void findTurns(const IslandJoint& joint);
  double velocityAlong(const IslandJoint& of, const RowJacobian& J, Vector6d IslandBody::*v) const;
  /// J M^-1 J^T, when the equalities of the joint hold.
  double inverseMassBeside(const IslandJoint& joint, const RowJacobian& J) const;
  /// Springs that a step resolves pull by where it starts, others by where it ends, too.
  void foreseeSprings();
  /// The number of a body that only its owner moves.
  int unmoved(const btSolverBody& from);

  /// m or rad: how much of an error a step closes.
  double closing(double erp, double error, double max_speed) const;

  Island& m_island;
  const SolverOptions& m_options;
  btContactSolverInfo m_info;
  std::vector<int> m_body_of;                     ///< of Bullet's bodies
  std::array<RowShape, max_joint_rows> m_shapes;  ///< of the rows of a joint
  bool m_has_springs = false;
  // Memory of `finish`.
  std::vector<double> m_springs;            ///< of each body
  std::vector<int> m_root, m_number, m_to;  ///< of each body
  std::vector<int> m_joints_to;             ///< of each joint
  std::vector<IslandBody> m_sorted_bodies;
  std::vector<IslandJoint> m_sorted_joints;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
