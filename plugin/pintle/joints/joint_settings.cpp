// Purpose: how settings are checked and kept. Nothing here is called in a step.
#include <pintle/joints/joint.h>

#include <pintle/bullet/complaints.h>
#include <pintle/bullet/frames.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/finite.h>

#include <sstream>
#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {

std::string Joint::whyIgnored() {
  Complaints complaints(name());
  read(&complaints);
  return complaints.text();
}

void Joint::setMaxCorrectionSpeed(btScalar speed) {
  m_max_correction_speed = positive("max correction speed", speed);
}

void Joint::setMaxLinearCorrectionSpeed(btScalar speed) {
  m_max_linear_correction_speed = positive("max linear correction speed", speed);
}

void Joint::reject(const char* field, double value, const char* why) const {
  std::ostringstream message;
  message << "pintle::" << name() << ": " << field << " = " << value << ": " << why;
  throw std::invalid_argument(message.str());
}

Scalar Joint::finite(const char* field, Scalar value) const {
  if (!isFinite(value)) reject(field, value, "must be finite");
  return value;
}

Scalar Joint::number(const char* field, Scalar value) const {
  if (!isNumber(value)) reject(field, value, "must be a number");
  return value;
}

Scalar Joint::notNegative(const char* field, Scalar value) const {
  if (finite(field, value) < 0) reject(field, value, "must not be negative");
  return value;
}

Scalar Joint::positive(const char* field, Scalar value) const {
  if (finite(field, value) <= 0) reject(field, value, "must be above zero");
  return value;
}

Scalar Joint::bound(const char* field, Scalar value) const {
  if (number(field, value) < 0) reject(field, value, "must not be negative");
  return btMin(value, infinity);
}

const btVector3& Joint::point(const char* field, const btVector3& value) const {
  for (int i = 0; i < 3; ++i) finite(field, value[i]);
  return value;
}

btVector3 Joint::direction(const char* field, const btVector3& value) const {
  const Scalar length = point(field, value).length();
  if (!(length > SIMD_EPSILON && length < infinity)) reject(field, length, "must have a direction");
  return value / length;
}

const btTransform& Joint::frame(const char* field, const btTransform& value) const {
  point(field, value.getOrigin());
  const btMatrix3x3& R = value.getBasis();
  for (int i = 0; i < 3; ++i) {
    point(field, R[i]);
    for (int j = 0; j <= i; ++j) {
      const Scalar product = R.getColumn(i).dot(R.getColumn(j));
      if (btFabs(product - Scalar(i == j)) > frame_tolerance)
        reject(field, product, "its axes must be unit vectors at right angles");
    }
  }
  if (R.determinant() < 0) reject(field, R.determinant(), "must be right-handed");
  return value;
}

const char* Joint::parameterName(int num) {
  switch (num) {
    case BT_CONSTRAINT_ERP: return "ERP";
    case BT_CONSTRAINT_STOP_ERP: return "STOP_ERP";
    case BT_CONSTRAINT_CFM: return "CFM";
    case BT_CONSTRAINT_STOP_CFM: return "STOP_CFM";
    default: return "unknown parameter";
  }
}

void Joint::setAxisLimit(Axis& axis, Scalar low, Scalar high) const {
  number("lower limit", low);
  number("upper limit", high);
  if (low <= high && low >= infinity) reject("lower limit", low, "leaves no position");
  if (low <= high && high <= -infinity) reject("upper limit", high, "leaves no position");
  axis.low = low;
  axis.high = high;
  axis.is_any_angle = false;
}

void Joint::setAngleLimit(Axis& axis, Scalar low, Scalar high) const {
  setAxisLimit(axis, low, high);
  axis.is_any_angle = btFabs(low + SIMD_PI) <= of_pi && btFabs(high - SIMD_PI) <= of_pi;
}

void Joint::setAxisSpring(Axis& axis, Scalar frequency_hz, Scalar damping_ratio) const {
  notNegative("limit spring frequency", frequency_hz);
  axis.limit_spring = {SIMD_2_PI * frequency_hz,
                       notNegative("limit spring damping ratio", damping_ratio)};
}

void Joint::setAxisMotor(Axis& axis, bool on, Scalar velocity, Scalar max_impulse) const {
  finite("motor target velocity", velocity);
  axis.max_motor_impulse = bound("max motor impulse", max_impulse);
  axis.motor_velocity = velocity;
  axis.chosen = Axis::Drive::velocity;
  axis.enable(on);
}

void Joint::setAxisForceMotor(Axis& axis, bool on, Scalar velocity, Scalar max_force,
                              const char* force_field) const {
  const Scalar limit = bound(force_field, max_force);
  setAxisMotor(axis, on, velocity, 0);
  axis.max_motor_force = limit;
}

void Joint::setAxisServo(Axis& axis, Scalar target, Scalar frequency_hz, Scalar damping_ratio,
                         Scalar max_force, const char* force_field) const {
  finite("servo target", target);
  positive("servo frequency", frequency_hz);
  notNegative("servo damping ratio", damping_ratio);
  axis.max_servo_force = bound(force_field, max_force);
  axis.servo_target = target;
  axis.servo_spring = {SIMD_2_PI * frequency_hz, damping_ratio};
  axis.chosen = Axis::Drive::servo;
  axis.enable(true);
}

void Joint::setAxisFriction(Axis& axis, Scalar max_force, const char* force_field) const {
  axis.max_friction = bound(force_field, max_force);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
