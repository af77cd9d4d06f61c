#include <pintle/solver/step_log.h>

#include <pintle/solver/uses_exact_solver.h>

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <ostream>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

double kineticEnergy(const btRigidBody& body) {
  const btVector3 &v = body.getLinearVelocity(), &diagonal = body.getInvInertiaDiagLocal(),
                  w = body.getAngularVelocity() * body.getCenterOfMassTransform().getBasis();
  double energy = double(v.length2()) / double(body.getInvMass());
  for (int i = 0; i < 3; ++i)
    if (diagonal[i] > 0) energy += double(w[i] * w[i]) / double(diagonal[i]);
  return energy / 2;
}

double potentialEnergy(const btRigidBody& body, double dt) {
  const btVector3 &g = body.getGravity(), &x = body.getCenterOfMassPosition(),
                  &v = body.getLinearVelocity();
  return -(double(g.dot(x)) - dt / 2 * double(g.dot(v))) / double(body.getInvMass());
}

}  // namespace

StepLog::StepLog(const btDynamicsWorld& world, std::ostream& out) : m_world(world), m_out(out) {
  lastStep(world);  // throws
  out << "time,kinetic,potential,work,ledger,ledger_limit,residual,open,tier,not_converged,"
         "components\n";
}

void StepLog::write() {
  const double dt =
      double(const_cast<btDynamicsWorld&>(m_world).getSolverInfo().m_timeStep);  // of the last step
  double kinetic = 0, potential = 0;
  const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    const btRigidBody* const body = btRigidBody::upcast(objects[i]);
    if (body == nullptr || !(body->getInvMass() > 0)) continue;
    kinetic += kineticEnergy(*body);
    potential += potentialEnergy(*body, dt);
  }
  m_time += dt;
  const StepReport step = lastStep(m_world);
  m_out << m_time << ',' << kinetic << ',' << potential << ',' << step.work << ',' << step.ledger
        << ',' << step.ledger_limit << ',' << step.residual << ',' << step.open << ',' << step.tier
        << ',' << step.not_converged << ',' << step.components << '\n';
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
