#include "scene.h"

#include <algorithm>

namespace scenes {

const char* name(Error error) {
  static const char* const names[] = {"gap",    "axis",     "overshoot",  "energy",
                                      "gained", "momentum", "trajectory", "recovery"};
  return names[int(error)];
}

const char* unit(Error error) {
  static const char* const units[] = {"m",        "rad",      "rad", "relative",
                                      "relative", "relative", "m",   "s"};
  return units[int(error)];
}

const char* name(Group group) {
  static const char* const names[] = {"Machines you know", "What was wrong",
                                      "Limits, as they are drawn", "Measured in the report"};
  return names[int(group)];
}

bool Scene::contacts() const {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.collides; });
}

bool Scene::bounded() const {
  return contacts() || std::any_of(joints.begin(), joints.end(), [](const Joint& joint) {
           return joint.range.limited() || joint.motor.speed || joint.kind == Kind::cone_twist ||
                  joint.kind == Kind::contact;
         });
}

bool Scene::has(Error error) const {
  return std::find(errors.begin(), errors.end(), error) != errors.end();
}

void Scene::show(Group in_group, const std::string& with_headline, const std::string& with_text) {
  group = in_group;
  headline = with_headline;
  text = with_text;
}

int Scene::add(const Body& body) {
  bodies.push_back(body);
  return int(bodies.size()) - 1;
}

Joint& Scene::connect(Kind kind, int a, int b, const Isometry3d& frame) {
  joints.push_back(
      {kind, a, b, bodies[a].pose.inverse() * frame, bodies[b].pose.inverse() * frame});
  return joints.back();
}

void Scene::append(const Scene& part, const Isometry3d& pose) {
  const int offset = int(bodies.size()) - 1;
  for (size_t i = 1; i < part.bodies.size(); ++i) {
    Body body = part.bodies[i];
    body.pose = pose * body.pose;
    for (Vector3d* vector : {&body.velocity, &body.angular_velocity, &body.torque})
      *vector = pose.linear() * *vector;
    bodies.push_back(body);
  }
  const Isometry3d in_ground = bodies[0].pose.inverse() * pose * part.bodies[0].pose;
  for (Joint joint : part.joints) {
    if (joint.a == 0) joint.in_a = in_ground * joint.in_a;
    if (joint.b == 0) joint.in_b = in_ground * joint.in_b;
    for (int* body : {&joint.a, &joint.b}) *body += *body > 0 ? offset : 0;
    joints.push_back(joint);
  }
}

Body Scene::ground() {
  Body body;
  body.half_extents = Vector3d::Constant(0.05);  // to be seen
  body.pose.setIdentity();
  return body;
}

Body box(double mass, const Vector3d& half_extents, const Vector3d& position,
         const Eigen::Quaterniond& turn) {
  Body body;
  body.mass = mass;
  body.half_extents = half_extents;
  const Vector3d squares = half_extents.cwiseAbs2();
  body.inertia = mass / 3 * (Vector3d::Constant(squares.sum()) - squares);
  body.pose = Eigen::Translation3d(position) * turn;
  return body;
}

Body sphere(double mass, double radius, const Vector3d& position) {
  Body body = box(mass, Vector3d::Constant(radius), position);
  body.form = Form::sphere;
  body.inertia = Vector3d::Constant(0.4 * mass * radius * radius);
  return body;
}

Body cylinder(double mass, double radius, double half_height, const Vector3d& position,
              const Eigen::Quaterniond& turn) {
  Body body = box(mass, {radius, radius, half_height}, position, turn);
  body.form = Form::cylinder;
  const double across = mass * (radius * radius / 4 + half_height * half_height / 3);
  body.inertia = {across, across, mass * radius * radius / 2};
  return body;
}

Body capsule(double mass, double radius, double half_height, const Vector3d& position,
             const Eigen::Quaterniond& turn) {
  // As a cylinder of its whole length: near enough for a limb.
  Body body = cylinder(mass, radius, half_height + radius, position, turn);
  body.form = Form::capsule;
  body.half_extents.z() = half_height;
  return body;
}

Body round(Body body, double radius) {
  body.form = Form::cylinder;
  body.half_extents.x() = body.half_extents.y() = radius;
  return body;
}

Body solid(Body body) {
  body.collides = true;
  return body;
}

void spin(Body& body, const Vector3d& angular_velocity, const Vector3d& about) {
  body.angular_velocity = angular_velocity;
  body.velocity = angular_velocity.cross(body.pose.translation() - about);
}

Eigen::Quaterniond turn_between(const Vector3d& from, const Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

Isometry3d at(const Vector3d& point) { return Isometry3d(Eigen::Translation3d(point)); }

Isometry3d with_z(const Vector3d& point, const Vector3d& z) {
  return Eigen::Translation3d(point) * turn_between(Vector3d::UnitZ(), z);
}

Isometry3d with_x(const Vector3d& point, const Vector3d& x) {
  return Eigen::Translation3d(point) * turn_between(Vector3d::UnitX(), x);
}

}  // namespace scenes
