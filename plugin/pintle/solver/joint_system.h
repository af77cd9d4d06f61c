// Purpose: the bilateral joint rows of an island as one linear system,
//   (J M^-1 J^T + Sigma) lambda = deficit - J v,  Sigma = gamma / dt (document, 2.12),
// written in velocities u that are scaled by the root of the mass, v = S u with S S^T = M^-1: rows
// become J S, and both K and what an impulse does to the bodies are made of these alone.
#pragma once

#include <pintle/solver/block_factor.h>
#include <pintle/solver/block_lu.h>
#include <pintle/solver/geometric_stiffness.h>
#include <pintle/solver/topology.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <cmath>
#include <initializer_list>
#include <typeinfo>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Joint;

/// dynamic_cast to a joint of Pintle's of one after the other, most of them of the type of the one before.
class AsJoint {
 public:
  Joint* operator()(btTypedConstraint* constraint);

 private:
  const std::type_info* m_last = nullptr;
  bool m_is_joint = false;
};

/// The rows of a joint, or some of them, that the system holds: one block of K.
struct JointBlock {
  btTypedConstraint* joint;
  const Joint* ours;  ///< the same as a joint of Pintle's; null: a stock one
  int rows;
  int row[block_rows];         ///< in Bullet's pool
  int index[block_rows];       ///< among the rows of the joint
  int body[2];                 ///< among Bullet's solver bodies; -1: does not move
  double J[2][6][block_rows];  ///< J S of each body, by coordinate: linear, then angular
  double rhs[block_rows];      ///< what J v lacks before any impulse
  double rest
      [block_rows];  ///< the part of it that brings the row to rest: -J v; of a motor, all of it
  double softness[block_rows];    ///< Sigma
  double damping[block_rows];     ///< of what rows of a loop may be unable to do together
  double impulse[block_rows];     ///< lambda
  bool equality[block_rows];      ///< acts both ways, with no bounds but those of breaking
  bool holds[block_rows];         ///< is rigid, and to hold in position
  bool linear[block_rows];        ///< moves bodies, not only turns them
  int bound[block_rows];          ///< by which a row with bounds is known again; -1: it has none
  bool is_carried;                ///< by a body that its owner moves
  int angular_rows, linear_rows;  ///< of equalities
  int point[3];                   ///< three rows that hold a point in all directions; -1: none do
  double direction[3][3];         ///< of these, for body a
  double lever[2][3];             ///< from each body to the point, m
  double swing[2];  ///< how easily each body swings under a load of it: lever / inertia, 1 / (kg m)
  /// The impulse of the point on body a, N s.
  Vector3d pointImpulse() const;
};

class JointSystem {
 public:
  /// Takes the bilateral rows out of Bullet's, whose iteration passes them over from then on, and with them
  /// those whose bounds let them act both ways (motors, friction), as long as they are within; with
  /// `limits`, those that act one way, too. What is at a bound begins there, and has these iterations.
  /// Returns whether there are any rows.
  bool gather(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
              bool limits, int iterations);
  /// Whether they are all the joints' rows that there are.
  bool all() const { return m_all; }
  /// K and its factor.
  void factorise();
  /// Adds the geometric stiffness of the impulses that the joints have now to the inertia of each body
  /// that needs it. Returns whether it has changed: then K is another one, and the joints are to be
  /// solved anew.
  bool stiffen(Scalar dt);
  /// Whether a body swings so fast that next to nothing of it is left in a step: how stiff it is then
  /// changes the impulses by much.
  bool hasUnresolved() const;
  /// Writes the inertia that the bodies have now into rows that Bullet iterates, and makes what these
  /// have done so far the change of the bodies' velocities. `of_contacts`: whether cfm counts in the
  /// rows' own K, as it does in contacts.
  void stiffenRows(btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
                   bool of_contacts) const;

  /// Bullet's changes of velocity, to u and back. Whether there are any.
  bool read(const btAlignedObjectArray<btSolverBody>& bodies);
  void write(btAlignedObjectArray<btSolverBody>& bodies) const;
  void writeImpulses(btConstraintArray& rows) const;

  /// All rows meet their targets, from the velocities that Bullet's bodies have; in a loop, they come
  /// to rest.
  void begin(const btAlignedObjectArray<btSolverBody>& bodies);
  /// The rows of a loop meet their targets as far as they can do together. These are their targets from
  /// now on.
  void solveLoopTargets();
  /// All rows are brought back to their targets, whatever others did to the bodies.
  void solve();

  /// Between these two, Bullet's iteration changes the velocities of some bodies only: those of the
  /// rows it is told of. Of those that are joints' it makes larger steps.
  void beginReactions(const btAlignedObjectArray<btSolverBody>& bodies,
                      std::initializer_list<const btConstraintArray*> contacts,
                      btConstraintArray& rows);
  /// Reads the velocities of these bodies, and writes them as the joints make them: as solve() would,
  /// but that only the joints which these velocities depend on are solved.
  void react(btAlignedObjectArray<btSolverBody>& bodies);
  /// Solves all joints for what they have reacted to, and for what has come since.
  void endReactions(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows);

  /// Bodies that are stiffer than they are take less angular momentum from their joints than these have to
  /// give. What nothing else holds gets it back, turning as a whole.
  void restoreMomentum(const btAlignedObjectArray<btSolverBody>& bodies);
  /// Impulses are those with which the next step begins to tell how stiff the bodies are.
  void rememberPointImpulses();
  /// Rows that have been iterated begin with these impulses in the next step.
  void rememberIteratedImpulses(const btConstraintArray& rows);
  /// Changes the velocity along each row of each block, and its target: m/s or rad/s. What rows of a
  /// loop cannot do together is left undone.
  void correct(const std::vector<double>& change);

  /// As `correct`, but that the change is of rows as they are at the end of the step, by impulses along those of
  /// the start: (J_end M^-1 J^T + Sigma) lambda = change. Since `beginEndRows` those of all blocks have been added.
  void correctAtEnd(const std::vector<double>& change);
  void beginEndRows();
  using ScaledRows = double[2][6][block_rows];  ///< as JointBlock::J
  void addEndRows(size_t block, const ScaledRows& J);
  /// J S of a row.
  void scaleRow(const JointBlock& block, int r, const Vector3d (&linear)[2],
                const Vector3d (&angular)[2], ScaledRows& J) const;

  /// Keeps velocities, impulses and targets, to come back to.
  void saveState();
  /// Goes back, in the components that are marked, from what there is now to what was kept, but for
  /// `part` of the way.
  void restoreState(double part, const std::vector<char>& components);
  /// Kinetic energies of a component, J.
  struct Energy {
    double free = 0;  ///< before any impulse of the step
    double now = 0;
    double added = 0;        ///< what the changes by impulses have alone
    double unit = 0;         ///< at 1 m/s and 1 rad/s
    double work = 0;         ///< of the impulses of equalities
    double given = 0;        ///< of all impulses, from the velocities before the step's forces on
    bool is_rigid = true;    ///< all rows are those of rigid joints, to frames that stand
    double spin = 0;         ///< of the body that turns fastest, rad/s, before any impulse
    double spin_at_end = 0;  ///< the same with all impulses
  };
  void energies(const btAlignedObjectArray<btSolverBody>& bodies, std::vector<Energy>& each) const;
  /// The rows of the marked components are to be solved with the targets that they came with.
  void undoCorrections(const btConstraintArray& rows, const std::vector<char>& components);
  /// The rows of the marked components are to correct no more than `speed` (m/s and rad/s), and no body is
  /// stiffened. The joints are to be solved anew.
  void limitCorrectionSpeed(const std::vector<char>& components, const std::vector<double>& speed);
  /// Leaves this part of the velocities of each component, which may be more than all; of one that is held by
  /// nothing, of those about its centre of mass. The joints are to be solved.
  void scaleVelocities(const btAlignedObjectArray<btSolverBody>& bodies,
                       const std::vector<double>& parts);
  /// Leaves this part of what impulses have done to each component.
  void scaleImpulses(const std::vector<double>& parts);
  const Topology& topology() const { return *m_topology; }
  Topology& topology() { return *m_topology; }

  /// False if a velocity holds NaN or infinity.
  bool finite() const;
  /// The largest angular velocity before any impulse, rad/s.
  double spin() const { return std::sqrt(m_spin2); }
  /// Whether there are any rows with bounds in the system.
  bool bounded() const { return m_bounded; }
  /// Whether rows begin with an impulse, that of a bound.
  bool loaded() const { return m_loaded; }
  /// Gives those rows back to Bullet's iteration that are beyond their bounds now; with `all`, the others that
  /// have any, too. What breaks a joint keeps the impulse of its bound. Returns whether there were such: gather anew.
  bool releaseSaturated(btConstraintArray& rows, bool all);
  /// Rows that Bullet has iterated and that are within their bounds, or that what the system has done since
  /// then would draw off them, are the system's when it gathers next. Returns whether there were such.
  bool reclaimUnsaturated(const btAlignedObjectArray<btSolverBody>& bodies,
                          const btConstraintArray& rows, Scalar dt);
  /// Tells joints that have rows with bounds in the system what became of them.
  void report(btAlignedObjectArray<btSolverBody>& bodies, const btConstraintArray& rows,
              Scalar dt) const;
  /// Leaves the rows to Bullet's iteration, as if they had never been taken.
  void releaseAll(btConstraintArray& rows, int iterations);

  const std::vector<JointBlock>& blocks() const { return m_blocks; }
  /// The largest velocity that a row is to have at its target, m/s or rad/s.
  double maxCorrectionSpeed() const { return m_max_correction_speed; }
  /// Bytes held, of which an island needs its share.
  size_t bytes() const;

 private:
  struct Body {
    double linear[3];
    Matrix3d angular, inverse;  ///< S of the body, with its stiffening, and its inverse
    Vector3d v, w;              ///< before any impulse, m/s and rad/s
    double load = 0;            ///< more than (omega h)^2 of its swing under the joints' impulses
    double known_load = 0;      ///< with which its stiffening was looked at last
    bool moves = false, has_locked_axes = false;  ///< by factors, as in two dimensions
  };
  /// What a body has besides where one of them bears a load under which it swings fast.
  struct Swing {
    Matrix3d angular, inverse;  ///< S of the body alone, and its inverse
    Stiffening stiffening, next_stiffening;
    Matrix3d turn;       ///< from the coordinates u with the one to those with the next
    bool turns = false;  ///< whether these differ
    Matrix3d stiffness;  ///< of the levers of its joints, N m s
    Vector3d omega;      ///< sum of its neighbours', rad/s
    int neighbours = 0;
    Vector3d kick = Vector3d::Zero();  ///< towards them, of u
  };

  /// A row of Bullet's as it was.
  struct OverRelaxed {
    int row;
    Scalar inverse_K, rhs, cfm;
  };

  /// A component as one rigid body.
  struct RigidComponent {
    double mass = 0;
    Vector3d centre = Vector3d::Zero();    ///< times the mass, at first
    Matrix3d inertia = Matrix3d::Zero();   ///< about the centre
    Vector3d lost = Vector3d::Zero();      ///< angular momentum
    Vector3d velocity = Vector3d::Zero();  ///< of the centre; times the mass, at first
    bool held = false;
  };

  int gatherBilateral(const btConstraintArray& rows, int first, AsJoint& as_joint);
  void scale(Body& body, const btSolverBody& of) const;
  static void scaleRow(const Body& body, const Vector3d& L, const Vector3d& A, double (&j)[6]);
  bool dependsOnItself();
  void addMinNormSoftness();
  bool loops() const { return m_loops; }
  /// What the row lacks now.
  BlockColumn residual(const JointBlock& block) const;
  /// J u
  BlockColumn velocity(const JointBlock& block) const;
  /// Applies the impulses that change the velocities of each block's rows by `change(block)`.
  template <class Factor, class Change>
  void apply(const Factor& factor, const Change& change);
  template <class Change>
  void applyDamped(const Change& change);
  void changeInertia();
  static void findPoint(JointBlock& block, const btConstraintArray& rows);
  void addLoads(double dt);
  /// Whether a body of this (omega h)^2 of its swing is stiffened.
  bool isStiff(double swing, size_t body) const;
  bool loadsChanged() const;
  void addLevers();
  void beginSwings();
  void addNeighbours();
  void touch(const btConstraintArray& rows, bool of_contacts);
  void clearLists();
  void listJoint(int block);
  template <class Function>
  void eachJoint(int body, const Function& f) const;
  double reactingK(const btSolverConstraint& row);
  void overRelax(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows);
  void warmStart(btSolverConstraint& row, int index, AsJoint& as_joint) const;
  void recallPointImpulse(JointBlock& block, size_t c) const;
  void readTouched(const btAlignedObjectArray<btSolverBody>& bodies);
  void readBody(int body, const btSolverBody& from, double* u) const;
  void writeBody(int body, btSolverBody& to) const;
  void setRows(JointBlock& block, btConstraintArray& rows);
  static void clearRow(JointBlock& block, int r);
  bool leaveToBullet(const btAlignedObjectArray<btSolverBody>& bodies, btSolverConstraint& row);

  Topologies m_topologies;
  Topology* m_topology = nullptr;
  struct Gathered {
    btTypedConstraint* joint;
    const Joint* ours;
    int rows, bilateral;
    int row[Topology::joint_rows], index[Topology::joint_rows], bound[Topology::joint_rows];
  };
  std::vector<Gathered> m_gathered;  ///< as they come
  struct IteratedRow {
    int row, index;
  };
  std::vector<IteratedRow> m_iterated_rows;  ///< rows with bounds that are none of the system's
  std::vector<JointBlock> m_blocks;          ///< in the order of elimination
  std::vector<Topology::Joint> m_joints;
  std::vector<int> m_rows;  ///< of each block
  std::vector<Body> m_bodies;
  std::vector<Swing> m_swings;  ///< of each body; empty as long as none is loaded
  std::vector<RigidComponent> m_rigid_components;
  std::vector<double> m_u;  ///< 6 a body
  std::vector<double> m_x;  ///< block_rows a block
  std::vector<double> m_saved_u, m_saved_rows;
  std::vector<char> m_is_touched, m_reacts;  ///< of bodies, and of blocks
  std::vector<int> m_touched, m_reacting;    ///< the same as lists
  std::vector<int> m_first_reacting;         ///< those that hold a touched body
  std::vector<int> m_first_of;     ///< of each body, 2 * block + side of a listed joint of it
  std::vector<int> m_next_of;      ///< of each such number, the next of the same body
  std::vector<char> m_is_on_path;  ///< of each block
  std::vector<int> m_path;         ///< the same as a list: what a row's reaction takes
  std::vector<OverRelaxed> m_over_relaxed;  ///< between beginReactions and endReactions
  std::vector<double> m_unreacted;          ///< 6 a touched body: u without the joints' reactions
  std::vector<double> m_change;             ///< 6 a body: of u, by Bullet's last iteration
  BlockFactor m_factor;
  BlockFactor m_damped;  ///< of loops: for what need not be consistent; made when it is asked for
  BlockLU m_end_factor;  ///< of the end's rows by the start's; made when it is asked for
  std::vector<double> m_max_correction_speeds;  ///< of each component
  double m_max_correction_speed = 0, m_spin2 = 0;
  bool m_loops = false;            ///< whether rows may depend on each other
  bool m_has_locked_axes = false;  ///< whether bodies have factors, as in two dimensions
  bool m_all = true, m_loaded = false, m_bounded = false, m_damped_is_factor = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
