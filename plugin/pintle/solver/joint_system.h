// Purpose: the bilateral joint rows of an island as one linear system,
//   (J M^-1 J^T + Sigma) lambda = rhs - J v,  Sigma = gamma / dt (document, 2.12),
// written in velocities u that are scaled by the root of the mass, v = S u with S S^T = M^-1. Rows
// become J S, which is all that K and the effect of an impulse need.
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

/// dynamic_cast to Joint for constraints in turn. Its answer is kept while the type is that of the last one.
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
  const Joint* ours;  ///< the joint, if it is one of Pintle's; null: a stock one
  int rows;
  int row[block_rows];         ///< in Bullet's pool
  int index[block_rows];       ///< among the rows of the joint
  int body[2];                 ///< among Bullet's solver bodies; -1: does not move
  double J[2][6][block_rows];  ///< J S of each body, by coordinate: linear, then angular
  double rhs[block_rows];      ///< change of J v that the row asks for, before any impulse
  double rest
      [block_rows];  ///< the part of rhs that brings the row to rest: -J v; of a motor, all of rhs
  double softness[block_rows];  ///< Sigma
  double damping[block_rows];   ///< of corrections in a loop, whose rows may contradict each other
  double impulse[block_rows];   ///< lambda
  bool equality[block_rows];    ///< acts both ways, unbounded but for breaking
  bool holds[block_rows];       ///< is rigid, and to hold in position
  bool linear[block_rows];      ///< moves bodies, not only turns them
  int bound[block_rows];        ///< number of a row with bounds in Topology::at_bound; -1: none
  bool is_carried;              ///< by a body that its owner moves (kinematic)
  int angular_rows, linear_rows;  ///< of equalities
  int point[3];                   ///< three rows that hold a point in all directions; -1: none do
  double direction[3][3];         ///< of these, for body a
  double lever[2][3];             ///< from each body to the point, m
  double swing[2];                ///< of each body: lever / inertia, 1 / (kg m)
  /// The impulse of the point on body a, N s.
  Vector3d pointImpulse() const;
};

class JointSystem {
 public:
  /// Takes rows out of Bullet's pool, whose iteration then skips them: bilateral rows, rows within two-sided
  /// bounds (motors, friction), and with `limits` also rows that act one way. A row at its bound starts there and
  /// stays with Bullet, for `iterations`. Returns whether any row was taken.
  bool gather(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
              bool limits, int iterations);
  /// Whether no row of a joint is left to Bullet's iteration.
  bool all() const { return m_all; }
  /// K and its factor.
  void factorise();
  /// Adds the geometric stiffness of the present impulses to the inertia of each body that needs it. Returns
  /// whether K has changed; the joints must then be solved again.
  bool stiffen(Scalar dt);
  /// Whether a body swings too fast for a step to resolve. Its impulses then depend strongly on its stiffness.
  bool hasUnresolved() const;
  /// Writes the stiffened inertia into the rows that Bullet iterates, and applies their impulses so far to the
  /// bodies. `of_contacts`: cfm is a part of the rows' own K, as in contacts.
  void stiffenRows(btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows,
                   bool of_contacts) const;

  /// Bullet's changes of velocity, to u and back. read() returns whether there are any.
  bool read(const btAlignedObjectArray<btSolverBody>& bodies);
  void write(btAlignedObjectArray<btSolverBody>& bodies) const;
  void writeImpulses(btConstraintArray& rows) const;

  /// Solves all rows from the velocities of Bullet's bodies. Rows of a loop are brought to rest only.
  void begin(const btAlignedObjectArray<btSolverBody>& bodies);
  /// Solves the corrections of a loop, whose rows may contradict each other, by damped least squares. What they
  /// reach becomes their rhs.
  void solveLoopTargets();
  /// Solves all rows again, after others have changed the bodies' velocities.
  void solve();

  /// Between beginReactions and endReactions Bullet's iteration changes only the bodies of the given rows. The
  /// joints' own rows among them are over-relaxed.
  void beginReactions(const btAlignedObjectArray<btSolverBody>& bodies,
                      std::initializer_list<const btConstraintArray*> contacts,
                      btConstraintArray& rows);
  /// As solve(), but only for these bodies' velocities, and the joints on which they depend.
  void react(btAlignedObjectArray<btSolverBody>& bodies);
  /// Solves all joints, with the original rows.
  void endReactions(const btAlignedObjectArray<btSolverBody>& bodies, btConstraintArray& rows);

  /// Stiffened bodies take less angular momentum from their joints than true ones. Free components get the
  /// difference back as a turn of the whole.
  void restoreMomentum(const btAlignedObjectArray<btSolverBody>& bodies);
  /// Keeps the points' impulses: the next step predicts the geometric stiffness by them.
  void rememberPointImpulses();
  /// Warm start of stock joints' iterated rows.
  void rememberIteratedImpulses(const btConstraintArray& rows);
  /// Adds to the velocity and the rhs of each row of each block, m/s or rad/s. In a loop, by damped least squares.
  void correct(const std::vector<double>& change);

  /// As `correct`, for rows of the end of the step, by impulses along those of the start:
  /// (J_end M^-1 J^T + Sigma) lambda = change. After beginEndRows, and addEndRows for each block.
  void correctAtEnd(const std::vector<double>& change);
  void beginEndRows();
  using ScaledRows = double[2][6][block_rows];  ///< as JointBlock::J
  void addEndRows(size_t block, const ScaledRows& J);
  /// J S of a row.
  void scaleRow(const JointBlock& block, int r, const Vector3d (&linear)[2],
                const Vector3d (&angular)[2], ScaledRows& J) const;

  /// Saves velocities, impulses and rhs.
  void saveState();
  /// Returns the marked components to the saved state, but for `part` of the way from there.
  void restoreState(double part, const std::vector<char>& components);
  /// Kinetic energies of a component, J.
  struct Energy {
    double free = 0;  ///< before any impulse of the step
    double now = 0;
    double added = 0;        ///< of the impulses' velocity changes alone
    double unit = 0;         ///< at 1 m/s and 1 rad/s
    double work = 0;         ///< done by equalities' impulses
    double given = 0;        ///< by all impulses, with the velocities before the step's forces
    bool is_rigid = true;    ///< all rows are rigid, and no frame is moved by its owner
    double spin = 0;         ///< of the body that turns fastest, rad/s, before any impulse
    double spin_at_end = 0;  ///< the same with all impulses
  };
  void energies(const btAlignedObjectArray<btSolverBody>& bodies, std::vector<Energy>& each) const;
  /// Gives the rows of the marked components their first rhs again. They are to be solved.
  void undoCorrections(const btConstraintArray& rows, const std::vector<char>& components);
  /// Scales the corrections of the marked components to at most `speed` (m/s and rad/s), and removes all
  /// stiffening. The joints are to be solved again.
  void limitCorrectionSpeed(const std::vector<char>& components, const std::vector<double>& speed);
  /// Multiplies the velocities of each component by its factor, which may exceed 1. A free component keeps the
  /// velocity of its centre of mass. The joints are to be solved.
  void scaleVelocities(const btAlignedObjectArray<btSolverBody>& bodies,
                       const std::vector<double>& parts);
  /// Multiplies the impulses of each component, and their velocity changes, by its factor.
  void scaleImpulses(const std::vector<double>& parts);
  const Topology& topology() const { return *m_topology; }
  Topology& topology() { return *m_topology; }

  /// False if a velocity holds NaN or infinity.
  bool finite() const;
  /// The largest angular velocity before any impulse, rad/s.
  double spin() const { return std::sqrt(m_spin2); }
  /// Whether there are any rows with bounds in the system.
  bool bounded() const { return m_bounded; }
  /// Whether an iterated row has a warm start.
  bool loaded() const { return m_loaded; }
  /// Active set: marks rows that exceed their bounds for Bullet's iteration; if there are such and `all` is set, every
  /// row with bounds. A row that breaks its joint keeps the impulse of its bound. Returns whether any was marked:
  /// gather again.
  bool releaseSaturated(btConstraintArray& rows, bool all);
  /// Active set: marks iterated rows for the system if they are within their bounds, or would leave them by what
  /// the system has done since. Returns whether any was marked: gather again.
  bool reclaimUnsaturated(const btAlignedObjectArray<btSolverBody>& bodies,
                          const btConstraintArray& rows, Scalar dt);
  /// Calls the joints that have rows with bounds in the system, as Bullet's passes would.
  void report(btAlignedObjectArray<btSolverBody>& bodies, const btConstraintArray& rows,
              Scalar dt) const;
  /// Returns all rows to Bullet's iteration, without impulses.
  void releaseAll(btConstraintArray& rows, int iterations);

  const std::vector<JointBlock>& blocks() const { return m_blocks; }
  /// The largest correction that a row asks for at first, m/s or rad/s.
  double maxCorrectionSpeed() const { return m_max_correction_speed; }
  /// Bytes held.
  size_t bytes() const;

 private:
  struct Body {
    double linear[3];
    Matrix3d angular, inverse;  ///< S of the body, with its stiffening, and its inverse
    Vector3d v, w;              ///< before any impulse, m/s and rad/s
    double load = 0;            ///< a bound of (omega h)^2 of its swing under the joints' impulses
    double known_load = 0;      ///< load at which its stiffening was found last
    bool moves = false, has_locked_axes = false;  ///< by factors, as in two dimensions
  };
  /// Further state of each body, while one of them swings fast under its load.
  struct Swing {
    Matrix3d angular, inverse;  ///< S of the body alone, and its inverse
    Stiffening stiffening, next_stiffening;
    Matrix3d turn;       ///< from coordinates u with `stiffening` to those with `next_stiffening`
    bool turns = false;  ///< whether these differ
    Matrix3d stiffness;  ///< of the levers of its joints, N m s
    Vector3d omega;      ///< sum of its neighbours', rad/s
    int neighbours = 0;
    Vector3d kick = Vector3d::Zero();  ///< change of u towards its neighbours' turn
  };

  /// The fields of an over-relaxed row as they were.
  struct OverRelaxed {
    int row;
    Scalar inverse_K, rhs, cfm;
  };

  /// A component seen as one rigid body.
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
  /// rhs - Sigma lambda - J v
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
  /// Whether a body is stiffened whose swing has this (omega h)^2.
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
  std::vector<Gathered> m_gathered;  ///< in the order of Bullet's pool
  struct IteratedRow {
    int row, index;
  };
  std::vector<IteratedRow> m_iterated_rows;  ///< with bounds, left to Bullet
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
  std::vector<int> m_path;         ///< the same as a list: the blocks that a row's reaction needs
  std::vector<OverRelaxed> m_over_relaxed;  ///< between beginReactions and endReactions
  std::vector<double> m_unreacted;          ///< 6 a touched body: u without the joints' reactions
  std::vector<double> m_change;             ///< 6 a body: of u, by Bullet's last iteration
  BlockFactor m_factor;
  BlockFactor m_damped;                         ///< of loops, with `damping`; made on demand
  BlockLU m_end_factor;                         ///< J_end M^-1 J^T; made on demand
  std::vector<double> m_max_correction_speeds;  ///< of each component
  double m_max_correction_speed = 0, m_spin2 = 0;
  bool m_loops = false;            ///< whether rows may depend on each other
  bool m_has_locked_axes = false;  ///< whether bodies have factors, as in two dimensions
  bool m_all = true, m_loaded = false, m_bounded = false, m_damped_is_factor = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
