// Every scene that is described as data, each in the file of its name; declared here if more than the catalog asks
// for it.

#pragma once

#include "scene.h"

namespace scenes {

Scene pendulum_scene(double amplitude = radians(120), double tilt = radians(30));
Scene chain_scene(int links, double ratio);
Scene bridge_scene(int planks);
Scene ragdoll_scene();
Scene steering_scene();
Scene drive_shaft_scene(Kind coupling, double bend = radians(30), double rpm = 300);
Scene slider_crank_scene(double speed = 2 * pi, double crank = 0.3, double rod = 0.9);
Scene four_bar_scene();
Scene wedge_elbow_scene(double total);  // rad
// The same forearm at rest, along `start` of the wedge's frame: x the wedge's middle, z its axis.
Scene elbow_scene(double total, const Eigen::Quaterniond& frame, const Vector3d& start);
Scene cone_shoulder_scene(const Spans& spans = {0.8, 0.6, 0.5},
                          const Vector3d& throw_spin = {3, 6, -5});  // rad/s
Scene spring_scene();
Scene top_scene();
Scene free_pair_scene();
Scene cantilever_scene();
// The second box starts turned by the angle (rad) about a direction.
Scene recovery_scene(double angle = radians(120), const Vector3d& about = {0.6, 0.8, 0});
Scene valve_scene(double turns = 5, double speed = 12);  // of the motor, rad/s
Scene door_scene(double damping_ratio = 0.3);
Scene rope_scene(bool slack = true);        // a rope, slack at first; else a rod
Scene stick_rope_scene(bool slack = true);  // the same of sticks, for who has no distance joint
Scene bounce_scene(double restitution = 0.5);
Scene tilt_scene(double tilt = radians(60));  // rad, between x and the plane of the angle

// What tests, regression figures and page go over, and the report where a scene is compared.
std::vector<Scene> catalog();
// The one of that name, which is to be there.
Scene named(const std::string& name);

}  // namespace scenes
