#include "catalog.h"

namespace scenes {

std::vector<Scene> catalog() {
  return {pendulum_scene(),
          chain_scene(10, 1),
          chain_scene(10, 100),
          crane_scene(),
          bridge_scene(100),
          ragdoll_scene(),
          drive_shaft_scene(Kind::universal),
          drive_shaft_scene(Kind::constant_velocity),
          slider_crank_scene(),
          four_bar_scene(),
          wedge_elbow_scene(radians(60)),
          wedge_elbow_scene(radians(270)),
          cone_shoulder_scene(),
          spring_scene(),
          top_scene(),
          steering_scene(),
          suspension_scene(),
          free_pair_scene(),
          cantilever_scene(),
          recovery_scene(),
          valve_scene(),
          door_scene(),
          rope_scene(true),
          rope_scene(false),
          bounce_scene(),
          tilt_scene()};
}

}  // namespace scenes
