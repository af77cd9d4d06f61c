#include <pintle/rows/axis.h>

#include <pintle/equations/impulse.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr double rigid_softness = 1e-6;
// Bullet iterates a soft row by lambda <- rhs - cfm lambda, which leaves cfm^n of the answer after n
// iterations. Softer springs than this are solved here, and written as the impulse that they are.
constexpr Scalar max_spring_cfm = Scalar(0.1);

struct Part {
  Scalar target = 0, cfm = 0, lower = 0, upper = 0;
  bool rigid = true;  // Bullet's solver can run it as a row
  bool on = false;
};

Part rigidPart(Scalar target, Scalar cfm, Scalar lower, Scalar upper) {
  return {target, cfm, lower, upper, cfm < 1, true};
}

Part springPart(const Spring& spring, Scalar error, Scalar dt, Scalar lower, Scalar upper) {
  const auto soft = equations::softness_by_frequency<Scalar>(spring.angular_frequency,
                                                             spring.damping_ratio, dt, Scalar(1));
  const Scalar cfm = soft.gamma / dt;
  return {-equations::baumgarte(error, soft.beta, dt), cfm, lower, upper, cfm <= max_spring_cfm,
          true};
}

Part limitPart(const Axis& axis, const AxisMotion& m, AxisRow& row) {
  // The side that is broken, or nearer after the motion as it is.
  const Scalar dt = 1 / m.fps, next = m.position + m.velocity * dt;
  const bool inside = m.position > axis.low && m.position < axis.high;
  const bool at_low = inside ? next - axis.low < axis.high - next : m.position <= axis.low;
  const bool locked = axis.locked();
  const Scalar lower = locked || !at_low ? -infinity : Scalar(0);
  const Scalar upper = locked || at_low ? infinity : Scalar(0);
  // Towards the inside is positive from here on, for both sides.
  const Scalar side = at_low ? Scalar(1) : Scalar(-1);
  const Scalar gap = side * (m.position - (at_low ? axis.low : axis.high));
  const Scalar inward = side * m.velocity;

  if (axis.limit_spring.angular_frequency > 0) {
    if (gap > 0 && !locked) return {};
    return springPart(axis.limit_spring, side * gap, dt, lower, upper);
  }
  // No rebound goes further than half way to the other limit in a step.
  const auto away = [&](Scalar speed) {
    return locked ? speed : std::min(speed, (axis.high - axis.low) * m.fps / 2);
  };
  if (gap > 0 && !locked) {
    if (m.incoming > 0 && gap < Scalar(0.1) * m.incoming * dt)  // reached in the last step
      return rigidPart(side * away(axis.bias * axis.relaxation * m.incoming), 0, lower, upper);
    // Not there yet: the step may close the gap, and no more. Bullet's softness means nothing here.
    row.incoming = std::max(Scalar(0), -inward);
    return rigidPart(side * -gap * m.fps, 0, lower, upper);
  }
  // As in Bullet: a rebound if the joint comes in, of the speed with which it did.
  Scalar speed = std::min(-m.fps * m.limit_erp * axis.bias * gap, m.max_speed);
  const Scalar incoming = std::max(m.incoming, -inward);
  if (axis.relaxation > 0 && incoming > 0)
    speed = std::max(speed, away(axis.bias * axis.relaxation * incoming));
  return rigidPart(side * speed, m.limit_cfm, lower, upper);
}

Part motorPart(const Axis& axis, const AxisMotion& m) {
  if (axis.drive == Axis::Drive::velocity)
    return rigidPart(m.motor_factor * axis.motor_velocity, m.motor_cfm, -axis.max_motor_impulse,
                     axis.max_motor_impulse);
  const Scalar bound = axis.max_servo_force / m.fps;
  return springPart(axis.servo_spring, m.position - axis.servo_target, 1 / m.fps, -bound, bound);
}

Part frictionPart(const Axis& axis, const AxisMotion& m) {
  const Scalar bound = axis.max_friction / m.fps;
  return rigidPart(0, 0, -bound, bound);
}

// More than any impulse, and little enough to be added and multiplied.
constexpr double unbounded = 1e30;

// A part as a slope. Doubles, as a rigid one is a slope of a millionth of K.
struct Slope {
  double target, softness, lower, upper;

  Slope(const Part& part, double K)
      : target(part.target),
        softness(std::max(double(part.cfm), rigid_softness) * K),
        lower(std::max(double(part.lower), -unbounded)),
        upper(std::min(double(part.upper), unbounded)) {}
  Slope() = default;
  double at(double u) const { return std::clamp((target - u) / softness, lower, upper); }
  double begin() const { return target - softness * upper; }
  double end() const { return target - softness * lower; }
};

// Where the free motion u = u_free + K Lambda meets the sum of the parts.
double meet(const Slope* slope, const Part* part, double u_free, double K) {
  double ends[2 * Axis::parts];
  int n = 0;
  const auto insert = [&](double end) {
    int i = n++;
    for (; i > 0 && ends[i - 1] > end; --i) ends[i] = ends[i - 1];
    ends[i] = end;
  };
  for (int i = 0; i < Axis::parts; ++i) {
    if (!part[i].on) continue;
    if (slope[i].upper < unbounded) insert(slope[i].begin());
    if (slope[i].lower > -unbounded) insert(slope[i].end());
  }
  const auto excess = [&](double u) {
    double impulse = 0;
    for (int i = 0; i < Axis::parts; ++i)
      if (part[i].on) impulse += slope[i].at(u);
    return u - u_free - K * impulse;
  };
  // excess grows with u and is linear between the ends; beyond them any two points tell the line.
  int k = 0;
  while (k < n && excess(ends[k]) < 0) ++k;
  const double left = k > 0 ? ends[k - 1] : k < n ? ends[k] - 1 : u_free;
  const double right = k < n ? ends[k] : left + 1;
  const double f_left = excess(left), f_right = excess(right);
  return f_right > f_left ? left - f_left * (right - left) / (f_right - f_left) : left;
}

AxisRow single(AxisRow row, int i, const Part& part) {
  row.active = i;
  row.target = part.target;
  row.cfm = part.cfm;
  row.lower = part.lower;
  row.upper = part.upper;
  return row;
}

}  // namespace

AxisRow solveAxis(const Axis& axis, const AxisMotion& m) {
  AxisRow row;
  if (axis.isSimple(m.limit)) {
    if (m.limit) {
      const Part part = limitPart(axis, m, row);
      return part.on ? single(row, Axis::limit, part) : row;
    }
    if (axis.drive != Axis::Drive::off) return single(row, Axis::motor, motorPart(axis, m));
    return single(row, Axis::friction, frictionPart(axis, m));
  }
  if (!(m.K > 0)) return row;  // neither body can move

  Part part[Axis::parts];
  if (axis.drive != Axis::Drive::off) part[Axis::motor] = motorPart(axis, m);
  if (axis.max_friction > 0) part[Axis::friction] = frictionPart(axis, m);
  if (m.limit) part[Axis::limit] = limitPart(axis, m, row);
  Slope slope[Axis::parts];
  for (int i = 0; i < Axis::parts; ++i) slope[i] = Slope(part[i], m.K);
  const double u = meet(slope, part, m.free_velocity, m.K);
  int active = Axis::parts;
  double nearest = unbounded;
  for (int i = 0; i < Axis::parts; ++i) {
    if (!part[i].on) continue;
    row.share[i] = Scalar(slope[i].at(u));
    // The rigid part that u is on, or else the one that it would come to first.
    const double away = std::max({0., slope[i].begin() - u, u - slope[i].end()});
    if (part[i].rigid && away < nearest) {
      nearest = away;
      active = i;
    }
  }
  if (active != Axis::parts) row.share[active] = 0;
  const Scalar others = row.share[0] + row.share[1] + row.share[2];
  if (active == Axis::parts) {
    row.lower = row.upper = others;
    return row;
  }
  part[active].lower = std::max(-infinity, part[active].lower + others);
  part[active].upper = std::min(infinity, part[active].upper + others);
  return single(row, active, part[active]);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
