#include "random_scene.h"

#include <pintle/body_pair.h>
#include <pintle/rows/row.h>
#include <pintle/solver/exact_joint_solver.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "../unit/contact_depth.h"
#include "../unit/support.h"
#include "draws.h"
#include "energy_book.h"
#include "random_joints.h"

namespace random_scenes {
namespace {

using support::Random;
using support::scalar;
using support::vec;

class World {
 public:
  explicit World(const Scene& scene)
      : m_scene(scene),
        m_random(scene.seed),
        m_of_variant(scene.seed ^ 0x85ebca6bu),
        m_world(&m_dispatcher, &m_broadphase, &m_solver, &m_configuration) {
    m_world.setGravity(vec(0, 0, -9.81));
    m_solver.setUpgradesBulletJoints(false);  // they write their rows themselves
    btContactSolverInfo& info = m_world.getSolverInfo();
    info.m_minimumSolverBatchSize = 1;
    info.m_erp = scalar(scene.erp);
    info.m_globalCfm = scalar(scene.cfm);
    // Contacts that push apart by velocities would feed: let them move poses.
    info.m_splitImpulsePenetrationThreshold = scalar(1e9);
    build();
  }
  ~World() {
    for (const auto& joint : m_joints) m_world.removeConstraint(joint.get());
    for (const auto& body : m_bodies) m_world.removeRigidBody(body.get());
  }

  Outcome play(std::ostream* log);

 private:
  void build();
  btRigidBody& add(double mass, const btTransform& pose);
  btRigidBody& addBeside(btRigidBody& to, double mass);
  void join(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b);
  void take(const Kind& of, const Making& making);
  void setOwn(btTypedConstraint& joint) const;
  /// At a point of the world, held by both.
  void joinAt(btRigidBody& a, btRigidBody& b, const btVector3& at);
  /// m: of a body that is not to start where its joints hold it.
  btVector3 offset();
  void pullApart(const std::vector<btRigidBody*>& bodies);
  const Kind& kind() {
    return kindOf(m_scene.kind >= 0
                      ? m_scene.kind
                      : std::min(kindCount() - 1, int(m_random.uniform(0, kindCount()))));
  }
  double mass() { return power(m_random, -m_scene.mass_decades, m_scene.mass_decades); }
  double open() const;
  double depth();

  const Scene& m_scene;
  Random m_random, m_of_variant;
  btDefaultCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher{&m_configuration};
  btDbvtBroadphase m_broadphase;
  pintle::ExactJointSolver m_solver;
  std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
  std::vector<std::unique_ptr<btRigidBody>> m_bodies;
  std::vector<Joint> m_joints;
  std::vector<const char*> m_kinds;  ///< of the joints, as they were made
  double m_apart = 0;                ///< m: the sum of what joints have open at the start
  btDiscreteDynamicsWorld m_world;
};

btRigidBody& World::add(double mass, const btTransform& pose) {
  const btVector3 half = vec(0.15, 0.15, 0.15) + m_random.vector(0.1);
  m_shapes.push_back(std::make_unique<btBoxShape>(half));
  btVector3 inertia(0, 0, 0);
  if (mass > 0) m_shapes.back()->calculateLocalInertia(scalar(mass), inertia);
  btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, m_shapes.back().get(),
                                                inertia);
  info.m_startWorldTransform = pose;
  info.m_friction = m_scene.friction ? scalar(0.5) : 0;
  m_bodies.push_back(std::make_unique<btRigidBody>(info));
  btRigidBody& body = *m_bodies.back();
  body.setActivationState(DISABLE_DEACTIVATION);
  // Bullet's gyroscopic torque and its integrator do not keep energy.
  body.setFlags(0);
  if (!(mass > 0) && m_scene.kinematic)
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  if (mass > 0 && m_scene.locks && chance(m_random, 0.5)) {
    const auto factor = [&] { return scalar(chance(m_random, 0.3) ? 0 : 1); };
    const btScalar x = factor(), y = factor(), z = factor();
    if (chance(m_random, 0.5))
      body.setLinearFactor(btVector3(x, y, z));
    else
      body.setAngularFactor(btVector3(x, y, z));
  }
  if (m_scene.contacts)
    m_world.addRigidBody(&body);
  else
    m_world.addRigidBody(&body, 0, 0);
  if (mass > 0) {
    body.setLinearVelocity(m_random.vector(m_scene.speed) * body.getLinearFactor());
    body.setAngularVelocity(m_random.vector(m_scene.speed) * body.getAngularFactor());
  }
  return body;
}

void World::join(btRigidBody& a, btRigidBody& b, const btTransform& in_a, const btTransform& in_b) {
  take(kind(), {a, b, in_a, in_b, m_scene.rubs, m_random});
}

void World::take(const Kind& of, const Making& making) {
  m_kinds.push_back(of.name);
  for (const auto make : {of.make, of.make_other}) {
    if (make == nullptr) continue;
    Joint joint = make(making);
    if (m_scene.threshold > 0) joint->setBreakingImpulseThreshold(scalar(m_scene.threshold));
    if (m_scene.has_own) setOwn(*joint);
    setVariant(*joint, m_scene.variant, m_of_variant);
    m_world.addConstraint(joint.get(), true);
    m_joints.push_back(std::move(joint));
  }
}

// Of all axes. A joint refuses those that it does not have.
void World::setOwn(btTypedConstraint& joint) const {
  const auto set = [&](int parameter, double value) {
    for (int axis = -1; axis < 6; ++axis) try {
        joint.setParam(parameter, scalar(value), axis);
      } catch (const std::invalid_argument&) {
      }
  };
  set(BT_CONSTRAINT_ERP, m_scene.own_erp);
  set(BT_CONSTRAINT_STOP_ERP, m_scene.own_stop_erp);
  set(BT_CONSTRAINT_CFM, m_scene.own_cfm);
  set(BT_CONSTRAINT_STOP_CFM, m_scene.own_stop_cfm);
}

void World::joinAt(btRigidBody& a, btRigidBody& b, const btVector3& at) {
  const btTransform frame(m_random.pose(1).getRotation(), at);
  join(a, b, a.getCenterOfMassTransform().inverse() * frame,
       b.getCenterOfMassTransform().inverse() * frame);
}

btVector3 World::offset() {
  const btVector3 by = m_random.vector(m_scene.overlap);
  m_apart += double(by.length());
  return by;
}

void World::pullApart(const std::vector<btRigidBody*>& bodies) {
  if (!(m_scene.overlap > 0)) return;
  for (btRigidBody* body : bodies) {
    btTransform pose = body->getCenterOfMassTransform();
    pose.setOrigin(pose.getOrigin() + offset());
    body->setCenterOfMassTransform(pose);
  }
}

btRigidBody& World::addBeside(btRigidBody& to, double mass) {
  const Kind& of = kind();
  const btTransform in_a(btQuaternion::getIdentity(), m_random.vector(0.3)),
      in_b = m_random.pose(0.3);
  btTransform pose = to.getCenterOfMassTransform() * in_a * in_b.inverse();
  if (of.has_length) {
    const double length = m_random.uniform(0.2, 1);
    pose.getOrigin() += m_random.unit() * scalar(length);
  }
  if (m_scene.overlap > 0) pose.setOrigin(pose.getOrigin() + offset());
  btRigidBody& body = add(mass, pose);
  take(of, {to, body, in_a, in_b, m_scene.rubs, m_random});
  return body;
}

void World::build() {
  const int n = m_scene.bodies;
  const auto massOf = [&](int i) { return mass() * (i == n - 1 ? m_scene.load : 1); };
  if (m_scene.contacts) {  // a floor
    m_shapes.push_back(std::make_unique<btStaticPlaneShape>(vec(0, 0, 1), scalar(-1.5)));
    m_bodies.push_back(std::make_unique<btRigidBody>(scalar(0), nullptr, m_shapes.back().get()));
    m_bodies.back()->setFriction(m_scene.friction ? scalar(0.5) : 0);
    m_world.addRigidBody(m_bodies.back().get());
  }
  const auto place = [](double x, double y, double z) {
    return btTransform(btQuaternion::getIdentity(), vec(x, y, z));
  };
  btRigidBody& post = add(0, place(0, 0, 0));
  std::vector<btRigidBody*> made;
  switch (m_scene.shape) {
    case Shape::chain:
    case Shape::tree:
      for (int i = 0; i < n; ++i) {
        btRigidBody& to = i == 0 ? post
                          : m_scene.shape == Shape::chain
                              ? *made.back()
                              : *made[size_t(m_random.uniform(0, i * 0.999))];
        made.push_back(&addBeside(to, massOf(i)));
      }
      return;
    case Shape::star: {
      btRigidBody& hub = addBeside(post, massOf(n - 1));
      for (int i = 0; i + 1 < n; ++i) addBeside(hub, mass());
      return;
    }
    case Shape::loop:
    case Shape::cable: {
      // Links from a post to another one, or back to the same.
      btRigidBody* last = &post;
      const bool closed = m_scene.shape == Shape::loop;
      const auto corner = [&](int i) {
        if (closed) {
          const double turn = 2 * scenes::pi * i / (n + 1), r = 0.1 * (n + 1);
          return vec(r * std::sin(turn), 0, r * std::cos(turn) - r);
        }
        return vec(0.5 * i, 0, -0.3 * std::min(i, n - i));
      };
      for (int i = 0; i < n; ++i) {
        const btVector3 from = corner(i), to = corner(i + 1);
        const btTransform pose(m_random.pose(1).getRotation(), (from + to) / 2);
        made.push_back(&add(massOf(i), pose));
        joinAt(*last, *made.back(), from);
        last = made.back();
      }
      joinAt(*last, post, corner(n));
      pullApart(made);
      return;
    }
    case Shape::net: {
      const int side = std::max(2, int(std::sqrt(double(n))));
      for (int i = 0; i < side * side; ++i)
        made.push_back(&add(massOf(i), place(0.5 * (i % side), 0.5 * (i / side), 0)));
      for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
          btRigidBody& here = *made[size_t(i * side + j)];
          if (j + 1 < side)
            joinAt(here, *made[size_t(i * side + j + 1)], vec(0.5 * j + 0.25, 0.5 * i, 0));
          if (i + 1 < side)
            joinAt(here, *made[size_t((i + 1) * side + j)], vec(0.5 * j, 0.5 * i + 0.25, 0));
        }
      joinAt(post, *made.front(), vec(0, 0, 0));
      joinAt(post, *made[size_t(side - 1)], vec(0.5 * (side - 1), 0, 0));
      pullApart(made);
      return;
    }
  }
}

double World::open() const {
  double largest = 0;
  for (const auto& constraint : m_joints) {
    const auto* const joint = dynamic_cast<const pintle::Joint*>(constraint.get());
    if (joint == nullptr || !constraint->isEnabled()) continue;
    pintle::RowMemory<pintle::max_joint_rows, pintle::max_joint_rows> memory;
    pintle::Rows rows(memory);
    joint->addRows(pintle::BodyPair(constraint->getRigidBodyA(), constraint->getRigidBodyB()),
                   rows);
    for (int i = 0; i < rows.equalities(); ++i)
      largest = std::max(largest, std::abs(double(rows[i].position)));
  }
  return largest;
}

// m: the sum of how deep bodies were in each other when the step began.
double World::depth() {
  double sum = 0;
  for (int i = 0; i < m_dispatcher.getNumManifolds(); ++i)
    sum += support::depthOf(*m_dispatcher.getManifoldByIndexInternal(i));
  return sum;
}

Outcome World::play(std::ostream* log) {
  Outcome out;
  const double dt = 1 / m_scene.hz;
  const int steps = int(std::min(2 * m_scene.hz, 300.));
  EnergyBook book(m_bodies, dt);
  if (log != nullptr) {
    *log << "joints:";
    for (const char* kind : m_kinds) *log << " [" << kind << ']';
    *log << '\n';
  }
  for (int i = 0; i < steps; ++i) {
    // What no joint holds any more is solved by Bullet's code, which may feed it.
    if (std::none_of(m_joints.begin(), m_joints.end(),
                     [](const Joint& joint) { return joint->isEnabled(); }))
      return out;
    book.beginStep();
    m_world.stepSimulation(scalar(dt), 0, scalar(dt));
    ++out.steps;
    out.finite = std::all_of(m_bodies.begin(), m_bodies.end(),
                             [](const auto& body) { return support::is_finite(*body); });
    if (!out.finite) return out;
    book.endStep();
    if (i == 0) out.lift = book.weight() * (m_apart + depth());
    out.peak = book.peak;
    out.jump = std::max(out.jump, book.jump);
    out.gain = std::max(out.gain, book.total());
    out.by_velocities = std::max(out.by_velocities, std::min(book.total(), book.by_velocities));
    const pintle::StepReport report = m_solver.lastStep();
    out.not_converged += report.not_converged > 0;
    const double gap = open();
    if (m_scene.overlap == 0) out.open = std::max(out.open, gap);
    if (log != nullptr)
      *log << i << " kinetic " << book.kinetic << " energy " << book.total() << " by velocities "
           << book.by_velocities << " height " << book.height << " work " << report.work
           << " ledger " << report.ledger << " of " << report.ledger_limit << " open " << gap
           << " moved " << book.jump << " newton " << report.newton_steps << " factors "
           << report.factorisations << " tier 2 " << report.second_tier << " tier 3 "
           << report.one_by_one << " not converged " << report.not_converged << '\n';
  }
  return out;
}

}  // namespace

Outcome play(const Scene& scene, std::ostream* log) { return World(scene).play(log); }

}  // namespace random_scenes
