// Every scene that is described as data, each in the file of its name.

#pragma once

#include "scene.h"

namespace scenes {

Scene pendulum_scene();
Scene chain_scene(int links, double ratio);
Scene crane_scene();
Scene bridge_scene(int planks);
Scene ragdoll_scene();
Scene drive_shaft_scene(Kind coupling);
Scene slider_crank_scene();
Scene four_bar_scene();
Scene wedge_elbow_scene(double total);  // rad
Scene cone_shoulder_scene();
Scene spring_scene();
Scene top_scene();
Scene steering_scene();
Scene suspension_scene();
Scene free_pair_scene();
Scene cantilever_scene();

// As the report and the regression figures have them.
std::vector<Scene> catalog();

}  // namespace scenes
