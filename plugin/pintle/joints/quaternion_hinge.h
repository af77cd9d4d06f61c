// Purpose: the hinge (document, 3.1.3 + 3.2.4 + 3.2.5), in the place of btHingeConstraint and
// btHingeAccumulatedAngleConstraint.
#pragma once

#include <pintle/joints/hinge_of.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The rows of QuaternionHinge.
class QuaternionHingeModel : public ObservedJoint<QuaternionHingeModel, HingeModel> {
 public:
  static constexpr RowCount row_count{6, 1};  ///< the most that it has

  const char* name() const override { return "QuaternionHinge"; }

 protected:
  using ObservedJoint::ObservedJoint;
  void limitChanged() override;

 private:
  friend ObservedJoint;

  void constrain(const Observation& seen, Rows& rows) const;
  void addDocumentRows(const Observation& seen, bool limit, Rows& rows) const;

  Axis m_half_sine_axis;  ///< its limit alone, in the document's half-sine space
};

/// One rotation about an axis common to two bodies (HingeBase), recovered from any error: the hinge
/// to use. Its rows are the swing from one axis to the other; the document's formulation has its
/// quaternion rows, and its limit in half-sine space.
///
/// It is a btHingeConstraint and a btHingeAccumulatedAngleConstraint.
///
/// \image html quaternion_hinge.svg
class QuaternionHinge : public HingeOf<QuaternionHinge, QuaternionHingeModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  using HingeOf::HingeOf;

 private:
  friend HingeOf;
  static constexpr const char* joint_name = "QuaternionHinge";
};

extern template class ObservedJoint<QuaternionHingeModel, HingeModel>;
extern template class HingeOf<QuaternionHinge, QuaternionHingeModel>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
