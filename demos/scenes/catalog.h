// Every scene that is described as data, each in the file of its name.

#pragma once

#include "scene.h"

namespace scenes {

Scene pendulum_scene(double amplitude = radians(120), double tilt = radians(30));
Scene chain_scene(int links, double ratio);
Scene crane_scene();
Scene bridge_scene(int planks);
Scene ragdoll_scene();
Scene drive_shaft_scene(Kind coupling, double bend = radians(30), double rpm = 300);
Scene slider_crank_scene(double speed = 2 * pi, double crank = 0.3, double rod = 0.9);
Scene four_bar_scene();
Scene wedge_elbow_scene(double total);  // rad
Scene cone_shoulder_scene(const Spans& spans = {0.8, 0.6, 0.5},
                          const Vector3d& throw_spin = {3, 6, -5});  // rad/s
Scene spring_scene();
Scene top_scene();
Scene steering_scene();
Scene suspension_scene();
Scene free_pair_scene();
Scene cantilever_scene();

// As the report and the regression figures have them.
std::vector<Scene> catalog();

}  // namespace scenes
