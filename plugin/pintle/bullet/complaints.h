// Purpose: what is not used of the settings that a client wrote to a constraint of Bullet's, in words.
#pragma once

#include <pintle/bullet/stock_motor.h>
#include <pintle/bullet/stock_parameter.h>
#include <pintle/finite.h>
#include <pintle/rows/axis_settings.h>

#include <LinearMath/btVector3.h>

#include <limits>
#include <sstream>
#include <string>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints {
 public:
  explicit Complaints(const char* joint) : m_joint(joint) {}
  /// Counts them, and takes no memory: for a step.
  Complaints() = default;

  /// The fields that follow are those of this axis; null: of none.
  void setAxis(const char* axis) { m_axis = axis; }

  void add(const char* field, Scalar value, const char* why) {
    ++m_count;
    if (m_joint == nullptr) return;
    std::ostringstream text;
    text << field << " = " << value;
    append(text.str(), why);
  }
  void add(const char* field, const char* why) {
    ++m_count;
    if (m_joint != nullptr) append(field, why);
  }
  int count() const { return m_count; }
  const std::string& text() const { return m_text; }

 private:
  void append(const std::string& field, const char* why) {
    if (!m_text.empty()) m_text += "; ";
    m_text.append("pintle::").append(m_joint).append(": ");
    if (m_axis != nullptr) m_text.append(m_axis).append(" ");
    m_text.append(field).append(": ").append(why);
  }

  const char* m_joint = nullptr;
  const char* m_axis = nullptr;
  int m_count = 0;
  std::string m_text;
};

/// Takes `from` over if it is finite. `complaints`: null in a step.
inline void takeFinite(Scalar& to, Scalar from, const char* field, Complaints* complaints) {
  if (isFinite(from))
    to = from;
  else if (complaints != nullptr)
    complaints->add(field, from, "must be finite");
}

/// The same of a point.
inline void takePoint(btVector3& to, const btVector3& from, const char* field,
                      Complaints* complaints) {
  for (int i = 0; i < 3; ++i) {
    if (isFinite(from[i])) continue;
    if (complaints != nullptr) complaints->add(field, from[i], "must be finite");
    return;
  }
  to = from;
}
/// A point that was never given: rows of it are none.
inline btVector3 noPoint() {
  constexpr Scalar none = std::numeric_limits<Scalar>::quiet_NaN();
  return {none, none, none};
}
/// The same of what is not below zero: such a value is taken as zero. (Bullet's classes turn it against itself.)
inline void takeNotNegative(Scalar& to, Scalar from, const char* field, Complaints* complaints) {
  takeFinite(to, from, field, complaints);
  if (to >= 0) return;
  to = 0;
  if (complaints != nullptr)
    complaints->add(field, from, "must not be negative, and is taken as 0");
}
/// The same of a bound, which may be infinite.
inline void takeBound(Scalar& to, Scalar from, const char* field, Complaints* complaints) {
  takeNotNegative(to, isNumber(from) && from > infinity ? infinity : from, field, complaints);
}
/// The same of a parameter, which need not be set.
inline void takeParameter(Parameter& to, const StockParameter& from, const char* field,
                          Complaints* complaints) {
  if (!from.is_set) {
    to = {};
    return;
  }
  Scalar value = 0;
  takeNotNegative(value, from.value, field, complaints);
  if (isFinite(from.value)) to = value;  // else it may be none, still
}

/// How errors name the numbers of a motor.
struct MotorNames {
  const char *velocity, *bound;
};
/// The same of the velocity motor of an axis, whose bound is `axis.*bound`. What a client writes to it comes before a servo. `last`:
/// what was taken before.
inline void takeMotor(Axis& axis, Scalar Axis::*bound, const StockMotor& from, StockMotor& last,
                      const MotorNames& names, Complaints* complaints) {
  if (from.on) {  // else Bullet may have left them as the memory was
    const bool is_another = !from.isSameAs(last);
    if (is_another || (complaints != nullptr && axis.chosen == Axis::Drive::velocity)) {
      takeFinite(axis.motor_velocity, from.velocity, names.velocity, complaints);
      takeBound(axis.*bound, from.bound, names.bound, complaints);
    }
    if (is_another) {
      last = from;
      axis.chosen = Axis::Drive::velocity;
    }
  }
  axis.enable(from.on);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
