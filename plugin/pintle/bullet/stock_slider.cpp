#include <pintle/bullet/stock_slider.h>

#include <pintle/bullet/private_member.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(SliderAngularDepth, btScalar, btSliderConstraint, m_angDepth);
PINTLE_PRIVATE_MEMBER(SliderWayIsBroken, bool, btSliderConstraint, m_solveLinLim);
PINTLE_PRIVATE_MEMBER(SliderAngleIsBroken, bool, btSliderConstraint, m_solveAngLim);

}  // namespace

inline namespace PINTLE_PRECISION {

void showAngularLimit(btSliderConstraint& slider, Scalar depth) {
  slider.*pointer(SliderAngularDepth()) = depth;
  slider.*pointer(SliderAngleIsBroken()) = depth != 0;
}

void showBroken(btSliderConstraint& slider, bool linear, bool angular) {
  slider.*pointer(SliderWayIsBroken()) = linear;
  slider.*pointer(SliderAngleIsBroken()) = angular;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
