#include "energy_book.h"

#include <LinearMath/btTransformUtil.h>

#include <algorithm>

#include "../unit/kinetic_energy.h"
#include "../unit/support.h"

namespace random_scenes {
namespace {

using support::gravity;
using support::weightOf;

bool moves(const btRigidBody& body) { return body.getInvMass() > 0; }

}  // namespace

EnergyBook::EnergyBook(const Bodies& bodies, double dt)
    : m_bodies(bodies), m_dt(dt), m_start(bodies.size()) {
  by_velocities = -weight() * gravity * dt * dt / 8;
}

double EnergyBook::weight() const {
  double sum = 0;
  for (const auto& body : m_bodies)
    if (moves(*body)) sum += weightOf(*body);
  return sum;
}

void EnergyBook::beginStep() {
  double with_forces = 0;  // before joints act
  for (size_t k = 0; k < m_bodies.size(); ++k) {
    const btRigidBody& body = *m_bodies[k];
    if (!moves(body)) continue;
    Start& start = m_start[k];
    start.pose = body.getCenterOfMassTransform();
    start.energy = support::kineticEnergy(body, start.pose.getBasis());
    start.fall = double(body.getLinearVelocity().z());
    with_forces += start.energy + (gravity * m_dt / 2 - start.fall) * weightOf(body) * m_dt;
  }
  peak = std::max(peak, with_forces);
}

void EnergyBook::endStep() {
  kinetic = jump = 0;
  for (size_t k = 0; k < m_bodies.size(); ++k) {
    const btRigidBody& body = *m_bodies[k];
    if (!moves(body)) continue;
    const Start& start = m_start[k];
    const btVector3 &v = body.getLinearVelocity(), &w = body.getAngularVelocity();
    const double now = support::kineticEnergy(body, body.getCenterOfMassTransform().getBasis());
    kinetic += now;
    by_velocities += now - start.energy + weightOf(body) * m_dt * (start.fall + double(v.z())) / 2;
    btTransform led;
    btTransformUtil::integrateTransform(start.pose, v, w, support::scalar(m_dt), led);
    const btVector3 moved = body.getCenterOfMassPosition() - led.getOrigin();
    jump = std::max(jump, double(moved.length()));
    height += weightOf(body) * double(moved.z());
  }
  peak = std::max(peak, kinetic);
}

}  // namespace random_scenes
