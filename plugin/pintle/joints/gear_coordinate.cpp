#include <pintle/joints/gear_coordinate.h>

#include <pintle/bullet/frames.h>
#include <pintle/bullet/stock_hinge.h>
#include <pintle/finite.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace pintle {
inline namespace PINTLE_PRECISION {

GearCoordinate::GearCoordinate(btTypedConstraint& joint, int main_axis)
    : m_a(&joint.getRigidBodyA()), m_b(&joint.getRigidBodyB()), m_main(main_axis) {}

void GearCoordinate::setFrames(const btTransform& in_a, const btTransform& in_b,
                               const char* joint) {
  const int second = m_main == 0 ? 1 : m_main - 1;  // by which Bullet measures angles
  if (!repairFrame(in_a, m_main, second, m_frame_a) ||
      !repairFrame(in_b, m_main, second, m_frame_b))
    throw std::invalid_argument(std::string("pintle::GearJoint: frames of a ") + joint +
                                ": must be finite, and their main axis no null vector");
}

GearCoordinate::GearCoordinate(btHingeConstraint& hinge)
    : GearCoordinate(static_cast<btTypedConstraint&>(hinge), 2) {
  setFrames(hinge.getAFrame(), hinge.getBFrame(), "hinge");
  m_sign = -referenceSign(hinge);
  if (auto* const counted = dynamic_cast<btHingeAccumulatedAngleConstraint*>(&hinge)) {
    const btScalar turns =
        (counted->getAccumulatedHingeAngle() - hinge.getHingeAngle()) / SIMD_2_PI;
    if (isFinite(turns)) m_turns = m_sign * std::round(turns);
  }
}

GearCoordinate::GearCoordinate(btSliderConstraint& slider)
    : GearCoordinate(static_cast<btTypedConstraint&>(slider), 0) {
  setFrames(slider.getFrameOffsetA(), slider.getFrameOffsetB(), "slider");
  m_is_position = true;
  m_sign = slider.getUseLinearReferenceFrameA() ? Scalar(1) : Scalar(-1);
}

GearCoordinate GearCoordinate::angleOf(btSliderConstraint& slider) {
  GearCoordinate angle(slider);
  angle.m_is_position = false;
  angle.m_sign = 1;
  return angle;
}

btVector3 GearCoordinate::axisIn(const btRigidBody& body) const {
  const bool is_b = &body == m_b;
  const btTransform& frame = is_b ? m_frame_b : m_frame_a;
  return frame.getBasis().getColumn(m_main) * (is_b ? m_sign : -m_sign);
}

// It acts on one body of each joint: those that leave out no body that moves; else those that leave out what the
// joints have in common, their carrier; else the joints' bodies b.
GearCoordinate::Bodies GearCoordinate::bodiesOf(const GearCoordinate& a, const GearCoordinate& b) {
  btRigidBody* const of_a[] = {a.m_b, a.m_a};
  btRigidBody* const of_b[] = {b.m_b, b.m_a};
  Bodies best{a.m_b, b.m_b};
  int least = -1;
  for (btRigidBody* const x : of_a) {
    for (btRigidBody* const y : of_b) {
      if (x == y) continue;
      const auto is_left = [&](const btRigidBody* body) {
        return body != x && body != y && !body->isStaticOrKinematicObject();
      };
      const auto is_common = [&](const btRigidBody* body) {
        return (body == a.m_a || body == a.m_b) && (body == b.m_a || body == b.m_b);
      };
      int cost = int(is_common(x)) + int(is_common(y));
      for (const btRigidBody* body : {a.m_a, a.m_b, b.m_a, b.m_b}) cost += 4 * int(is_left(body));
      if (least >= 0 && cost >= least) continue;
      least = cost;
      best = {x, y};
    }
  }
  return best;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
