// Purpose: solves the joints and the contacts of an island. Bullet's solvers hand it their bodies and rows (joint_solver.h).
#pragma once

#include <pintle/solver/bullet/island_builder.h>
#include <pintle/solver/cache/world_memory.h>
#include <pintle/solver/model/contact_groups.h>
#include <pintle/solver/solve/chord.h>
#include <pintle/solver/solve/contact_poses.h>
#include <pintle/solver/solve/end_velocities.h>
#include <pintle/solver/solve/passes.h>
#include <pintle/solver/solve/projection.h>
#include <pintle/solver/solver_options.h>

#include <functional>

namespace pintle {
inline namespace PINTLE_PRECISION {

class IslandStep {
 public:
  size_t bytes() const;
  void setOptions(const SolverOptions& options) { m_options = options; }
  const SolverOptions& options() const { return m_options; }

  // For each island, in this order:
  void begin(const btContactSolverInfo& info);
  /// A joint, with the one of Pintle's that stands for it, or null, and the numbers of its bodies among Bullet's.
  void addJoint(btTypedConstraint& joint, Joint* upgraded, const SolverBodies& bodies, int body_a,
                int body_b) {
    m_builder.add(joint, upgraded, bodies, body_a, body_b);
  }
  /// After the last one. Returns whether there are any that hold a body.
  bool endJoints();
  /// Contacts, or friction, which is bounded by the contacts and comes after them.
  void addContacts(btConstraintArray& rows, const SolverBodies& bodies, bool are_friction);
  /// One pass over rows of other kinds on Bullet's bodies, whose velocities it changes.
  using PassOverOthers = std::function<void(int number)>;
  /// Bodies get their velocities and contacts their impulses. With others, as many passes as the world has iterations, and joints and
  /// contacts after each: so they hold in the end. `memory`: that of the world.
  void solve(const btContactSolverInfo& info, SolverBodies& bodies, const PassOverOthers& others,
             WorldMemory& memory);
  /// Bodies without joints, where steps are of second order.
  void moveFreely(SolverBodies& bodies, WorldMemory& memory);
  /// At the end of the step, what velocities cannot do.
  void movePoses() const;

 private:
  void beginComponents(WorldMemory& memory);
  void solveInTurns(SolverBodies& bodies, const PassOverOthers& others);
  void solveJoints();
  bool breakOverloaded();
  void finishComponents(const SolverBodies& bodies);
  void leaveOverflows(const SolverBodies& bodies);
  void leaveOverflow(const ContactGroup& group, const SolverBodies& bodies);
  void holdJoints(std::vector<Vector6d>& velocities);
  void followPoses();
  Span<const int> bodiesOf(const Component& component);

  ComponentMemory& begin(const Component& component);
  void solveAlone(const Component& component);
  bool solveInHalves(const Component& component);
  bool solveByChord(const Component& component);
  void solveInVelocity(const ContactGroup& group);
  double gainInVelocity(const ContactGroup& group);
  void finish(const Component& component, ComponentMemory& kept);
  void report(const Component& component, ComponentMemory& kept);
  void gatherVelocities(const Component& component);
  void writeVelocities(SolverBodies& bodies) const;
  void writeVelocitiesForOthers(SolverBodies& bodies) const;
  ComponentMemory& memoryOf(const Component& component) const {
    return *m_kept[size_t(&component - m_components.data())];
  }

  SolverOptions m_options;
  StepReport m_report;  ///< of this island
  Island m_island;
  IslandBuilder m_builder{m_island, m_options};
  std::vector<Component> m_components;
  std::vector<ComponentMemory*> m_kept;  ///< of each
  std::vector<ContactRow> m_contacts;
  int m_sweeps = 0;                    ///< of contacts
  bool m_has_others = false;           ///< rows of other kinds act on its bodies
  double m_turn_share = 0;             ///< of the turns by which split impulses move bodies apart
  std::vector<Vector6d> m_velocities;  ///< of each body
  std::vector<PoseChange> m_pose_changes;
  bool m_are_pushed = false;  ///< bodies, by contacts

  // Memory of the solve.
  std::vector<Vector6d> m_before_others;  ///< of each body: its change of velocity
  std::vector<int> m_bodies_alone;        ///< of a component
  std::vector<char> m_counted;            ///< of each body
  ContactGroups m_groups;
  std::vector<BlockOfJoints> m_blocks;
  // A body without joints.
  HalfForces m_free_forces;
  std::vector<MovedBody> m_free_moved;
  std::vector<Vector6d> m_free_velocity;
  PassMemory m_pass_memory;
  ContactPosesMemory m_poses_memory;
  ChordMemory m_chord_memory;
  EndMemory m_end_memory;
  ProjectionMemory m_projection_memory;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
