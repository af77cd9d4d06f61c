#include <pintle/joints/gear_joint.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

GearJoint::GearJoint(const GearCoordinate& a, const GearCoordinate& b, btScalar ratio)
    : GearJoint(a, b, ratio, GearCoordinate::bodiesOf(a, b)) {}

GearJoint::GearJoint(const GearCoordinate& a, const GearCoordinate& b, btScalar ratio,
                     GearCoordinate::Bodies bodies)
    : JointOf(row_count, *bodies.a, *bodies.b, a.axisIn(*bodies.a), b.axisIn(*bodies.b), ratio) {
  finite("ratio", ratio);
  couple(a, b);
}

// Counts on to where the bodies are now.
void GearJoint::follow() {
  readFromBullet();
  const BodyPair pair(m_rbA, m_rbB);
  if (pair.finite()) updateState(pair);
}

btScalar GearJoint::getCoordinateA() {
  follow();
  return btScalar(coordinateA());
}

btScalar GearJoint::getCoordinateB() {
  follow();
  return btScalar(coordinateB());
}

btScalar GearJoint::getError() {
  follow();
  return btScalar(error());
}

void GearJoint::setOffset(btScalar offset) {
  finite("offset", offset);
  follow();
  hold(double(offset));
}

btScalar GearJoint::getOffset() {
  follow();
  return btScalar(heldSum());
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
