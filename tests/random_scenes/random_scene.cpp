#include "random_scene.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>
#include <pintle/body_pair.h>
#include <pintle/rows/row.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <sstream>
#include <vector>

#include "../unit/kinetic_energy.h"
#include "../unit/support.h"

namespace random_scenes {
namespace {

using support::Random;
using support::scalar;
using support::vec;

using Joint = std::unique_ptr<btTypedConstraint>;

struct Ends {
  btRigidBody &a, &b;
  btTransform in_a, in_b;
};

template <class J>
std::unique_ptr<J> of(const Ends& e) {
  return std::make_unique<J>(e.a, e.b, e.in_a, e.in_b);
}
template <class J>
std::unique_ptr<J> ofStock(const Ends& e) {
  return std::make_unique<J>(e.a, e.b, e.in_a, e.in_b, true);
}
double lengthOf(const Ends& e) {
  return double((e.a.getCenterOfMassTransform() * e.in_a.getOrigin() -
                 e.b.getCenterOfMassTransform() * e.in_b.getOrigin())
                    .length());
}
std::unique_ptr<pintle::DistanceJoint> rod(const Ends& e) {
  return std::make_unique<pintle::DistanceJoint>(e.a, e.b, e.in_a.getOrigin(), e.in_b.getOrigin(),
                                                 scalar(lengthOf(e)));
}

struct Kind {
  const char* name;
  bool has_length;  ///< its pivots start apart
  Joint (*make)(const Ends&, Random&);
};

const Kind all_kinds[] = {
    {"ball", false,
     [](const Ends& e, Random&) -> Joint {
       return std::make_unique<pintle::BallJoint>(e.a, e.b, e.in_a.getOrigin(), e.in_b.getOrigin());
     }},
    {"hinge", false,
     [](const Ends& e, Random&) -> Joint { return of<pintle::QuaternionHinge>(e); }},
    {"limited hinge", false,
     [](const Ends& e, Random& r) -> Joint {
       auto hinge = of<pintle::QuaternionHinge>(e);
       hinge->setLimit(scalar(r.uniform(-1, 0)), scalar(r.uniform(0, 1)));
       return hinge;
     }},
    {"hinge with friction", false,
     [](const Ends& e, Random& r) -> Joint {
       auto hinge = of<pintle::QuaternionHinge>(e);
       hinge->setLimit(scalar(r.uniform(-1, 0)), scalar(r.uniform(0, 1)));
       hinge->setFriction(scalar(std::pow(10, r.uniform(-2, 1))));
       return hinge;
     }},
    {"dot hinge", false, [](const Ends& e, Random&) -> Joint { return of<pintle::DotHinge>(e); }},
    {"two-point hinge", false,
     [](const Ends& e, Random&) -> Joint { return of<pintle::TwoPointHinge>(e); }},
    {"fixed", false, [](const Ends& e, Random&) -> Joint { return of<pintle::FixedJoint>(e); }},
    {"slider", false,
     [](const Ends& e, Random& r) -> Joint {
       auto slider = of<pintle::SliderJoint>(e);
       slider->setLowerLinLimit(scalar(r.uniform(-0.5, 0)));
       slider->setUpperLinLimit(scalar(r.uniform(0, 0.5)));
       slider->setLowerAngLimit(scalar(r.uniform(-1, 0)));
       slider->setUpperAngLimit(scalar(r.uniform(0, 1)));
       return slider;
     }},
    {"universal", false,
     [](const Ends& e, Random&) -> Joint { return of<pintle::UniversalJoint>(e); }},
    {"constant velocity", false,
     [](const Ends& e, Random&) -> Joint { return of<pintle::ConstantVelocityJoint>(e); }},
    {"cone-twist", false,
     [](const Ends& e, Random& r) -> Joint {
       auto cone = of<pintle::ConeTwistJoint>(e);
       cone->setLimit(scalar(r.uniform(0.2, 1)), scalar(r.uniform(0.2, 1)),
                      scalar(r.uniform(0.2, 1)));
       return cone;
     }},
    {"wedge", false,
     [](const Ends& e, Random& r) -> Joint {
       auto wedge = of<pintle::WedgeJoint>(e);
       wedge->setLimit(scalar(r.uniform(-1, -0.1)), scalar(r.uniform(0.1, 1)));
       return wedge;
     }},
    {"rod", true, [](const Ends& e, Random&) -> Joint { return rod(e); }},
    {"rope", true,
     [](const Ends& e, Random& r) -> Joint {
       auto rope = rod(e);
       rope->setLimit(0, scalar(lengthOf(e) * r.uniform(1, 1.5)));
       return rope;
     }},
    {"strut", true,
     [](const Ends& e, Random& r) -> Joint {
       auto strut = rod(e);
       strut->setLimit(scalar(lengthOf(e) * r.uniform(0.5, 1)),
                       scalar(lengthOf(e) * r.uniform(1, 1.5)));
       return strut;
     }},
    {"stock ball", false,
     [](const Ends& e, Random&) -> Joint {
       return std::make_unique<btPoint2PointConstraint>(e.a, e.b, e.in_a.getOrigin(),
                                                        e.in_b.getOrigin());
     }},
    {"stock hinge", false,
     [](const Ends& e, Random& r) -> Joint {
       auto hinge = of<btHingeConstraint>(e);
       if (r.uniform(0, 1) < 0.5)
         hinge->setLimit(scalar(r.uniform(-1, 0)), scalar(r.uniform(0, 1)));
       else
         hinge->setLimit(1, -1);
       return hinge;
     }},
    {"stock slider", false,
     [](const Ends& e, Random& r) -> Joint {
       auto slider = ofStock<btSliderConstraint>(e);
       slider->setLowerLinLimit(scalar(r.uniform(-0.5, 0)));
       slider->setUpperLinLimit(scalar(r.uniform(0, 0.5)));
       return slider;
     }},
    {"stock fixed", false,
     [](const Ends& e, Random&) -> Joint { return of<btFixedConstraint>(e); }},
    {"stock cone-twist", false,
     [](const Ends& e, Random& r) -> Joint {
       auto cone = of<btConeTwistConstraint>(e);
       cone->setLimit(scalar(r.uniform(0.2, 1)), scalar(r.uniform(0.2, 1)),
                      scalar(r.uniform(0.2, 1)));
       return cone;
     }},
    {"stock 6-dof", false,
     [](const Ends& e, Random& r) -> Joint {
       auto joint = ofStock<btGeneric6DofConstraint>(e);
       joint->setLinearLowerLimit(vec(0, 0, r.uniform(-0.3, 0)));
       joint->setLinearUpperLimit(vec(0, 0, r.uniform(0, 0.3)));
       joint->setAngularLowerLimit(vec(r.uniform(-0.5, 0), 0, -1));
       joint->setAngularUpperLimit(vec(r.uniform(0, 0.5), 0, 1));
       return joint;
     }},
    {"stock 6-dof spring 2", false,
     [](const Ends& e, Random& r) -> Joint {
       auto joint = of<btGeneric6DofSpring2Constraint>(e);
       joint->setLinearLowerLimit(vec(0, 0, r.uniform(-0.3, 0)));
       joint->setLinearUpperLimit(vec(0, 0, r.uniform(0, 0.3)));
       joint->setAngularLowerLimit(vec(r.uniform(-0.5, 0), 0, 0));
       joint->setAngularUpperLimit(vec(r.uniform(0, 0.5), 0, 0));
       return joint;
     }},
};
constexpr int kind_count = int(std::size(all_kinds));

bool chance(Random& random, double part) { return random.uniform(0, 1) < part; }
double power(Random& random, double low, double high) {
  return std::pow(10, random.uniform(low, high));
}

class World {
 public:
  explicit World(const Scene& scene)
      : m_scene(scene),
        m_random(scene.seed),
        m_world(&m_dispatcher, &m_broadphase, &m_solver, &m_configuration) {
    m_world.setGravity(vec(0, 0, -9.81));
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
  void take(Joint joint);
  /// At a point of the world, held by both.
  void joinAt(btRigidBody& a, btRigidBody& b, const btVector3& at);
  const Kind& kind() {
    return all_kinds[m_scene.kind >= 0
                         ? m_scene.kind
                         : std::min(kind_count - 1, int(m_random.uniform(0, kind_count)))];
  }
  double mass() { return power(m_random, -m_scene.mass_decades, m_scene.mass_decades); }
  double open() const;

  const Scene& m_scene;
  Random m_random;
  btDefaultCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher{&m_configuration};
  btDbvtBroadphase m_broadphase;
  pintle::ExactJointSolver m_solver;
  std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
  std::vector<std::unique_ptr<btRigidBody>> m_bodies;
  std::vector<Joint> m_joints;
  btDiscreteDynamicsWorld m_world;
};

btRigidBody& World::add(double mass, const btTransform& pose) {
  const btVector3 half =
      vec(m_random.uniform(0.05, 0.25), m_random.uniform(0.05, 0.25), m_random.uniform(0.05, 0.25));
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
  take(kind().make({a, b, in_a, in_b}, m_random));
}

void World::take(Joint joint) {
  if (m_scene.threshold > 0) joint->setBreakingImpulseThreshold(scalar(m_scene.threshold));
  m_world.addConstraint(joint.get(), true);
  m_joints.push_back(std::move(joint));
}

void World::joinAt(btRigidBody& a, btRigidBody& b, const btVector3& at) {
  const btTransform frame(m_random.pose(1).getRotation(), at);
  join(a, b, a.getCenterOfMassTransform().inverse() * frame,
       b.getCenterOfMassTransform().inverse() * frame);
}

btRigidBody& World::addBeside(btRigidBody& to, double mass) {
  const Kind& of = kind();
  const btTransform in_a(btQuaternion::getIdentity(), m_random.vector(0.3)),
      in_b(m_random.pose(1).getRotation(), m_random.vector(0.3));
  btTransform pose = to.getCenterOfMassTransform() * in_a * in_b.inverse();
  if (of.has_length)
    pose.setOrigin(pose.getOrigin() + m_random.unit() * scalar(m_random.uniform(0.2, 1)));
  if (m_scene.overlap > 0) pose.setOrigin(pose.getOrigin() + m_random.vector(m_scene.overlap));
  btRigidBody& body = add(mass, pose);
  take(of.make({to, body, in_a, in_b}, m_random));
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
        btTransform pose((m_random.pose(1).getRotation()), (from + to) / 2);
        if (m_scene.overlap > 0)
          pose.setOrigin(pose.getOrigin() + m_random.vector(m_scene.overlap));
        btRigidBody& body = add(massOf(i), pose);
        joinAt(*last, body, from);
        last = &body;
      }
      joinAt(*last, post, corner(n));
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
      return;
    }
  }
}

double World::open() const {
  double largest = 0;
  for (const auto& constraint : m_joints) {
    const auto* const joint = dynamic_cast<const pintle::Joint*>(constraint.get());
    if (joint == nullptr || !joint->isEnabled()) continue;
    pintle::RowMemory<pintle::max_joint_rows, pintle::max_joint_rows> memory;
    pintle::Rows rows(memory);
    joint->addRows(pintle::BodyPair(joint->getRigidBodyA(), joint->getRigidBodyB()), rows);
    for (int i = 0; i < rows.equalities(); ++i)
      largest = std::max(largest, std::abs(double(rows[i].position)));
  }
  return largest;
}

Outcome World::play(std::ostream* log) {
  Outcome out;
  const double dt = 1 / m_scene.hz;
  const int steps = int(std::min(2 * m_scene.hz, 300.));
  double energy = 0;
  std::vector<btMatrix3x3> basis(m_bodies.size());
  std::vector<double> before(m_bodies.size()), fall(m_bodies.size());
  std::vector<btVector3> place(m_bodies.size());
  for (int i = 0; i < steps; ++i) {
    double with_forces = 0;  // J: the kinetic energy before joints act
    for (size_t k = 0; k < m_bodies.size(); ++k) {
      basis[k] = m_bodies[k]->getCenterOfMassTransform().getBasis();
      place[k] = m_bodies[k]->getCenterOfMassPosition();
      before[k] = support::kineticEnergy(*m_bodies[k], basis[k]);
      fall[k] = double(m_bodies[k]->getLinearVelocity().z());
      with_forces += before[k];
      if (m_bodies[k]->getInvMass() > 0)
        with_forces += (9.81 * dt / 2 - fall[k]) * 9.81 * dt / double(m_bodies[k]->getInvMass());
    }
    out.peak = std::max(out.peak, with_forces);
    m_world.stepSimulation(scalar(dt), 0, scalar(dt));
    ++out.steps;
    double after = 0;
    for (size_t k = 0; k < m_bodies.size(); ++k) {
      const btRigidBody& body = *m_bodies[k];
      if (!support::is_finite(body)) {
        out.finite = false;
        return out;
      }
      if (!(body.getInvMass() > 0)) continue;
      const btVector3 moved =
          body.getCenterOfMassPosition() - place[k] - body.getLinearVelocity() * scalar(dt);
      out.jump = std::max(out.jump, double(moved.length()));
      // By the inertia of the start: what it gains by turning with its velocity kept is Bullet's integrator's, not its joints'.
      const double now = support::kineticEnergy(body, basis[k]);
      after += now;
      // Kinetic energy, and the work of the weight along the mean velocity. (What poses are moved by has no energy.)
      const double weight = 9.81 / double(body.getInvMass()) * double(body.getLinearFactor().z());
      // In the first step joints put right what velocities they are given: it is measured from those that forces lead to.
      const double mean =
          i == 0 ? fall[k] - 9.81 * dt / 2 : (fall[k] + double(body.getLinearVelocity().z())) / 2;
      energy += now - before[k] + weight * dt * mean;
    }
    out.peak = std::max(out.peak, after);
    out.gain = std::max(out.gain, energy);
    const pintle::StepReport report = m_solver.lastStep();
    out.not_converged += report.not_converged > 0;
    const double gap = open();
    if (m_scene.overlap == 0) out.open = std::max(out.open, gap);
    if (log != nullptr)
      *log << i << " kinetic " << after << " energy " << energy << " open " << gap << " newton "
           << report.newton_steps << " factors " << report.factorisations << " tier 2 "
           << report.second_tier << " not converged " << report.not_converged << '\n';
  }
  return out;
}

const char* nameOf(int kind) { return kind < 0 ? "mixed" : all_kinds[kind].name; }

const char* const shapes[] = {"chain", "tree", "loop", "cable", "net", "star"};

}  // namespace

Scene makeScene(unsigned seed) {
  Random random(seed ^ 0x9e3779b9u);
  Scene scene = {};
  scene.seed = seed;
  scene.shape = Shape(std::min(5, int(random.uniform(0, 6))));
  scene.kind = std::min(kind_count - 1, int(random.uniform(0, kind_count * 1.25)));
  if (random.uniform(0, 1) < 0.2) scene.kind = -1;
  scene.bodies = 1 + int(random.uniform(0, 8));
  if (scene.shape == Shape::cable || scene.shape == Shape::loop) scene.bodies += 2;
  if (scene.shape == Shape::net) scene.bodies = chance(random, 0.5) ? 4 : 9;
  scene.hz = chance(random, 0.5) ? (chance(random, 0.5) ? 60 : 120)
                                 : std::round(15 * power(random, 0, 1.82));
  scene.mass_decades = random.uniform(0, 3);
  scene.load = chance(random, 0.2) ? power(random, 0, 6) : 1;
  if (scene.load > 1) scene.mass_decades = 0;
  scene.speed = random.uniform(0, 5);
  scene.erp = chance(random, 0.5) ? 0.2 : random.uniform(0, 1);
  scene.cfm = chance(random, 0.7) ? 0 : power(random, -9, -2);
  scene.contacts = chance(random, 0.3);
  scene.friction = chance(random, 0.7);
  scene.threshold = chance(random, 0.15) ? power(random, -1, 2) : 0;
  scene.locks = chance(random, 0.15);
  scene.kinematic = chance(random, 0.15);
  scene.overlap = chance(random, 0.15) ? random.uniform(0, 0.3) : 0;
  return scene;
}

std::string describe(const Scene& s) {
  std::ostringstream out;
  out << s.seed << ": " << shapes[int(s.shape)] << " of " << nameOf(s.kind) << ", " << s.bodies
      << " bodies, " << s.hz << " Hz, masses of " << s.mass_decades << " decades, load " << s.load
      << ", speed " << s.speed << ", ERP " << s.erp << ", CFM " << s.cfm;
  if (s.contacts) out << (s.friction ? ", contacts with friction" : ", contacts");
  if (s.threshold > 0) out << ", breaks at " << s.threshold;
  if (s.locks) out << ", locked factors";
  if (s.kinematic) out << ", kinematic";
  if (s.overlap > 0) out << ", starts " << s.overlap << " m apart";
  return out.str();
}

Outcome play(const Scene& scene, std::ostream* log) { return World(scene).play(log); }

}  // namespace random_scenes
