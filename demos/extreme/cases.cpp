#include "cases.h"

#include <cmath>

namespace extreme {
namespace {

using engines::BulletEngine;
using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::radians;
using scenes::Scene;
using scenes::Vector3d;

// A joint of a kind, as both of the rig's joints have it.
struct Rig {
  const char* name;
  Kind kind;
  scenes::Range range = {};
  scenes::Spring spring = {};
  bool motor = false;
};

const Rig rigs[] = {
    {"ball", Kind::ball},
    {"hinge", Kind::hinge},
    {"hinge with limit", Kind::hinge, {-0.5, 0.5}},
    {"hinge with motor", Kind::hinge, {}, {}, true},
    {"slider", Kind::slider},
    {"slider with limit", Kind::slider, {-0.3, 0.3}},
    {"slider with spring", Kind::slider, {}, {2, 0.2}},
    {"fixed", Kind::fixed},
    {"cone twist", Kind::cone_twist},
    {"universal", Kind::universal},
    {"constant velocity", Kind::constant_velocity},
    {"wedge", Kind::wedge, {-0.5, 0.5}},
};

// What can be extreme about a rig. Two boxes lie in a line along x, unless turned.
struct Conditions {
  double size = 1;               // m, the length of a box; masses grow with its cube
  double mass_ratio = 1;         // of the second body to the first
  Vector3d inertia = {1, 1, 1};  // of both, by factors
  Vector3d origin = {0, 0, 0};   // m, of the first joint
  double gravity = scenes::standard_gravity;
  double seconds = 2;
  Vector3d spin = {0, 0, 0};  // rad/s, of all about the first joint
  double start_angle = 0;     // rad, by which the second body starts off its joint
  double start_gap = 0;       // m, likewise
  bool hanging = false;       // at rest
};

// Hinges turn about y and sliders slide along z, so that gravity moves both; a wedge is about y.
Isometry3d frame(Kind kind, const Vector3d& point) {
  switch (kind) {
    case Kind::hinge: return scenes::with_z(point, Vector3d::UnitY());
    case Kind::slider: return scenes::with_x(point, Vector3d::UnitZ());
    case Kind::wedge: {
      Isometry3d to = scenes::at(point);
      to.linear() << Vector3d::UnitX(), -Vector3d::UnitZ(), Vector3d::UnitY();
      return to;
    }
    default: return scenes::at(point);
  }
}

Case make(const Rig& rig, const std::string& what, const Conditions& is) {
  Case one;
  one.joint = rig.name;
  one.what = what;
  one.size = is.size;
  Scene& scene = one.scene;
  scene.gravity = is.gravity;
  scene.seconds = is.seconds;
  const double mass = std::pow(is.size, 3);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(is.hanging ? radians(90) : 0, Vector3d::UnitY()));
  const Isometry3d place = Eigen::Translation3d(is.origin) * turn;
  for (const int i : {0, 1}) {
    const double m = i == 0 ? mass : mass * is.mass_ratio;
    scenes::Body body = scenes::box(m, is.size * Vector3d(0.5, 0.1, 0.1),
                                    place * Vector3d((i + 0.5) * is.size, 0, 0), turn);
    body.inertia = body.inertia.cwiseProduct(is.inertia);
    spin(body, is.spin, is.origin);
    const int index = scene.add(body);
    Isometry3d at = place * frame(rig.kind, Vector3d(i * is.size, 0, 0));
    if (rig.kind == Kind::slider && is.hanging)
      at = scenes::with_x(at.translation(), Vector3d::UnitX());
    Joint& joint = scene.connect(rig.kind, index - 1, index, at);
    joint.range = rig.range;
    joint.spring = rig.spring;
    if (rig.kind == Kind::slider) {
      joint.range.low *= is.size;
      joint.range.high *= is.size;
    }
    if (rig.kind == Kind::cone_twist) joint.spans = {0.8, 0.6, 0.5};
    if (rig.motor) joint.motor = {[](double) { return 2.; }, 10 * mass * is.gravity * is.size};
  }
  scenes::Body& last = scene.bodies.back();
  const Vector3d anchor = place * Vector3d(is.size, 0, 0);
  last.pose = Eigen::Translation3d(anchor + is.start_gap * Vector3d(0.6, 0, 0.8)) *
              Eigen::AngleAxisd(is.start_angle, Vector3d(0.6, 0.8, 0)) *
              Eigen::Translation3d(-anchor) * last.pose;
  // A free slide gains speed all the time.
  one.speed = is.gravity * is.seconds + std::sqrt(8 * is.gravity * is.size) +
              2 * is.spin.norm() * is.size + is.start_gap + is.size;
  return one;
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// Puts all bodies where they are, at rest.
void put(BulletEngine& engine, const std::vector<scenes::Body>& bodies) {
  for (size_t i = 1; i < bodies.size(); ++i) {
    btRigidBody& body = engine.body(int(i));
    body.setCenterOfMassTransform(scenes::to_bullet(bodies[i].pose));
    body.setLinearVelocity(btVector3(0, 0, 0));
    body.setAngularVelocity(btVector3(0, 0, 0));
  }
}

void add_conditions(std::vector<Case>& list, const Rig& rig) {
  const auto add = [&](const std::string& what, const Conditions& is) -> Case& {
    list.push_back(make(rig, what, is));
    return list.back();
  };
  for (const double ratio : {1e-6, 1e-3, 1e3, 1e6}) {
    Conditions is;
    is.mass_ratio = ratio;
    add(text("mass ratio %g", ratio), is);
  }
  Conditions needle;
  needle.inertia = {1e-8, 1, 1};
  add("needles: inertia ratio 1e-8", needle);
  Conditions disc;
  disc.inertia = {1, 1e-8, 1e-8};
  add("discs: inertia ratio 1e-8", disc);
  for (const double size : {1e-3, 1e3}) {
    Conditions is;
    is.size = size;
    add(text("size %g m", size), is);
  }
  Conditions far;
  far.origin = {1e4, 0, 0};
  add("10 km from the origin", far);
  for (const double speed : {100., 1000.}) {
    Conditions is;
    is.spin = {0, speed, 0};
    add(text("turns at %g rad/s", speed), is);
  }
  for (const double angle : {90., 180.}) {
    Conditions is;
    is.start_angle = radians(angle);
    is.seconds = 10;
    add(text("starts %g deg off", angle), is);
  }
  Conditions apart;
  apart.start_gap = 10;
  apart.seconds = 10;
  add("starts 10 m off", apart);
  Conditions heavy;
  heavy.gravity = 1000 * scenes::standard_gravity;
  add("gravity x 1000", heavy);
  for (const double steps : {1e4, 1e6}) {
    Conditions is;
    is.seconds = steps / 60;
    const std::string so_many = steps < 1e6 ? "1e4 steps " : "1e6 steps ";
    const auto add_long = [&](const std::string& what) -> Case& {
      Case& one = add(so_many + what, is);
      one.is_long = steps == 1e6;
      return one;
    };
    // Stock joints brake a fall until it rests: what is to stay in motion falls again.
    add_long("after a fall");
    Case& moving = add_long("in motion");
    moving.act = [start = moving.scene.bodies](BulletEngine& engine, int step) {
      if (step % 600 == 0) put(engine, start);
    };
    is.hanging = true;
    add_long("at rest");
  }
}

void add_solver_settings(std::vector<Case>& list, const Rig& rig) {
  const auto add = [&](const std::string& what) -> Case& {
    list.push_back(make(rig, what, {}));
    return list.back();
  };
  for (const double dt : {1e-1, 1e-4}) {
    Case& one = add(text("steps of %g s", dt));
    one.dt = dt;
    if (dt < 1e-3) one.scene.seconds = 0.5;
  }
  for (const int iterations : {1, 1000})
    add(text("%g iterations", iterations)).iterations = iterations;
  for (const double erp : {0., 1.}) {
    add(text("ERP %g", erp)).prepare = [erp](BulletEngine& engine) {
      engine.world().getSolverInfo().m_erp = btScalar(erp);
    };
  }
  for (const double cfm : {0.1, 10.}) {
    add(text("CFM %g", cfm)).prepare = [cfm](BulletEngine& engine) {
      engine.world().getSolverInfo().m_globalCfm = btScalar(cfm);
    };
  }
}

void set_kinematic(btRigidBody& body, bool kinematic) {
  const int flags = body.getCollisionFlags(), flag = btCollisionObject::CF_KINEMATIC_OBJECT;
  body.setCollisionFlags(kinematic ? flags | flag : flags & ~flag);
  if (kinematic) body.setInterpolationWorldTransform(body.getWorldTransform());
}

// Changes while it runs; all is as before in the last half.
void add_events(std::vector<Case>& list, const Rig& rig) {
  constexpr double seconds = 8;
  const int half = int(seconds * 60) / 2, every = 15;
  const auto add = [&](const std::string& what) -> Case& {
    Conditions is;
    is.seconds = seconds;
    list.push_back(make(rig, what, is));
    return list.back();
  };
  Case& struck = add("impulses of 1e6 N s");
  struck.speed += 2e6;
  struck.act = [](BulletEngine& engine, int step) {
    if (step == half / 2) engine.body(2).applyCentralImpulse(btVector3(0, 0, btScalar(1e6)));
    if (step == half) engine.body(2).applyCentralImpulse(btVector3(btScalar(1e6), 0, 0));
  };
  add("static and dynamic by turns").act = [=](BulletEngine& engine, int step) {
    btRigidBody& body = engine.body(2);
    if (step > half || step % every != 0) return;
    const btVector3 inertia(btScalar(0.02 / 3), btScalar(0.26 / 3), btScalar(0.26 / 3));
    const bool fixed = step / every % 2 == 1;
    body.setMassProps(fixed ? 0 : 1, fixed ? btVector3(0, 0, 0) : inertia);
    body.updateInertiaTensor();
    if (fixed) {
      body.setLinearVelocity(btVector3(0, 0, 0));
      body.setAngularVelocity(btVector3(0, 0, 0));
    }
  };
  add("kinematic and dynamic by turns").act = [=](BulletEngine& engine, int step) {
    if (step <= half && step % every == 0) set_kinematic(engine.body(2), step / every % 2 == 1);
  };
  add("disabled and enabled by turns").act = [=](BulletEngine& engine, int step) {
    if (step <= half && step % every == 0) engine.joint(1).setEnabled(step / every % 2 == 0);
  };
  add("removed and added by turns").act = [=](BulletEngine& engine, int step) {
    if (step == 0 || step > half || step % every != 0) return;
    if (step / every % 2 == 1) {
      engine.world().removeConstraint(&engine.joint(1));
    } else {
      engine.world().addConstraint(&engine.joint(1), true);
    }
  };
}

void add_springs(std::vector<Case>& list) {
  for (const double frequency : {0.01, 1., 60., 600.}) {
    for (const double damping_ratio : {0., 1.}) {
      const Rig rig{"slider with spring", Kind::slider, {}, {frequency, damping_ratio}};
      list.push_back(make(
          rig, text("spring of %g Hz", frequency) + text(", damping ratio %g", damping_ratio), {}));
    }
  }
}

void add_limits_elsewhere(std::vector<Case>& list) {
  for (Rig rig :
       {Rig{"hinge with limit", Kind::hinge, {1, 1.5}},
        Rig{"slider with limit", Kind::slider, {0.5, 0.8}}, Rig{"wedge", Kind::wedge, {1, 1.5}}}) {
    Conditions is;
    is.seconds = 10;
    list.push_back(make(rig, "limit beyond the pose", is));
    rig.range = {0.8 * rig.range.high, 0.8 * rig.range.high};
    list.push_back(make(rig, "limit of no width beyond the pose", is));
  }
  Conditions turned;
  turned.start_angle = 2;
  turned.seconds = 10;
  list.push_back(
      make({"cone twist", Kind::cone_twist}, "starts 2 rad off, beyond its cone", turned));
}

}  // namespace

std::vector<Case> cases() {
  std::vector<Case> list;
  for (const Rig& rig : rigs) {
    add_conditions(list, rig);
    add_solver_settings(list, rig);
    add_events(list, rig);
  }
  add_springs(list);
  add_limits_elsewhere(list);
  return list;
}

}  // namespace extreme
