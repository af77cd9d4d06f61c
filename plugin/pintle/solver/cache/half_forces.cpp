#include <pintle/solver/cache/half_forces.h>

#include <pintle/solver/linalg/memory.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

const MotionOfBody& MotionsOfBody::lastOf(const btRigidBody& body, const Vector6d& v, double dt) {
  Vector6d left = last.v;
  left.head<3>() *= std::pow(1 - double(body.getLinearDamping()), dt);
  left.tail<3>() *= std::pow(1 - double(body.getAngularDamping()), dt);
  const double rounding = 64 * double(SIMD_EPSILON) * (left.norm() + last.second_half.norm());
  if ((v - left).norm() > rounding) last = {};
  return last;
}

bool mayActInHalves(const Island& island, const Component& component) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    if (joint.keeps_for_rebound) return false;
    for (int i = 0; i < joint.rows; ++i) {
      const AxisLaw& law = island.rows[size_t(joint.first_row + i)].law;
      for (int k = 0; k < law.parts(); ++k)
        if (law.part(k).softness > 0 || law.part(k).rebounds()) return false;
    }
  }
  return true;
}

Vector6d velocityAtEnd(const IslandBody& body, const Matrix3d& turn, const Vector6d& way) {
  Vector6d v = way;
  if (body.isRotor()) {
    const Vector3d L = turn.transpose() * (body.inertia * way.tail<3>());
    v.tail<3>() = turn * (body.inverse_inertia * L);
  }
  return v + body.by_forces_at_end;
}

bool HalfForces::areTouched() const {
  return std::any_of(m_bodies.begin(), m_bodies.end(),
                     [](const Body& of) { return of.motions->is_touched; });
}

void HalfForces::split(Island& island, const Component& component) {
  for (int i = 0; i < component.bodies; ++i) {
    IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Body& whole = m_bodies[size_t(i)];
    const MotionOfBody& last = whole.motions->last;
    body.acts_in_halves = true;
    body.by_forces = whole.by_forces - whole.half;
    body.by_forces_at_end = whole.half;
    // Gravity may have changed.
    if (last.gravity == MotionOfBody::Gravity::in_halves)
      body.by_forces.head<3>() += last.dt / island.dt * whole.half.head<3>() - last.second_half;
    if (last.gravity == MotionOfBody::Gravity::whole) body.by_forces += whole.half;
    body.v0 = whole.v0;
    body.v_free = body.v0 + body.by_forces;
    body.gyroscopic_work = 0;
  }
}

void HalfForces::join(Island& island, const Component& component) {
  for (int i = 0; i < component.bodies; ++i) {
    IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Body& whole = m_bodies[size_t(i)];
    body.acts_in_halves = false;
    body.v0 = whole.v0;
    body.v_free = whole.v_free;
    body.by_forces = whole.by_forces;
    body.gyroscopic_work = whole.gyroscopic_work;
    const MotionOfBody& last = whole.motions->last;
    if (last.gravity != MotionOfBody::Gravity::in_halves) continue;
    body.v0.head<3>() -= last.second_half;
    body.v_free.head<3>() -= last.second_half;
  }
}

void HalfForces::keep(const Island& island, const Component& component, const Vector6d* v) {
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    MotionOfBody& now = m_bodies[size_t(i)].motions->now;
    now.gravity =
        body.acts_in_halves ? MotionOfBody::Gravity::in_halves : MotionOfBody::Gravity::whole;
    now.second_half = m_bodies[size_t(i)].half.head<3>();
    now.v = v[i];
    now.dt = island.dt;
  }
}

size_t HalfForces::bytes() const { return bytesOf(m_bodies); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
