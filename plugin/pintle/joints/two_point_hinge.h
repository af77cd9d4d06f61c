// Purpose: the hinge of two points (document, 3.2.2).
#pragma once

#include <pintle/joints/hinge_of.h>

namespace pintle {
namespace equations {
template <class T>
struct TwoPoints;
}

inline namespace PINTLE_PRECISION {

/// A hinge that holds two points of its axis together. It comes back from any error below 180 degrees,
/// where it is stuck, but its rows work against each other: QuaternionHinge is the hinge to use. As
/// a block (setBlockRows) the two points are solved together, and the document's complaint of slow
/// convergence is about plain rows.
///
/// Five rows: two across the axis at either point, one along it at the joint's own anchors. Angular
/// only, there are the two rows of the points' difference. setFormulation: whether each body is held
/// at its own points (document), or both at the same, and with the curvature of the motion.
///
/// The angle, its limit, motor, servo and friction: HingeBase.
///
/// \image html two_point_hinge.svg
class TwoPointHinge : public HingeOf<TwoPointHinge> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  using HingeOf::HingeOf;

  /// Where the points are on the axis. The last one is held best.
  enum class Placement : unsigned char {
    about_anchor,    ///< on either side of the anchor
    from_nearest_a,  ///< the last one where the axis is nearest to the centre of a; the default
    from_nearest_b   ///< the same for b
  };
  /// `separation` of the points (m, > 0; default 1): far apart they hold the direction, close
  /// together the place.
  void setPlacement(Placement placement, btScalar separation = 1);
  /// What setPlacement set.
  Placement getPlacement() const { return m_placement; }
  /// m, as setPlacement set it.
  btScalar getSeparation() const { return m_separation; }

  /// All three rows of either point, as the document has them. Where the joint holds, one of them says
  /// nothing new; off it, that one works against the others, and may hold the axes apart. As a block
  /// they tear, so this also turns the block off (setBlockRows), or on again. Default off.
  void setSixRows(bool six) {
    m_six_rows = six;
    setBlockRows(!six);
  }
  /// What setSixRows set.
  bool getSixRows() const { return m_six_rows; }

  /// The frames, the range of the angle, and the two points.
  void drawJoint(btIDebugDraw& drawer) const override;

 private:
  friend HingeOf;
  friend ObservedJoint;
  static constexpr const char* joint_name = "TwoPointHinge";
  static constexpr RowCount row_count{7, 1};

  struct Lines;
  void constrain(const Observation& seen, Rows& rows) const;
  void addPointRows(const Lines& lines, Rows& rows) const;
  void addDirectionRows(const Lines& lines, Rows& rows) const;
  equations::TwoPoints<Scalar> points(const Lines& at) const;

  Scalar m_separation = 1;
  Placement m_placement = Placement::from_nearest_a;
  bool m_six_rows = false;
};

extern template class ObservedJoint<TwoPointHinge, HingeModel>;
extern template class HingeOf<TwoPointHinge>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
