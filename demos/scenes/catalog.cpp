#include "catalog.h"

#include <algorithm>

namespace scenes {

// One that only this list names.
#define PINTLE_SCENE(function) \
  [] {                         \
    extern Scene function();   \
    return function();         \
  }()

// A new scene is a file of data, and a line here.
std::vector<Scene> catalog() {
  return {
      pendulum_scene(),
      chain_scene(10, 1),
      PINTLE_SCENE(stairs_scene),
      PINTLE_SCENE(rope_bridge_scene),
      chain_scene(10, 100),
      PINTLE_SCENE(crane_scene),
      PINTLE_SCENE(car_scene),
      PINTLE_SCENE(wrecking_ball_scene),
      PINTLE_SCENE(robot_arm_scene),
      PINTLE_SCENE(net_in_frame_scene),
      PINTLE_SCENE(heavy_crane_scene),
      PINTLE_SCENE(excavator_scene),
      PINTLE_SCENE(suspension_bridge_scene),
      PINTLE_SCENE(trebuchet_scene),
      PINTLE_SCENE(hexapod_scene),
      PINTLE_SCENE(brick_wall_scene),
      bridge_scene(100),
      ragdoll_scene(),
      PINTLE_SCENE(active_ragdoll_scene),
      drive_shaft_scene(Kind::universal),
      drive_shaft_scene(Kind::constant_velocity),
      slider_crank_scene(),
      four_bar_scene(),
      PINTLE_SCENE(bricard_scene),
      PINTLE_SCENE(governor_scene),
      wedge_elbow_scene(radians(60)),
      wedge_elbow_scene(radians(270)),
      cone_shoulder_scene(),
      spring_scene(),
      top_scene(),
      PINTLE_SCENE(steering_scene),
      PINTLE_SCENE(suspension_scene),
      free_pair_scene(),
      cantilever_scene(),
      recovery_scene(),
      valve_scene(),
      door_scene(),
      rope_scene(true),
      rope_scene(false),
      bounce_scene(),
      tilt_scene(),
      PINTLE_SCENE(limits_of_turns_scene),
      PINTLE_SCENE(opposite_axes_scene),
      PINTLE_SCENE(flat_cone_scene),
      PINTLE_SCENE(bent_universal_scene),
      PINTLE_SCENE(slider_rebound_scene),
      PINTLE_SCENE(gear_train_scene),
      PINTLE_SCENE(wedge_sides_scene),
      PINTLE_SCENE(cone_rim_scene),
      PINTLE_SCENE(bend_rim_scene),
      PINTLE_SCENE(hinge_turns_scene),
  };
}

Scene named(const std::string& name) {
  const std::vector<Scene> all = catalog();
  return *std::find_if(all.begin(), all.end(), [&](const Scene& one) { return one.name == name; });
}

}  // namespace scenes
