// Scenes of many joints among contacts: a pile of ragdolls, a bridge under a load, a track around two
// wheels. All bodies collide, but for those that a joint links. Joint types are template arguments; each
// is made of two bodies and the joint's frames in them.
//
// Measured, after each step, in double and from the poses alone:
//   gap          the largest distance between the two anchors of a joint, m: its mean over the steps, and
//                its maximum
//   penetration  the deepest contact, m
//   energy       kinetic, J, at the end: what has not come to rest

#pragma once

#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "world.h"

namespace scenes {

struct CrowdSettings {
  double dt = 1.0 / 60;  // s
  int iterations = 10;   // of the solver
  double seconds = 5;    // duration of the run
  int size = 0;          // ragdolls, planks, or links of the track; 0: as the scene has it
  double ratio = 1000;   // of the bridge: mass of the load over that of a plank
  SolverFactory make_solver = {};
};

struct CrowdResult {
  double mean_gap = 0, max_gap = 0;
  double mean_penetration = 0;  // m: the mean over all steps of the step's deepest
  double end_kinetic = 0;       // J
  double lowest = 0;            // m: of any centre, at the end
  double travel = 0;            // m: of the track's first link, along the track
  bool finite = true;
  int joints = 0;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

class Crowd {
 public:
  explicit Crowd(const CrowdSettings& settings)
      : world_(standard_gravity, settings.iterations, settings.make_solver) {}

  btRigidBody& box(double mass, const btVector3& half_extents, const btTransform& pose,
                   double friction = 0.5) {
    btRigidBody& body = world_.add_box(mass, half_extents, pose);
    world_.bullet().removeRigidBody(&body);
    body.setFriction(btScalar(friction));
    world_.bullet().addRigidBody(&body);
    return body;
  }
  btRigidBody& ground(double z = 0) {
    return box(0, btVector3(50, 50, 1), pose_at(btVector3(0, 0, btScalar(z - 1))));
  }
  /// Joins two bodies where they stand, in a frame of the world.
  template <class Joint>
  Joint& join(btRigidBody& a, btRigidBody& b, const btTransform& frame) {
    const btTransform in_a = a.getCenterOfMassTransform().inverse() * frame;
    const btTransform in_b = b.getCenterOfMassTransform().inverse() * frame;
    pivots_.push_back({&a, &b, to_eigen(in_a.getOrigin()), to_eigen(in_b.getOrigin())});
    return world_.add_joint<Joint>(a, b, in_a, in_b);
  }

  World& world() { return world_; }

  double gap() const {
    double largest = 0;
    for (const Pivot& p : pivots_) {
      const double gap = (point_in_world(*p.a, p.in_a) - point_in_world(*p.b, p.in_b)).norm();
      if (!std::isfinite(gap)) return HUGE_VAL;
      largest = std::max(largest, gap);
    }
    return largest;
  }
  double penetration() {
    double deepest = 0;
    btDispatcher& dispatcher = *world_.bullet().getDispatcher();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        deepest = std::max(deepest, -double(manifold.getContactPoint(k).getDistance()));
    }
    return deepest;
  }

  template <class EachStep>
  CrowdResult run(const CrowdSettings& settings, const EachStep& each_step) {
    CrowdResult result;
    result.joints = int(pivots_.size());
    const int steps = int(std::lround(settings.seconds / settings.dt));
    for (int step = 0; step < steps && result.finite; ++step) {
      world_.step(settings.dt);
      const double gap_now = gap();
      result.finite = std::isfinite(gap_now);
      result.mean_gap += gap_now / steps;
      result.max_gap = std::max(result.max_gap, gap_now);
      result.mean_penetration += penetration() / steps;
      each_step();
    }
    const btCollisionObjectArray& objects = world_.bullet().getCollisionObjectArray();
    result.lowest = HUGE_VAL;
    for (int i = 0; i < objects.size(); ++i) {
      const auto& body = *btRigidBody::upcast(objects[i]);
      if (!(body.getInvMass() > 0)) continue;
      result.end_kinetic += energy(body, 0);
      result.lowest = std::min(result.lowest, position(body).z());
    }
    result.microseconds_per_step = world_.microseconds_per_step();
    return result;
  }

 private:
  struct Pivot {
    const btRigidBody *a, *b;
    Eigen::Vector3d in_a, in_b;
  };
  World world_;
  std::vector<Pivot> pivots_;
};

inline btTransform frame_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& x,
                               const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return btTransform(matrix_to_bullet(axes), to_bullet(origin));
}

// 50 ragdolls of eleven boxes, dropped upon each other: hinges of one direction at elbows and knees,
// cones at neck, back, shoulders and hips.
template <class Hinge, class ConeTwist>
CrowdResult ragdolls(const CrowdSettings& settings) {
  Crowd crowd(settings);
  crowd.ground();
  const int count = settings.size > 0 ? settings.size : 50;
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d at(0.7 * (n % 3) - 0.7, 0.9 * ((n / 3) % 3) - 0.9, 0.5 + 0.6 * (n / 9));
    // Lying along x, one way and the other, and turned a little.
    const Eigen::AngleAxisd turn(0.3 * n, Eigen::Vector3d(0.3, 0.2, 1).normalized());
    const auto place = [&](double x, double y, double z) -> Eigen::Vector3d {
      return at + turn * Eigen::Vector3d(x, y, z);
    };
    const auto part = [&](double mass, double hx, double hy, double hz, double x,
                          double y) -> btRigidBody& {
      const btTransform pose(matrix_to_bullet(turn.toRotationMatrix()), to_bullet(place(x, y, 0)));
      return crowd.box(mass, btVector3(btScalar(hx), btScalar(hy), btScalar(hz)), pose);
    };
    btRigidBody& pelvis = part(12, 0.1, 0.15, 0.08, 0, 0);
    btRigidBody& chest = part(25, 0.2, 0.17, 0.1, 0.32, 0);
    btRigidBody& head = part(5, 0.1, 0.08, 0.09, 0.66, 0);
    const Eigen::Vector3d along = turn * Eigen::Vector3d(1, 0, 0),
                          across = turn * Eigen::Vector3d(0, 1, 0);
    const auto cone = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& p,
                          const Eigen::Vector3d& x, double swing, double twist) {
      const Eigen::Vector3d z = std::abs(x.dot(along)) > 0.5 ? across : along;
      auto& joint = crowd.join<ConeTwist>(a, b, frame_along(p, x, z));
      joint.setLimit(btScalar(swing), btScalar(swing), btScalar(twist));
    };
    const auto hinge = [&](btRigidBody& a, btRigidBody& b, const Eigen::Vector3d& p) {
      auto& joint = crowd.join<Hinge>(a, b, frame_along(p, along, across));
      joint.setLimit(btScalar(-2), btScalar(0.1));
    };
    cone(pelvis, chest, place(0.11, 0, 0), along, 0.5, 0.4);
    cone(chest, head, place(0.54, 0, 0), along, 0.7, 0.7);
    for (const double side : {-1., 1.}) {
      btRigidBody& upper_arm = part(2.5, 0.14, 0.05, 0.05, 0.33, side * 0.24);
      btRigidBody& lower_arm = part(2, 0.13, 0.04, 0.04, 0.05, side * 0.24);
      btRigidBody& thigh = part(8, 0.2, 0.07, 0.07, -0.31, side * 0.09);
      btRigidBody& shin = part(5, 0.2, 0.055, 0.055, -0.72, side * 0.09);
      cone(chest, upper_arm, place(0.47, side * 0.24, 0), -along, 1.2, 0.8);
      hinge(upper_arm, lower_arm, place(0.185, side * 0.24, 0));
      cone(pelvis, thigh, place(-0.11, side * 0.09, 0), -along, 0.9, 0.4);
      hinge(thigh, shin, place(-0.515, side * 0.09, 0));
    }
  }
  return crowd.run(settings, [] {});
}

// 100 planks of 10 kg between two banks, a hinge between each two, and a load dropped on the middle.
template <class Hinge>
CrowdResult bridge(const CrowdSettings& settings) {
  Crowd crowd(settings);
  const int planks = settings.size > 0 ? settings.size : 100;
  const double length = 0.25, mass = 10, half = planks * length / 2;
  // It hangs through: on a parabola of this depth.
  const double sag = half / 10;
  const auto node = [&](int i) {
    const double x = -half + length * i, s = x / half;
    return Eigen::Vector3d(x, 0, sag * (s * s - 1));
  };
  const Eigen::Vector3d y(0, 1, 0);
  btRigidBody* last =
      &crowd.box(0, btVector3(1, 1, 1), pose_at(btVector3(btScalar(-half - 1), 0, 0)));
  for (int i = 0; i < planks; ++i) {
    const Eigen::Vector3d a = node(i), b = node(i + 1), x = (b - a).normalized();
    btRigidBody& plank = crowd.box(mass, btVector3(btScalar((b - a).norm() / 2), 1, btScalar(0.04)),
                                   frame_along((a + b) / 2, x, x.cross(y)));
    crowd.join<Hinge>(*last, plank, frame_along(a, x.cross(y), y));
    last = &plank;
  }
  btRigidBody& bank =
      crowd.box(0, btVector3(1, 1, 1), pose_at(btVector3(btScalar(half + 1), 0, 0)));
  crowd.join<Hinge>(*last, bank, frame_along(node(planks), Eigen::Vector3d(1, 0, 0), y));
  crowd.box(settings.ratio * mass, btVector3(1, btScalar(0.8), btScalar(0.5)),
            pose_at(btVector3(0, 0, btScalar(-sag + 1.5))));
  return crowd.run(settings, [] {});
}

// A closed track of 200 links around two wheels, of which one is driven.
template <class Hinge>
CrowdResult track(const CrowdSettings& settings) {
  Crowd crowd(settings);
  const int links = settings.size > 0 ? settings.size : 200;
  const double pitch = 0.1, radius = 1, tooth = 0.03;
  // The line of pivots: two straights and two half circles, of chords of `pitch`.
  const double around = radius + tooth;
  const double step_angle = 2 * std::asin(pitch / 2 / around);
  const int on_arc = int(pi / step_angle);
  const int on_straight = (links - 2 * on_arc) / 2;
  const double span = on_straight * pitch;
  std::vector<Eigen::Vector3d> pivot;
  const int total = 2 * (on_arc + on_straight);
  for (int i = 0; i < total; ++i) {
    const bool far_side = i >= total / 2;
    const int k = far_side ? i - total / 2 : i;
    Eigen::Vector3d p;
    if (k < on_straight) {
      p = {-span / 2 + k * pitch, 0, around};
    } else {
      const double angle = pi * (k - on_straight) / on_arc;
      p = {span / 2 + around * std::sin(angle), 0, around * std::cos(angle)};
    }
    pivot.push_back(far_side ? Eigen::Vector3d(-p.x(), 0, -p.z()) : p);
  }
  const Eigen::Vector3d y(0, 1, 0);
  std::vector<btRigidBody*> track;
  for (int i = 0; i < total; ++i) {
    const Eigen::Vector3d a = pivot[size_t(i)], b = pivot[size_t((i + 1) % total)],
                          x = (b - a).normalized();
    track.push_back(
        &crowd.box(1, btVector3(btScalar(0.42 * (b - a).norm()), btScalar(0.3), btScalar(tooth)),
                   frame_along((a + b) / 2, x, x.cross(y)), 1));
  }
  for (int i = 0; i < total; ++i)
    crowd.join<Hinge>(*track[size_t(i)], *track[size_t((i + 1) % total)],
                      frame_along(pivot[size_t((i + 1) % total)], Eigen::Vector3d(1, 0, 0), y));
  // Wheels of many sides: a cylinder about y.
  btCylinderShape rim(btVector3(btScalar(radius - 0.01), btScalar(0.3), btScalar(radius - 0.01)));
  std::vector<std::unique_ptr<btRigidBody>> wheels;
  std::vector<std::unique_ptr<Hinge>> axles;
  for (const double side : {-1., 1.}) {
    btVector3 inertia;
    rim.calculateLocalInertia(50, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(50, nullptr, &rim, inertia);
    info.m_startWorldTransform = pose_at(btVector3(btScalar(side * span / 2), 0, 0));
    info.m_friction = 1;
    wheels.push_back(std::make_unique<btRigidBody>(info));
    wheels.back()->setActivationState(DISABLE_DEACTIVATION);
    crowd.world().bullet().addRigidBody(wheels.back().get());
    axles.push_back(
        std::make_unique<Hinge>(*wheels.back(), btVector3(0, 0, 0), btVector3(0, 1, 0)));
    crowd.world().bullet().addConstraint(axles.back().get());
    if (side > 0) axles.back()->enableAngularMotor(true, btScalar(-3), btScalar(20));
  }
  double travel = 0;
  Eigen::Vector3d before = position(*track[0]);
  CrowdResult result = crowd.run(settings, [&] {
    travel += (position(*track[0]) - before).norm();
    before = position(*track[0]);
  });
  result.travel = travel;
  for (const auto& axle : axles) crowd.world().bullet().removeConstraint(axle.get());
  for (const auto& wheel : wheels) crowd.world().bullet().removeRigidBody(wheel.get());
  return result;
}

}  // namespace scenes
