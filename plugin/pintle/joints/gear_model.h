// Purpose: what a gear of Bullet's holds: not the rates of two rotations alone, but a sum of two coordinates.
#pragma once

#include <pintle/joints/joint.h>

#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints;
class GearCoordinate;
class GearSide;
struct GearRow;

/// A gear of Bullet's as Pintle holds it. Axes and ratio stand in Bullet's object, which is read at the start of each step; what is
/// counted is kept here. Its row is a kind of its own: forces along it need not be equal and opposite, as bearings take the difference.
/// So it is neither solved as a block nor in addRows, unless they are.
class GearModel : public Joint {
 public:
  static constexpr RowCount row_count{1};  ///< the most that it has

  /// Reads this constraint of Bullet's, which it is a part of, or which it stands for.
  GearModel(btGearConstraint& gear, RowCount max_rows);
  ~GearModel() override;

  const char* name() const override;
  void addRows(const PosePair& poses, Rows& rows) const override;
  /// The two axes, each with a circle about it.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  friend class GearJoint;
  friend struct JointAccess;

  static int rowsOfStock(const btGearConstraint&) { return row_count.rows; }
  ///@{
  /// In the place of Joint's own.
  void announceRows(Info1& info, int room = max_room);
  void writeRows(Info2& info);
  void afterPass(btSolverBody&, btSolverBody&) {}
  ///@}
  ///@{
  /// rad or m: the coordinates, the sum of them that is held, and how far off it is.
  double coordinateA() const;
  double coordinateB() const;
  double heldSum() const;
  double error() const;
  ///@}
  void hold(double sum);

 private:
  struct State;

  btGearConstraint& gear() const;
  void read(Complaints* complaints) override;
  void updateState(const PosePair& poses) override;
  /// Couples two coordinates, as long as Bullet's object has the axes that it has now.
  void couple(const GearCoordinate& a, const GearCoordinate& b);
  /// The row of the step that begins, null if there is none.
  const GearRow* beginStep();
  /// The same for another solver.
  const GearRow* beginStep(Scalar dt);
  Scalar maxCorrection() const;

  std::unique_ptr<State> m_state;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
