// Purpose: the hinge by dot products (document, 3.1.3 + 3.2.1).
#pragma once

#include <pintle/joints/hinge_of.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A hinge whose axis rows (3.16) keep the axis of a normal to two tangents of that of b. They are as
/// good as any while the axes are close. From 90 degrees apart they are stuck, and beyond they pull
/// the axes to 180: QuaternionHinge is the conditioned form of this joint. setFormulation is about the
/// rows of the pivot only.
///
/// The angle, its limit, motor, servo and friction: HingeBase.
///
/// \image html dot_hinge.svg
class DotHinge : public HingeOf<DotHinge> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  using HingeOf::HingeOf;

 private:
  friend HingeOf;
  friend ObservedJoint;
  static constexpr const char* joint_name = "DotHinge";
  static constexpr RowCount row_count{6, 1};

  void constrain(const Observation& seen, Rows& rows) const;
};

extern template class ObservedJoint<DotHinge, HingeModel>;
extern template class HingeOf<DotHinge>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
