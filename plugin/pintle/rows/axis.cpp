#include <pintle/rows/axis.h>

#include <pintle/equations/impulse.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Doubles throughout: a rigid part is a slope of a millionth of K.
struct Part {
  double target = 0, softness = 0, lower = 0, upper = 0;
  bool rigid = true;  // Bullet's solver can run it as a row

  double at(double u) const { return std::clamp((target - u) / softness, lower, upper); }
  double begin() const { return target - softness * upper; }
  double end() const { return target - softness * lower; }
};

constexpr double unbounded = infinity;
constexpr double rigid_softness = 1e-6;
// Bullet iterates a soft row by lambda <- rhs - cfm lambda, which leaves cfm^n of the answer after n
// iterations. Softer springs than this are solved here, and written as the impulse that they are.
constexpr double max_spring_cfm = 0.1;

Part rigidPart(double target, double cfm, double lower, double upper, double K) {
  Part part;
  part.target = target;
  part.softness = std::max(cfm, rigid_softness) * K;
  part.lower = lower;
  part.upper = upper;
  part.rigid = cfm < 1;
  return part;
}

Part springPart(const Spring& spring, double error, double dt, double K, double lower,
                double upper) {
  const auto soft =
      equations::softness_by_frequency<double>(spring.angular_frequency, spring.damping_ratio, dt, K);
  Part part = rigidPart(-equations::baumgarte(error, soft.beta, dt), soft.gamma / dt / K, lower,
                        upper, K);
  part.rigid = soft.gamma / dt <= max_spring_cfm * K;
  return part;
}

Part limitPart(const Axis& axis, const AxisMotion& m, double dt, AxisRow& row) {
  const bool at_low =
      m.position <= axis.low || (m.position < axis.high && m.free_velocity < 0);
  // Towards the inside is positive from here on, for both sides.
  const double side = at_low ? 1 : -1;
  const double gap = side * (double(m.position) - double(at_low ? axis.low : axis.high));
  const double inward = side * m.velocity;
  const bool locked = axis.locked();
  const double lower = locked || !at_low ? -unbounded : 0, upper = locked || at_low ? unbounded : 0;

  if (axis.limit_spring.angular_frequency > 0) {
    if (gap > 0 && !locked) return {};
    return springPart(axis.limit_spring, side * gap, dt, m.K, lower, upper);
  }
  double speed;
  if (gap > 0 && !locked) {
    if (gap > m.max_motion) return {};
    // Not there yet: the step may close the gap, and no more. Bullet's softness means nothing here.
    speed = -gap / dt;
    row.incoming = Scalar(std::max(0., -inward));
    if (m.incoming > 0 && gap < 0.1 * m.incoming * dt) {
      speed = axis.bias * axis.relaxation * m.incoming;
      row.incoming = 0;
    }
    return rigidPart(side * speed, 0, lower, upper, m.K);
  }
  speed = -m.fps * m.limit_erp * gap;
  // As in Bullet: a rebound if the joint comes in, of the speed with which it did.
  const double incoming = std::max(double(m.incoming), -inward);
  if (axis.relaxation > 0 && incoming > 0) speed = std::max(speed, axis.relaxation * incoming);
  return rigidPart(side * speed * axis.bias, m.limit_cfm, lower, upper, m.K);
}

Part motorPart(const Axis& axis, const AxisMotion& m, double dt) {
  if (axis.drive == Axis::Drive::velocity)
    return rigidPart(double(m.motor_factor) * axis.motor_velocity, m.motor_cfm,
                     -axis.max_motor_impulse, axis.max_motor_impulse, m.K);
  const double bound = axis.max_servo_force * dt;
  return springPart(axis.servo_spring, double(m.position) - axis.servo_target, dt, m.K, -bound,
                    bound);
}

// Where the free motion u = u_free + K Lambda meets the sum of the parts.
double meet(const Part* part, const bool* on, double u_free, double K) {
  double ends[2 * Axis::parts];
  int n = 0;
  const auto insert = [&](double end) {
    int i = n++;
    for (; i > 0 && ends[i - 1] > end; --i) ends[i] = ends[i - 1];
    ends[i] = end;
  };
  for (int i = 0; i < Axis::parts; ++i) {
    if (!on[i]) continue;
    if (part[i].upper < unbounded) insert(part[i].begin());
    if (part[i].lower > -unbounded) insert(part[i].end());
  }
  const auto excess = [&](double u) {
    double impulse = 0;
    for (int i = 0; i < Axis::parts; ++i)
      if (on[i]) impulse += part[i].at(u);
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

}  // namespace

AxisRow solveAxis(const Axis& axis, const AxisMotion& m) {
  AxisRow row;
  if (!(m.K > 0)) return row;  // neither body can move
  const double dt = 1. / m.fps, K = m.K;
  Part part[Axis::parts];
  bool on[Axis::parts] = {axis.drive != Axis::Drive::off, axis.max_friction > 0, axis.limited()};
  if (on[Axis::limit]) {
    part[Axis::limit] = limitPart(axis, m, dt, row);
    on[Axis::limit] = part[Axis::limit].softness > 0;
  }
  if (on[Axis::motor]) part[Axis::motor] = motorPart(axis, m, dt);
  if (on[Axis::friction])
    part[Axis::friction] = rigidPart(0, 0, -axis.max_friction * dt, axis.max_friction * dt, K);

  const int count = on[0] + on[1] + on[2];
  if (count == 0) return row;
  int active = on[0] ? 0 : on[1] ? 1 : 2;
  // A single rigid part is a row as it stands.
  if (count > 1 || !part[active].rigid) {
    const double u = meet(part, on, m.free_velocity, K);
    double nearest = unbounded, others = 0;
    active = Axis::parts;
    for (int i = 0; i < Axis::parts; ++i) {
      if (!on[i]) continue;
      row.share[i] = Scalar(part[i].at(u));
      // The rigid part that u is on, or else the one that it would come to first.
      const double away = std::max({0., part[i].begin() - u, u - part[i].end()});
      if (part[i].rigid && away < nearest) {
        nearest = away;
        active = i;
      }
    }
    for (int i = 0; i < Axis::parts; ++i)
      if (i != active) others += row.share[i];
    if (active == Axis::parts) {
      row.lower = row.upper = Scalar(others);
      return row;
    }
    part[active].lower += others;
    part[active].upper += others;
    row.share[active] = 0;
  }
  row.active = active;
  row.target = Scalar(part[active].target);
  const double cfm = part[active].softness / K;
  row.cfm = cfm > rigid_softness ? Scalar(cfm) : Scalar(0);
  row.lower = Scalar(std::max(part[active].lower, -unbounded));
  row.upper = Scalar(std::min(part[active].upper, unbounded));
  return row;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
