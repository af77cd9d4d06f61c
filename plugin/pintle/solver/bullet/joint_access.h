// Purpose: what a solver asks a joint for beside its rows, and what it tells it of a step.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/rows/axis_part.h>
#include <pintle/rows/row.h>

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <typeinfo>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct GearRow;

struct JointAccess {
  /// The joint, if the constraint is one of Pintle's.
  static Joint* ours(btTypedConstraint& constraint) {
    const std::ptrdiff_t place = known(constraint).place;
    return place != 0 ? reinterpret_cast<Joint*>(reinterpret_cast<char*>(&constraint) + place)
                      : nullptr;
  }
  /// True for a client's type, derived from one of Pintle's, that may answer otherwise than its base.
  static bool mayHaveOtherRows(btTypedConstraint& constraint) { return !known(constraint).is_own; }

  /// Its rows at the start of a step, in its own memory.
  static const RowList& begin(Joint& joint, const BodyPair& pair, Scalar dt, RowShape* shapes) {
    joint.beginStep();
    joint.m_time_step = dt;
    joint.m_rows.clear();
    Rows rows(joint.m_rows, shapes);
    if (pair.finite()) joint.prepare(pair, rows);
    joint.m_rows = rows;
    joint.m_bullet_rows.setCount(1);
    return joint.m_rows;
  }
  /// True if `joint`, which stands for this constraint, is a GearModel: its row is of another kind than those of other joints.
  static bool isGear(btTypedConstraint& constraint, const Joint& joint) {
    return known(constraint).is_gear && &joint.constraint() == &constraint;
  }
  /// Its row at the start of a step, null if there is none.
  static const GearRow* beginGear(Joint& joint, Scalar dt);
  /// How many of the settings that stand in the constraint of Bullet's are not used.
  static int ignoredSettings(Joint& joint);
  ///@{
  /// As its class has them, whatever a client's makes of that.
  static void announceRows(Joint& joint, Joint::Info1& info) { joint.announceRows(info); }
  static void writeRows(Joint& joint, Joint::Info2& info) { joint.writeRows(info); }
  ///@}
  /// Of its memory.
  static const Row& firstRow(const Joint& joint) { return joint.m_rows[0]; }
  /// While it lives, Bullet's rows of the joint are those of addRows: none is made orthogonal to others, none predicts by how much its
  /// motion is curved, and what closes it grows with the rate of the steps, without a largest speed.
  class PlainRows {
   public:
    explicit PlainRows(Joint& joint) : m_joint(joint), m_before(joint.m_bullet_rows.arePlain()) {
      joint.m_bullet_rows.setPlain(true);
    }
    ~PlainRows() { m_joint.m_bullet_rows.setPlain(m_before); }
    PlainRows(const PlainRows&) = delete;
    PlainRows& operator=(const PlainRows&) = delete;

   private:
    Joint& m_joint;
    const bool m_before;
  };
  /// Begins the joint's step, and keeps what it remembers of its axes, which getInfo2 changes: restored at the end of its life, and
  /// before that when asked.
  class KeptAxes {
   public:
    explicit KeptAxes(Joint& joint)
        : m_rows(joint.m_rows), m_count(std::min(m_rows.axisCount(), max_joint_rows)) {
      joint.beginStep();
      for (int i = 0; i < m_count; ++i) m_axes[size_t(i)] = m_rows.axis(i);
    }
    ~KeptAxes() { restore(); }
    KeptAxes(const KeptAxes&) = delete;
    KeptAxes& operator=(const KeptAxes&) = delete;
    void restore() const {
      const int count = std::min(m_count, m_rows.axisCount());  // setters may take other memory
      for (int i = 0; i < count; ++i) m_rows.axis(i) = m_axes[size_t(i)];
    }

   private:
    RowList& m_rows;
    const int m_count;
    std::array<AxisState, max_joint_rows> m_axes;
  };
  static ImpulseSetting setting(const Joint& joint) { return joint.impulseSetting(); }

  /// ERP and CFM of a group of its equalities.
  struct Softness {
    Scalar erp, cfm;
    bool own_erp;  ///< set by the user
  };
  static Softness softness(const Joint& joint, int group, const btContactSolverInfo& info) {
    if (joint.m_erp_cfm_differs) {
      const ErpCfm& of = joint.groups()[group];
      return {of.factor * of.erp.orElse(info.m_erp), of.cfm.orElse(info.m_globalCfm),
              of.erp.isSet()};
    }
    return {joint.m_erp.orElse(info.m_erp), joint.m_cfm.orElse(info.m_globalCfm),
            joint.m_erp.isSet()};
  }

  /// K of a limit's spring, of which it has its stiffness: `now`, or while it presses that with which it began. A stiffness that changed
  /// with the poses of bodies would work by that alone.
  static double keptK(AxisState& state, double now) {
    if (state.impulse[Axis::limit] == 0 || !(state.K > 0)) state.K = Scalar(now);
    return double(state.K);
  }
  static AxisState& axis(Joint& joint, const Row& row) { return joint.m_rows.axis(row.axis); }
  /// What its axis is asked in this step. `velocity`: of the coordinate, its mean over the step.
  static AxisMotion motion(Joint& joint, const Row& row, const AxisState& state,
                           const BodyPair& pair, Scalar velocity, const btContactSolverInfo& info) {
    AxisMotion motion =
        joint.axisMotion(row, state, pair, 1 / info.m_timeStep, joint.m_erp.orElse(info.m_erp));
    motion.gain = 0;
    motion.velocity = velocity;
    return motion;
  }

 private:
  struct Known {
    const std::type_info* type = nullptr;
    std::ptrdiff_t place = 0;  ///< of the Joint in each object of the type; 0: none
    bool is_own = false;       ///< a type of Pintle's, which asks for nothing but its rows
    bool is_gear = false;      ///< one of Pintle's gears, or Bullet's, for which one of Pintle's stands
  };
  // To look this up takes as long as some of a joint's rows: so a type is looked up once.
  static const Known& known(btTypedConstraint& constraint) {
    thread_local std::array<Known, 16> all;
    const std::type_info& type = typeid(constraint);
    Known& known = all[reinterpret_cast<std::uintptr_t>(&type) / 16 % all.size()];
    if (known.type != &type) known = find(constraint);
    return known;
  }
  static Known find(btTypedConstraint& constraint);
};

// Joints of clients, derived from Pintle's, that answer what Bullet asks a joint for otherwise than their bases do.

/// Rows of a joint that answers as Bullet's do: btGeneric6DofSpring2Constraint has the most, four an axis.
constexpr int most_stock_rows = 24;

/// Rows of a joint in this step, as its virtual methods give them.
struct ClientRows {
  int of_base;        ///< so many come first that are those of its base, unchanged
  bool adds_rows;     ///< others come after them
  bool changes_base;  ///< of the base's rows some are others, or missing
};

/// Asks the joint once, as Bullet does. Leaves what it remembers of its axes as it was.
ClientRows findClientRows(Joint& joint, const btContactSolverInfo& info);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
