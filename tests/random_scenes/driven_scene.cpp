#include "driven_scene.h"

#include <pintle/joints/ball_joint.h>

#include <btBulletDynamicsCommon.h>
#include <scenes/world.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>
#include <vector>

#include "../unit/contact_depth.h"
#include "../unit/support.h"
#include "draws.h"
#include "energy_book.h"

namespace random_scenes {
namespace {

using scenes::pose_at;
using support::frameWithX;
using support::frameWithZ;
using support::Random;
using support::scalar;
using support::vec;

/// m: a motor or a kinematic body moves by no more in a step. A contact begins up to a step late: so much deeper than another one.
constexpr double step_way = 0.006;
constexpr double thickness = 0.05;  // m, half, of links

class DrivenWorld : public support::EitherWorld {
 public:
  DrivenWorld(const DrivenScene& scene, const support::Contender& contender)
      : EitherWorld(contender, scene.hz, scene.iterations),
        m_scene(scene),
        m_random(scene.seed),
        m_ours(contender.ours) {
    // Contacts that push apart by velocities, as Bullet's do from 4 cm on, add energy: in passive scenes let them move poses.
    if (!scene.isDriven()) world.getSolverInfo().m_splitImpulsePenetrationThreshold = scalar(1e9);
    build();
    for (const auto& body : bodies) {
      // Bullet's gyroscopic torque and its integrator do not keep energy.
      body->setFlags(0);
      body->setFriction(scalar(std::sqrt(scene.friction)));  // Bullet takes the product of both
      body->setRestitution(scalar(std::sqrt(scene.restitution)));
    }
    noteOverlaps();
  }

  DrivenOutcome play(std::ostream* log);

 private:
  using Pair = std::pair<const btCollisionObject*, const btCollisionObject*>;

  void build();
  void buildMotors();
  void buildLinked();
  void buildJammed();
  void buildPushed();
  void buildBouncing();
  void buildLoop();

  double uniform(double low, double high) { return m_random.uniform(low, high); }
  double sign() { return chance(m_random, 0.5) ? 1 : -1; }
  double mass() { return power(m_random, -0.5, 0.5); }
  btRigidBody& addBox(double mass, const btVector3& half, const btVector3& x) {
    return add(mass, half, pose_at(x), true);
  }
  btRigidBody& addPost(const btVector3& x) { return add(0, vec(0.05, 0.05, 0.05), pose_at(x)); }
  void addFloor(double z) { addBox(0, vec(20, 20, 1), vec(0, 0, z - 1)); }
  /// A body that moves from its start along `way` and back, with no more speed than a motor.
  void addMoving(const btVector3& half, const btVector3& x, const btVector3& way);

  /// A motor or servo of the scene's strength. `speed`: m/s or rad/s; `target`: m or rad. Bullet's have no servos: their velocity leads to
  /// the target.
  template <class Hinge>
  void driveHinge(Hinge& hinge, double speed, double target);
  template <class Slider>
  void driveSlider(Slider& slider, double speed, double target);
  /// rad/s of a motor that moves a tip at such a distance.
  double speedOf(double lever) { return uniform(0.2, 1) * step_way * m_scene.hz / lever; }

  /// Links along x from the origin, on driven hinges; the last one. `axis`: of all.
  btRigidBody& addArm(const btVector3& axis, double direction);
  double armLength() const { return 2 * m_half * m_scene.bodies; }
  void ball(btRigidBody& a, btRigidBody& b, const btVector3& pivot, bool linked_collide = false);
  void startMoving(double speed);
  void noteOverlaps();
  static Pair pairOf(const btPersistentManifold& manifold) {
    return {std::min(manifold.getBody0(), manifold.getBody1()),
            std::max(manifold.getBody0(), manifold.getBody1())};
  }

  const DrivenScene& m_scene;
  Random m_random;
  const bool m_ours;
  double m_half = 0.2;  ///< m, of links
  double m_time = 0;    ///< s
  std::vector<std::function<void()>> m_before_step;
  std::set<Pair> m_overlap_at_start;
};

template <class Hinge>
void DrivenWorld::driveHinge(Hinge& hinge, double speed, double target) {
  const double strength = m_scene.strength;
  if (!m_scene.servos) {
    hinge.enableAngularMotor(true, scalar(speed), scalar(strength));
  } else if constexpr (std::is_base_of_v<pintle::Joint, Hinge>) {
    hinge.setMotorServo(scalar(target), scalar(0.5), 1, scalar(strength / dt));
  } else {
    hinge.enableAngularMotor(true, 0, scalar(strength));
    m_before_step.push_back([&hinge, target] { hinge.setMotorTarget(scalar(target), 1); });
  }
}

template <class Slider>
void DrivenWorld::driveSlider(Slider& slider, double speed, double target) {
  const double force = m_scene.strength / dt;
  if constexpr (std::is_base_of_v<pintle::Joint, Slider>) {
    if (m_scene.servos) {
      slider.setLinMotorServo(scalar(target), scalar(0.5), 1, scalar(force));
      return;
    }
  } else if (m_scene.servos) {
    m_before_step.push_back([&slider, target] {
      slider.setTargetLinMotorVelocity(scalar(target) - slider.getLinearPos());
    });
  }
  slider.setPoweredLinMotor(true);
  slider.setTargetLinMotorVelocity(scalar(speed));
  slider.setMaxLinMotorForce(scalar(force));
}

void DrivenWorld::addMoving(const btVector3& half, const btVector3& x, const btVector3& way) {
  btRigidBody& body = addKinematic(std::make_unique<btBoxShape>(half), pose_at(x));
  const double length = double(way.length()) / 2,
               frequency = std::min(3., step_way * m_scene.hz / length);  // rad/s
  m_before_step.push_back([this, &body, x, way, frequency] {
    body.setWorldTransform(pose_at(x + way * scalar((1 - std::cos(frequency * m_time)) / 2)));
  });
}

void DrivenWorld::ball(btRigidBody& a, btRigidBody& b, const btVector3& pivot,
                       bool linked_collide) {
  const btVector3 in_a = a.getCenterOfMassTransform().inverse() * pivot,
                  in_b = b.getCenterOfMassTransform().inverse() * pivot;
  if (m_ours)
    join(std::make_unique<pintle::BallJoint>(a, b, in_a, in_b), linked_collide);
  else
    join(std::make_unique<btPoint2PointConstraint>(a, b, in_a, in_b), linked_collide);
}

void DrivenWorld::startMoving(double speed) {
  for (const auto& body : bodies) {
    if (!(body->getInvMass() > 0)) continue;
    body->setLinearVelocity(m_random.vector(speed));
    body->setAngularVelocity(m_random.vector(speed));
  }
}

void DrivenWorld::noteOverlaps() {
  world.performDiscreteCollisionDetection();
  eachPair([&](const btPersistentManifold& pair) {
    if (support::depthOf(pair) > 0) m_overlap_at_start.insert(pairOf(pair));
  });
}

btRigidBody& DrivenWorld::addArm(const btVector3& axis, double direction) {
  m_half = uniform(0.15, 0.3);
  btRigidBody* last = &addPost(vec(0, 0, 0));
  for (int i = 0; i < m_scene.bodies; ++i) {
    btRigidBody& link =
        addBox(mass(), vec(m_half, thickness, thickness), vec(m_half * (2 * i + 1), 0, 0));
    const double speed = direction * speedOf(armLength()) / m_scene.bodies,
                 target = direction * uniform(0.2, 1);
    hinge(*last, link, frameWithZ(vec(2 * m_half * i, 0, 0), axis),
          [&](auto& of) { driveHinge(of, speed, target); });
    last = &link;
  }
  return *last;
}

// A driven arm or plate, and what stands in its way.
void DrivenWorld::buildMotors() {
  enum { fixed, at_rest, moving, dynamic };
  const int obstacle = std::min(3, int(uniform(0, 4)));
  const bool slides = chance(m_random, 0.3), level = chance(m_random, 0.5);
  // The way of its tip. What is dynamic is pressed on the floor, or pushed along it.
  const btVector3 way = level ? vec(0, 1, 0) : vec(0, 0, -1);
  const double gap = uniform(0, 0.05), half = 0.25;
  btVector3 tip = vec(0, 0, 0);
  double reach = thickness;
  if (slides) {
    btRigidBody& post = addPost(vec(0, 0, 0));
    reach = 0.1;
    btRigidBody& plate = addBox(mass(), vec(reach, reach, reach), tip);
    const double speed = speedOf(1), target = uniform(0.1, 0.5);
    slider(post, plate, frameWithX(tip, way), [&](auto& of) {
      of.setLowerLinLimit(-1);
      of.setUpperLinLimit(1);
      driveSlider(of, speed, target);
    });
  } else {
    // About z the tip moves along y, about y against z.
    addArm(level ? vec(0, 0, 1) : vec(0, 1, 0), 1);
    tip = vec(armLength() - 0.1, 0, 0);
  }
  const btVector3 x = tip + way * scalar(reach + gap + half), size = vec(half, half, half);
  switch (obstacle) {
    case fixed: addBox(0, size, x); break;
    case at_rest: addKinematic(std::make_unique<btBoxShape>(size), pose_at(x)); break;
    case moving: addMoving(size, x, way * scalar(-uniform(0.02, 0.1) - gap)); break;
    case dynamic:
      addFloor(double(x.z()) - half);
      addBox(mass(), size, x);
      break;
  }
}

// A chain of boxes that overlap by 5 cm, from a post or free on the floor.
void DrivenWorld::buildLinked() {
  const bool hangs = chance(m_random, 0.5), limits = chance(m_random, 0.5),
             balls = !m_scene.motors && chance(m_random, 0.3);
  const double half = 0.25, spacing = 0.45;
  addFloor(-0.06 - uniform(0, 0.3) - (hangs ? spacing * (m_scene.bodies + 1) : 0));
  const btVector3 along = hangs ? vec(0, 0, -1) : vec(1, 0, 0),
                  size = hangs ? vec(0.06, 0.06, half) : vec(half, 0.06, 0.06);
  btRigidBody* last = hangs ? &addBox(0, size, vec(0, 0, 0)) : nullptr;
  for (int i = 1; i <= m_scene.bodies; ++i) {
    const btVector3 x = along * scalar(spacing * i);
    btRigidBody& link = addBox(mass(), size, x);
    if (last != nullptr) {
      const btVector3 pivot = x - along * scalar(spacing / 2);
      const double speed = speedOf(half), phase = uniform(0, 2 * scenes::pi);
      if (balls)
        ball(*last, link, pivot, true);
      else
        hinge(
            *last, link,
            frameWithZ(pivot, chance(m_random, 0.5) || hangs ? vec(0, 1, 0) : vec(0, 0, 1)),
            [&](auto& of) {
              if (limits) of.setLimit(scalar(-0.6), scalar(0.6));
              if (!m_scene.motors) return;
              of.enableAngularMotor(true, 0, scalar(m_scene.strength));
              m_before_step.push_back([this, &of, speed, phase] {
                of.setMotorTargetVelocity(scalar(speed * std::sin(5 * m_time + phase)));
              });
            },
            true);
    }
    last = &link;
  }
  if (!m_scene.motors) startMoving(1);
}

// An arm or a plate whose way ends after some millimetres on either side. Its motor turns round.
void DrivenWorld::buildJammed() {
  const bool slides = chance(m_random, 0.3), level = chance(m_random, 0.5);
  const btVector3 way = level ? vec(0, 1, 0) : vec(0, 0, -1);
  btVector3 tip = vec(0, 0, 0);
  double reach = thickness;
  const auto turnsRound = [&](double speed, auto set) {
    m_before_step.push_back(
        [this, speed, set] { set(scalar(std::sin(4 * m_time) < 0 ? -speed : speed)); });
  };
  if (slides) {
    btRigidBody& post = addPost(vec(0, 0, 0));
    reach = 0.1;
    btRigidBody& plate = addBox(mass(), vec(reach, reach, reach), tip);
    const double speed = speedOf(1);
    slider(post, plate, frameWithX(tip, way), [&](auto& of) {
      of.setLowerLinLimit(-1);
      of.setUpperLinLimit(1);
      driveSlider(of, speed, 0.5);
      if (!m_scene.servos)
        turnsRound(speed, [&of](btScalar v) { of.setTargetLinMotorVelocity(v); });
    });
  } else {
    addArm(level ? vec(0, 0, 1) : vec(0, 1, 0), sign());
    tip = vec(armLength() - 0.1, 0, 0);
  }
  for (const double side : {-1., 1.}) {
    const double half = 0.25, gap = uniform(0, 0.005);
    addBox(0, vec(half, half, half), tip + way * scalar(side * (reach + gap + half)));
  }
}

// A door, a chain that hangs or a cart, which give way to a kinematic box.
void DrivenWorld::buildPushed() {
  enum { door, pendulum, cart };
  const int kind = std::min(2, int(uniform(0, 3)));
  const double half = 0.15, gap = uniform(0, 0.05), far = gap + uniform(0.05, 0.25);
  const btVector3 size = vec(half, half, half);
  btRigidBody& post = addPost(vec(0, 0, 0));
  if (kind == door) {
    btRigidBody& panel = addBox(10 * mass(), vec(0.5, 0.03, 1), vec(0.5, 0, 0));
    hinge(post, panel, frameWithZ(vec(0, 0, 0), vec(0, 0, 1)), [&](auto& of) {
      of.setLimit(0, 3);
      if (m_scene.motors)
        driveHinge(of, -speedOf(1), 0);
      else
        support::setFriction(of, m_scene.strength / dt, dt);
    });
    addMoving(size, vec(0.8, -0.03 - gap - half, 0), vec(0, far, 0));
  } else if (kind == pendulum) {
    btRigidBody* last = &post;
    for (int i = 0; i < m_scene.bodies; ++i) {
      btRigidBody& link =
          addBox(mass(), vec(thickness, thickness, 0.25), vec(0, 0, -0.5 * i - 0.25));
      const double target = uniform(-0.3, 0.3);
      hinge(*last, link, frameWithZ(vec(0, 0, -0.5 * i), vec(0, 1, 0)), [&](auto& of) {
        if (m_scene.motors) driveHinge(of, 0, target);
      });
      last = &link;
    }
    addMoving(size, vec(-thickness - gap - half, 0, -0.5 * m_scene.bodies + 0.2), vec(far, 0, 0));
  } else {
    btRigidBody& body = addBox(mass(), vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    slider(post, body, frameWithX(vec(0, 0, 0), vec(1, 0, 0)), [&](auto& of) {
      of.setLowerLinLimit(-1);
      of.setUpperLinLimit(1);
      if (m_scene.motors) driveSlider(of, -speedOf(1), 0);
    });
    addMoving(size, vec(-0.1 - gap - half, 0, 0), vec(far, 0, 0));
  }
}

// Chains that fall on the floor.
void DrivenWorld::buildBouncing() {
  addFloor(0);
  const bool hinges = chance(m_random, 0.5), limits = chance(m_random, 0.5),
             spheres = chance(m_random, 0.5);
  const double height = uniform(0.3, 1), slope = uniform(0, 0.2);
  btRigidBody* last = nullptr;
  for (int i = 0; i < m_scene.bodies; ++i) {
    const btVector3 x = vec(0.4 * i, 0, height + slope * i);
    std::unique_ptr<btCollisionShape> shape;
    if (spheres)
      shape = std::make_unique<btSphereShape>(scalar(0.15));
    else
      shape = std::make_unique<btBoxShape>(vec(0.15, 0.1, 0.1));
    btRigidBody& body = add(mass(), std::move(shape), pose_at(x), true);
    if (last != nullptr) {
      const btVector3 pivot = x - vec(0.2, 0, slope / 2);
      if (hinges)
        hinge(*last, body, frameWithZ(pivot, vec(0, 1, 0)), [&](auto& of) {
          if (limits) of.setLimit(scalar(-0.5), scalar(0.5));
        });
      else
        ball(*last, body, pivot);
    }
    last = &body;
  }
  startMoving(0.5);
}

// A ring of hinges from a post, of which the post is a link: with three bodies it is a four-bar.
void DrivenWorld::buildLoop() {
  const int n = m_scene.bodies + 1;
  const double radius = 0.1 * n;
  if (chance(m_random, 0.5)) addFloor(-2 * radius - uniform(0, 0.3));
  const auto corner = [&](int i) {
    const double angle = 2 * scenes::pi * (i + 0.5) / n;
    return vec(radius * std::sin(angle), 0, radius * (std::cos(angle) - 1));
  };
  btRigidBody& post = addPost(vec(0, 0, 0));
  btRigidBody* last = &post;
  for (int i = 0; i < n; ++i) {
    btRigidBody* next = &post;
    if (i < m_scene.bodies) {
      const btVector3 along = corner(i + 1) - corner(i), middle = (corner(i + 1) + corner(i)) / 2;
      const btQuaternion turned(vec(0, 1, 0), -btAtan2(along.z(), along.x()));
      next = &add(mass(), btVector3(along.length() * scalar(0.4), scalar(0.04), scalar(0.04)),
                  btTransform(turned, middle), true);
    }
    const double low = -power(m_random, -2, 0), high = power(m_random, -2, 0),
                 speed = speedOf(2 * radius);
    hinge(*last, *next, frameWithZ(corner(i), vec(0, 1, 0)), [&](auto& of) {
      of.setLimit(scalar(low), scalar(high));
      if (i == 0 && m_scene.motors) driveHinge(of, speed, high);
    });
    last = next;
  }
  if (!m_scene.motors) startMoving(4);
}

void DrivenWorld::build() {
  switch (m_scene.family) {
    case Family::motors: return buildMotors();
    case Family::linked: return buildLinked();
    case Family::jammed: return buildJammed();
    case Family::pushed: return buildPushed();
    case Family::bouncing:
    case Family::elastic: return buildBouncing();
    case Family::loops: return buildLoop();
  }
}

DrivenOutcome DrivenWorld::play(std::ostream* log) {
  DrivenOutcome out;
  const int steps = int(std::min(2 * m_scene.hz, 300.));
  EnergyBook book(bodies, dt);
  for (int i = 0; i < steps; ++i) {
    m_time = (i + 1) * dt;
    for (const auto& act : m_before_step) act();
    book.beginStep();
    step();
    for (const auto& body : bodies) {
      out.finite = out.finite && support::is_finite(*body);
      out.fastest = std::max(out.fastest, double(body->getLinearVelocity().length()));
    }
    if (!out.finite) return out;
    book.endStep();
    double depth = 0;
    eachPair([&](const btPersistentManifold& pair) {
      if (m_overlap_at_start.count(pairOf(pair)) == 0)
        depth = std::max(depth, support::depthOf(pair));
    });
    out.depth = std::max(out.depth, depth);
    out.gain = std::max(out.gain, book.by_velocities);
    out.peak = book.peak;
    if (log != nullptr)
      *log << i << " kinetic " << book.kinetic << " gained by velocities " << book.by_velocities
           << " depth " << depth << '\n';
  }
  return out;
}

const char* const names[] = {"motors",   "linked",  "jammed", "pushed",
                             "bouncing", "elastic", "loops"};

}  // namespace

const char* nameOf(Family family) { return names[int(family)]; }
std::ostream& operator<<(std::ostream& out, Family family) { return out << nameOf(family); }

DrivenScene makeDriven(unsigned seed) {
  Random random(seed ^ 0x51ed270bu);
  DrivenScene scene = {};
  scene.seed = seed;
  scene.family = Family(seed % family_count);
  scene.hz = chance(random, 0.5) ? (chance(random, 0.5) ? 60 : 120)
                                 : std::round(30 * power(random, 0, std::log10(8)));
  scene.iterations = int(std::lround(power(random, 0, std::log10(50))));
  const double share = random.uniform(0, 1);
  switch (scene.family) {
    case Family::motors:
    case Family::jammed: scene.motors = true; break;
    case Family::linked:
    case Family::pushed: scene.motors = share < 0.5; break;
    case Family::loops: scene.motors = share < 0.3; break;
    case Family::bouncing:
    case Family::elastic: break;
  }
  scene.servos = chance(random, 0.3);
  scene.strength = power(random, -2, 4);
  scene.friction = chance(random, 0.3) ? 0 : random.uniform(0.1, 0.9);
  const double restitution = random.uniform(0, 0.9);
  if (scene.family == Family::elastic)
    scene.restitution = 1;
  else if (scene.family == Family::bouncing || (scene.isDriven() && chance(random, 0.2)))
    scene.restitution = restitution;
  const int n = int(random.uniform(0, 5.999));
  switch (scene.family) {
    case Family::linked: scene.bodies = 2 + n; break;
    case Family::bouncing:
    case Family::elastic: scene.bodies = 2 + n; break;
    case Family::loops: scene.bodies = 3 + n; break;
    case Family::motors:
    case Family::jammed:
    case Family::pushed: scene.bodies = 1 + n / 2; break;
  }
  return scene;
}

std::string describe(const DrivenScene& s) {
  std::ostringstream out;
  out << s.seed << ": " << nameOf(s.family) << ", " << s.bodies << " bodies, " << s.hz << " Hz, "
      << s.iterations << " iterations";
  if (s.motors) out << (s.servos ? ", servos of " : ", motors of ") << s.strength << " N m s";
  out << ", friction " << s.friction << ", restitution " << s.restitution;
  return out.str();
}

DrivenOutcome play(const DrivenScene& scene, const support::Contender& contender,
                   std::ostream* log) {
  return DrivenWorld(scene, contender).play(log);
}

std::string faultOf(const DrivenScene& scene, const DrivenOutcome& of_stock,
                    const DrivenOutcome& out) {
  std::ostringstream fault;
  if (!out.finite) return "is not finite";
  if (!scene.isDriven()) {
    // 1 % of the largest kinetic energy, as of scenes without drives (Outcome). Which elastic contact comes first is a matter of rounding:
    // Pintle's joints on Bullet's solver gain up to 5 % more than Bullet's, or less.
    const double may_gain =
        scene.family == Family::elastic ? of_stock.gain + 0.05 * out.peak : 0.01 * out.peak;
    if (out.gain > may_gain)
      fault << "gains " << out.gain << " J of " << out.peak << " J, may " << may_gain << " J";
    return fault.str();
  }
  // A contact begins up to a step late: that is a centimetre.
  if (const double may_be = 2 * of_stock.depth + 0.01; out.depth > may_be)
    fault << "has a contact of " << out.depth << " m, may " << may_be << " m";
  // Linked bodies that overlap are in contact from the start: that contact counts by the energy that it adds. Between starts that differ
  // slightly Bullet's own varies by a factor of 5.
  else if (scene.family == Family::linked && out.peak > 10 * of_stock.peak)
    fault << "has " << out.peak << " J, Bullet's " << of_stock.peak << " J";
  return fault.str();
}

}  // namespace random_scenes
