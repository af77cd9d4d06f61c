#include <pintle/bullet/stock_slider.h>

#include <pintle/bullet/private_member.h>

#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(SliderAngularDepth, btScalar, btSliderConstraint, m_angDepth);
PINTLE_PRIVATE_MEMBER(SliderAngleIsBroken, bool, btSliderConstraint, m_solveAngLim);

}  // namespace

inline namespace PINTLE_PRECISION {

void showAngularLimit(btSliderConstraint& slider, Scalar depth) {
  slider.*pointer(SliderAngularDepth()) = depth;
  slider.*pointer(SliderAngleIsBroken()) = depth != 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
