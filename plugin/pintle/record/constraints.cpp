#include <pintle/record/constraints.h>

#include <pintle/pintle.h>
#include <pintle/record/json.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHinge2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyLink.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {
namespace {

void holdNothing(Description& to) { to.holds[0] = to.holds[1] = to.holds[2] = false; }

template <class T>
void setFrames(const T& joint, Description& to) {
  to.in_a = joint.getFrameOffsetA();
  to.in_b = joint.getFrameOffsetB();
}

// Without reference frame A a stock coordinate has the other sign.
void addRange(Limit::Kind kind, btScalar low, btScalar high, bool reversed, Description& to) {
  if (low > high) return;
  if (reversed) to.limits.push_back({kind, -high, -low});
  if (!reversed) to.limits.push_back({kind, low, high});
}

// What allows all angles that there are (rad) is no limit.
void addTurn(int axis, btScalar low, btScalar high, btScalar all, Description& to) {
  const btScalar nearly = all - btScalar(0.1);
  if (low < high && high - low < nearly) to.limits.push_back({Limit::Kind::turn, low, high, axis});
}

// Pintle's and Bullet's, which have the same methods.
template <class Hinge>
void describeHinge(Hinge& hinge, Description& to) {
  to.in_a = hinge.getAFrame();
  to.in_b = hinge.getBFrame();
  to.align = Align::z;
  if (hinge.hasLimit() || hinge.getLowerLimit() == hinge.getUpperLimit())
    addRange(Limit::Kind::angle, hinge.getLowerLimit(), hinge.getUpperLimit(),
             !hinge.getUseReferenceFrameA(), to);
}

template <class ConeTwist>
void describeConeTwist(const ConeTwist& joint, Description& to) {
  to.in_a = joint.getAFrame();
  to.in_b = joint.getBFrame();
  to.limits.push_back({Limit::Kind::cone, joint.getSwingSpan2(), joint.getSwingSpan1()});
  if (joint.getTwistSpan() < SIMD_PI)
    to.limits.push_back({Limit::Kind::twist, -joint.getTwistSpan(), joint.getTwistSpan()});
}

template <class Slider>
void describeSlider(Slider& slider, Description& to) {
  setFrames(slider, to);
  to.holds[0] = slider.getLowerLinLimit() == slider.getUpperLinLimit();
  to.align = slider.getLowerAngLimit() == slider.getUpperAngLimit() ? Align::all : Align::x;
  if (!to.holds[0])
    addRange(Limit::Kind::slide, slider.getLowerLinLimit(), slider.getUpperLinLimit(),
             !slider.getUseLinearReferenceFrameA(), to);
  // Right-handed about x.
  if (slider.getUseLinearReferenceFrameA())
    addTurn(0, -slider.getUpperAngLimit(), -slider.getLowerAngLimit(), SIMD_2_PI, to);
  else
    addTurn(0, slider.getLowerAngLimit(), slider.getUpperAngLimit(), SIMD_2_PI, to);
}

template <class SixDof>
void describeSixDof(SixDof& joint, Description& to) {
  setFrames(joint, to);
  btVector3 low, high, low_angle, high_angle;
  joint.getLinearLowerLimit(low);
  joint.getLinearUpperLimit(high);
  joint.getAngularLowerLimit(low_angle);
  joint.getAngularUpperLimit(high_angle);
  int held = 0, free_axis = 0;
  for (int i = 0; i < 3; ++i) {
    to.holds[i] = low[i] == high[i];
    if (low[i] < high[i]) to.limits.push_back({Limit::Kind::slide, low[i], high[i], i});
    if (low_angle[i] == high_angle[i]) ++held;
    if (low_angle[i] != high_angle[i]) free_axis = i;
    // The second of the three is within a right angle.
    addTurn(i, low_angle[i], high_angle[i], i == to.order[1] ? SIMD_PI : SIMD_2_PI, to);
  }
  if (held == 3) to.align = Align::all;
  if (held == 2 && free_axis == 0) to.align = Align::x;
  if (held == 2 && free_axis == 2) to.align = Align::z;
}

// Pintle's and Bullet's: the second angle is within a right angle, or a whole turn.
template <class Universal>
void describeUniversal(Universal& joint, btScalar second, Description& to) {
  setFrames(joint, to);
  to.align = Align::across;
  btVector3 low, high;
  joint.getAngularLowerLimit(low);
  joint.getAngularUpperLimit(high);
  addTurn(1, low[1], high[1], second, to);
  addTurn(2, low[2], high[2], SIMD_2_PI, to);
}

void setOrder(RotateOrder order, Description& to) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                   {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::copy_n(orders[int(order)], 3, to.order);
}

bool describePintle(Joint& joint, Description& to) {
  if (auto* hinge = dynamic_cast<HingeBase*>(&joint)) {
    describeHinge(*hinge, to);
  } else if (auto* slider = dynamic_cast<SliderJoint*>(&joint)) {
    describeSlider(*slider, to);
  } else if (auto* cone = dynamic_cast<ConeTwistJoint*>(&joint)) {
    describeConeTwist(*cone, to);
  } else if (auto* universal = dynamic_cast<UniversalJoint*>(&joint)) {
    describeUniversal(*universal, SIMD_2_PI, to);
    if (universal->getAngularOnly()) holdNothing(to);
  } else if (dynamic_cast<SixDofModel*>(&joint) != nullptr) {
    if (auto* first = dynamic_cast<btGeneric6DofConstraint*>(&joint.constraint())) {
      describeSixDof(*first, to);
    } else {
      auto& second = static_cast<btGeneric6DofSpring2Constraint&>(joint.constraint());
      setOrder(second.getRotationOrder(), to);
      describeSixDof(second, to);
    }
  } else if (auto* ball = dynamic_cast<BallJoint*>(&joint)) {
    to.in_a.setOrigin(ball->getPivotInA());
    to.in_b.setOrigin(ball->getPivotInB());
  } else if (auto* frames = dynamic_cast<FrameJoint*>(&joint)) {
    setFrames(*frames, to);
    if (frames->getAngularOnly()) holdNothing(to);
  } else {
    return false;
  }

  if (dynamic_cast<FixedJoint*>(&joint) != nullptr) to.align = Align::all;
  if (auto* distance = dynamic_cast<DistanceJoint*>(&joint)) {
    holdNothing(to);
    to.limits.push_back(
        {Limit::Kind::distance, distance->getLowerLimit(), distance->getUpperLimit()});
  } else if (auto* contact = dynamic_cast<ContactJoint*>(&joint)) {
    to.holds[0] = to.holds[1] = false;
    to.one_sided = !contact->getTwoSided();
  } else if (auto* wedge = dynamic_cast<WedgeJoint*>(&joint)) {
    addRange(Limit::Kind::wedge, wedge->getLowerLimit(), wedge->getUpperLimit(), false, to);
  } else if (auto* angle = dynamic_cast<AngularLimit*>(&joint)) {
    holdNothing(to);
    addRange(Limit::Kind::angle, angle->getLowerLimit(), angle->getUpperLimit(), false, to);
  } else if (auto* shafts = dynamic_cast<ConstantVelocityJoint*>(&joint)) {
    if (shafts->getBendLimit() < SIMD_PI)
      to.limits.push_back({Limit::Kind::bend, 0, shafts->getBendLimit()});
  }
  return true;
}

void describeStock(btTypedConstraint& constraint, Description& to) {
  switch (constraint.getConstraintType()) {
    case POINT2POINT_CONSTRAINT_TYPE: {
      const auto& ball = static_cast<const btPoint2PointConstraint&>(constraint);
      to.type = "btPoint2PointConstraint";
      to.in_a.setOrigin(ball.getPivotInA());
      to.in_b.setOrigin(ball.getPivotInB());
      return;
    }
    case HINGE_CONSTRAINT_TYPE:
      to.type = "btHingeConstraint";
      return describeHinge(static_cast<btHingeConstraint&>(constraint), to);
    case CONETWIST_CONSTRAINT_TYPE:
      to.type = "btConeTwistConstraint";
      return describeConeTwist(static_cast<const btConeTwistConstraint&>(constraint), to);
    case SLIDER_CONSTRAINT_TYPE:
      to.type = "btSliderConstraint";
      return describeSlider(static_cast<btSliderConstraint&>(constraint), to);
    case D6_CONSTRAINT_TYPE:
    case D6_SPRING_CONSTRAINT_TYPE: {
      auto& six = static_cast<btGeneric6DofConstraint&>(constraint);
      to.type = "btGeneric6DofConstraint";
      if (constraint.getConstraintType() == D6_SPRING_CONSTRAINT_TYPE)
        to.type = "btGeneric6DofSpringConstraint";
      if (dynamic_cast<btUniversalConstraint*>(&six) != nullptr) {
        to.type = "btUniversalConstraint";
        return describeUniversal(six, SIMD_PI, to);
      }
      return describeSixDof(six, to);
    }
    case FIXED_CONSTRAINT_TYPE:
    case D6_SPRING_2_CONSTRAINT_TYPE: {
      auto& six = static_cast<btGeneric6DofSpring2Constraint&>(constraint);
      to.type = "btGeneric6DofSpring2Constraint";
      if (dynamic_cast<btFixedConstraint*>(&six) != nullptr) to.type = "btFixedConstraint";
      if (dynamic_cast<btHinge2Constraint*>(&six) != nullptr) to.type = "btHinge2Constraint";
      setOrder(six.getRotationOrder(), to);
      return describeSixDof(six, to);
    }
    case GEAR_CONSTRAINT_TYPE: to.type = "btGearConstraint"; break;
    default: to.type = "btTypedConstraint"; break;
  }
  to.has_anchors = false;
  holdNothing(to);
}

const char* name(Align align) {
  static const char* const names[] = {"nothing", "x", "z", "all", "across"};
  return names[int(align)];
}
const char* name(Limit::Kind kind) {
  static const char* const names[] = {"angle", "twist", "slide", "distance",
                                      "cone",  "wedge", "bend",  "turn"};
  return names[int(kind)];
}

}  // namespace

Description describe(btTypedConstraint& constraint) {
  Description to;
  if (auto* joint = dynamic_cast<Joint*>(&constraint)) {
    to.type = joint->name();
    if (!describePintle(*joint, to)) {  // a user's own
      to.has_anchors = false;
      holdNothing(to);
    }
  } else {
    describeStock(constraint, to);
  }
  return to;
}

Description describe(const btMultibodyLink& link) {
  Description to;
  to.type = "btMultiBody";
  btMatrix3x3 axes = btMatrix3x3::getIdentity();
  const auto along = [](int axis, const btVector3& direction) {
    btVector3 unit(0, 0, 0);
    unit[axis] = 1;
    return btMatrix3x3(shortestArcQuat(unit, direction));
  };
  if (link.m_jointType == btMultibodyLink::eRevolute) {
    axes = along(2, link.getAxisTop(0));
    to.align = Align::z;
  } else if (link.m_jointType == btMultibodyLink::ePrismatic) {
    axes = along(0, link.getAxisBottom(0));
    to.align = Align::all;
    to.holds[0] = false;
  } else if (link.m_jointType == btMultibodyLink::eFixed) {
    to.align = Align::all;
  } else if (link.m_jointType != btMultibodyLink::eSpherical) {
    to.has_anchors = false;
    holdNothing(to);
  }
  to.in_a = btTransform(btMatrix3x3(link.m_zeroRotParentToThis.inverse()) * axes, link.m_eVector);
  to.in_b = btTransform(axes, -link.m_dVector);
  return to;
}

std::string Description::json(int a, int b) const {
  Json joint('{');
  joint.text("type", type).number("a", a).number("b", b);
  if (has_anchors) joint.transform("inA", in_a).transform("inB", in_b);
  Json held('[');
  for (const bool axis : holds) held.item(axis ? 1. : 0.);
  joint.raw("holds", held.str()).text("align", name(align));
  if (one_sided) joint.number("oneSided", 1);
  const auto is_turn = [](const Limit& limit) { return limit.kind == Limit::Kind::turn; };
  if (std::any_of(limits.begin(), limits.end(), is_turn)) {
    Json axes('[');
    for (const int axis : order) axes.item(axis);
    joint.raw("order", axes.str());
  }
  Json ranges('[');
  for (const Limit& limit : limits) {
    Json range('{');
    range.text("kind", name(limit.kind)).number("axis", limit.axis);
    ranges.item(range.number("low", double(limit.low)).number("high", double(limit.high)).str());
  }
  return joint.raw("limits", ranges.str()).str();
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
