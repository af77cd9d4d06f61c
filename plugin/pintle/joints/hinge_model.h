// Purpose: the settings of a hinge, its angle, and how both follow from a hinge of Bullet's. The rows that keep the axes together
// are those of its subclasses.
#pragma once

#include <pintle/bullet/stock_hinge.h>
#include <pintle/joints/joint.h>
#include <pintle/rows/unwrapped_angle.h>

#include <LinearMath/btTransform.h>

namespace pintle {
namespace equations {
template <class T>
struct Anchors;
template <class T>
struct Swing;
}  // namespace equations

inline namespace PINTLE_PRECISION {

struct Acting;
class Complaints;

/// Axes of the joint frames: z, and y, by which Bullet measures the angle.
constexpr int hinge_axis = 2, measured_axis = 1;

/// Settings of a hinge.
struct HingeSettings {
  btTransform frame_a;        ///< the joint frame in body a's frame (m), z the hinge axis
  btTransform frame_b;        ///< the same in body b's
  Axis axis;                  ///< along the hinge angle
  bool angular_only = false;  ///< no position rows
};

/// A hinge of Bullet's as Pintle holds it. What stands in Bullet's object is read at the start of each step; what Bullet does not
/// have (limits of more than a turn, springs, servos, friction) is kept here.
class HingeModel : public Joint {
 public:
  /// The rows are solved as a block: Bullet's setUseFrameOffset, which stands for the same.
  void setBlockRows(bool block) override;
  bool getBlockRows() const override;
  /// The frames, and the range of the angle about the axis of b.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  friend class HingeBase;

  /// The accumulated angle of the one class is kept up to date, too.
  HingeModel(btHingeConstraint& hinge, RowCount max_rows);
  HingeModel(btHingeAccumulatedAngleConstraint& hinge, RowCount max_rows);

  static int rowsOfStock(const btHingeConstraint& hinge) { return writtenRows(hinge); }
  void hideLimits() { showLimit(hinge(), 0, 0); }

  // For the rows of the hinges: hinge_rows.h, inline.
  struct Observation;
  Observation observe(const PosePair& poses) const;
  void remember(const Observation& seen, bool in_step);
  Acting acting(const Observation& seen, const equations::Swing<Scalar>& swing,
                const Rows& rows) const;
  void addPivotRows(const equations::Anchors<Scalar>& at, Rows& rows) const;
  void addAxisRow(const Acting& acting, const equations::Swing<Scalar>& swing, Rows& rows) const;

  /// The limit or its spring was set.
  virtual void limitChanged() {}

  HingeSettings m_settings;
  UnwrappedAngle m_twist;  ///< of b against a, about z
  Scalar m_sign;           ///< hinge angle = sign * twist

 private:
  btHingeConstraint& hinge() const;
  Scalar angle() const { return m_sign * m_twist.value(); }
  void read(Complaints* complaints) override;
  void readLimit(const StockHinge& from, Complaints* complaints);
  void framesChanged();
  /// A limit by Pintle's own methods, which Bullet's object shows as far as it can.
  void keepLimit(Scalar low, Scalar high, bool of_any_turn);
  void limitSet(const Axis& before);
  /// True while the limit of Bullet's object is the one that keepLimit left there.
  bool hasOwnLimit() const { return m_own_limit && limitOf(hinge()) == m_read_limit; }
  ///@{
  /// Leaves in Bullet's object what a step of its own would, and what its testLimit does.
  void showAngle(bool axes_are_apart);
  void showLimitAt(const UnwrappedAngle& twist, Scalar last_impulse = 0);
  ///@}

  btScalar* m_accumulated = nullptr;  ///< Bullet's accumulated angle
  StockLimit m_read_limit;
  StockMotor m_read_motor;
  bool m_own_limit = false;
  bool m_turn_given = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
