// Purpose: what a slider of Bullet's keeps to itself and its subclasses: its settings, and what a step leaves there. For
// slider_joint.cpp only.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/bullet/stock_slider.h>
#include <pintle/frame.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The names of the members, as a subclass may use them.
struct OpenSlider : btSliderConstraint {
  static constexpr auto numbers = &OpenSlider::m_lowerLinLimit;  ///< the first one
  static constexpr auto linear_motor = &OpenSlider::m_targetLinMotorVelocity;
  static constexpr auto angular_motor = &OpenSlider::m_targetAngMotorVelocity;
  static constexpr auto flags = &OpenSlider::m_flags;
  static constexpr auto linear_on = &OpenSlider::m_poweredLinMotor;
  static constexpr auto angular_on = &OpenSlider::m_poweredAngMotor;
  static constexpr auto of_frame_a = &OpenSlider::m_useLinearReferenceFrameA;
  static constexpr auto frame_offset = &OpenSlider::m_useOffsetForConstraintFrame;

  static constexpr auto frame_a = &OpenSlider::m_calculatedTransformA;
  static constexpr auto frame_b = &OpenSlider::m_calculatedTransformB;
  static constexpr auto pivot_a = &OpenSlider::m_realPivotAInW;
  static constexpr auto pivot_b = &OpenSlider::m_realPivotBInW;
  static constexpr auto projection = &OpenSlider::m_projPivotInW;
  static constexpr auto axis = &OpenSlider::m_sliderAxis;
  static constexpr auto delta = &OpenSlider::m_delta;
  static constexpr auto depth = &OpenSlider::m_depth;
  static constexpr auto position = &OpenSlider::m_linPos;
  static constexpr auto angle = &OpenSlider::m_angPos;
  static constexpr auto angular_depth = &OpenSlider::m_angDepth;
  static constexpr auto way_is_broken = &OpenSlider::m_solveLinLim;
  static constexpr auto angle_is_broken = &OpenSlider::m_solveAngLim;
};

/// Takes over what stands there, from `first` on. Returns whether a bit has changed.
template <int count>
bool updateBits(Scalar (&last)[count], const Scalar& first) {
  if (std::memcmp(last, &first, sizeof last) == 0) return false;
  std::memcpy(last, &first, sizeof last);
  return true;
}

inline bool StockSliderBits::update(const btSliderConstraint& from) {
  using S = OpenSlider;
  const int switches = from.*S::flags << 4 | int(from.*S::linear_on) << 3 |
                       int(from.*S::angular_on) << 2 | int(from.*S::of_frame_a) << 1 |
                       int(from.*S::frame_offset);
  bool is_another = switches != m_switches;
  m_switches = switches;
  is_another |= updateBits(m_numbers, from.*S::numbers);
  is_another |= updateBits(m_linear_motor, from.*S::linear_motor);
  is_another |= updateBits(m_angular_motor, from.*S::angular_motor);
  return is_another;
}

/// The state that btSliderConstraint::calculateTransforms and testLinLimits leave. `sign`: of the position along d = p_b - p_a.
/// `presses`: a load on a limit that is not broken breaks it.
inline void showTravel(btSliderConstraint& slider, const PosePair& poses, const Frame& a,
                       const Frame& b, Scalar sign, bool presses) {
  using S = OpenSlider;
  btTransform &A = slider.*S::frame_a, &B = slider.*S::frame_b;
  a.store(A, poses.pose_a().getOrigin());
  b.store(B, poses.pose_b().getOrigin());
  const btVector3 pivot_a = A.getOrigin(), pivot_b = B.getOrigin(),
                  delta = sign * (pivot_b - pivot_a);
  const Vec3 x = a.a();
  const btVector3 axis(x.x(), x.y(), x.z());
  const Lanes along = a.components(Vec3(delta.x(), delta.y(), delta.z()));
  const Scalar position = along[0];
  slider.*S::pivot_a = pivot_a;
  slider.*S::pivot_b = pivot_b;
  slider.*S::delta = delta;
  slider.*S::axis = axis;
  slider.*S::projection = pivot_a + position * axis;
  setLanes(slider.*S::depth, along);
  slider.*S::position = position;
  const Scalar depth = beyond(position, slider.getLowerLinLimit(), slider.getUpperLinLimit());
  (slider.*S::depth)[0] = depth;
  slider.*S::way_is_broken = depth != 0 || presses;
}

/// The state that btSliderConstraint::testAngLimits leaves of an angle that is `depth` beyond its limit (rad, above zero beyond the
/// upper one).
inline void showAngularLimit(btSliderConstraint& slider, Scalar depth, bool presses) {
  slider.*OpenSlider::angular_depth = depth;
  slider.*OpenSlider::angle_is_broken = depth != 0 || presses;
}

/// atan2(y, x), quick for small angles, as those of a locked slider are.
inline Scalar angleOf(Scalar y, Scalar x) {
  return y * y < SIMD_EPSILON * x * x && x > 0 ? y / x : btAtan2(y, x);
}

/// The same where y of frame b is (x, y) along y and z of frame a, and of the limits of Bullet's object.
inline void showAngle(btSliderConstraint& slider, Scalar x, Scalar y, bool presses) {
  const Scalar low = slider.getLowerAngLimit(), high = slider.getUpperAngLimit();
  Scalar depth = 0;
  if (low <= high) {
    const Scalar angle = btAdjustAngleToLimits(angleOf(y, x), low, high);
    slider.*OpenSlider::angle = angle;
    depth = beyond(angle, low, high);
  }
  showAngularLimit(slider, depth, presses);
}

/// No limit is broken.
inline void hideBroken(btSliderConstraint& slider) {
  slider.*OpenSlider::way_is_broken = slider.*OpenSlider::angle_is_broken = false;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
