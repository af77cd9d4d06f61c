#include "gallery.h"

#include "catalog.h"

namespace scenes {

std::vector<Exhibit> gallery() {
  const char* const known = "Machines you know";
  const char* const wrong = "What was wrong";
  const char* const measured = "Measured in the report";
  return {
      {known, "Ragdoll on stairs", "It falls down nine steps. Do limbs stay in their sockets?",
       stairs_scene()},
      {known, "Rope bridge", "Crates, then a safe of 400 kg. Watch the planks come apart, or not.",
       rope_bridge_scene()},
      {known, "Crane", "A tonne on a rope of twenty links of a kilogram each.", crane_scene()},
      {known, "Car", "Springs, axles and a motor over bumps.", car_scene()},
      {known, "Wrecking ball", "Two tonnes on a light chain swing into a wall.",
       wrecking_ball_scene()},
      {known, "Robot arm", "Six motors move a load of 30 kg.", robot_arm_scene()},
      {known, "Drive shaft", "A universal joint at 30 degrees and 300 rpm.",
       drive_shaft_scene(Kind::universal)},
      {known, "Valve", "A motor turns the wheel five turns onto its stop, and back.",
       valve_scene()},

      {wrong, "A chain that tears", "The last of ten links weighs a hundred times the others.",
       chain_scene(10, 100)},
      {wrong, "Limits over several turns", "Stock hinges forget how often they turned.",
       valve_scene(3, 6)},
      {wrong, "A shaft that ripples",
       "Bullet has no constant velocity joint: its universal joint speeds up and slows down twice "
       "a turn.",
       drive_shaft_scene(Kind::constant_velocity)},
      {wrong, "A wedge past half a turn", "An elbow that may turn by 270 degrees.",
       wedge_elbow_scene(radians(270))},
      {wrong, "A cone that gives energy", "A limb thrown at its elliptic cone.",
       cone_shoulder_scene()},
      {wrong, "Hinges that start apart", "Axes 120 degrees off find back together.",
       recovery_scene()},
      {wrong, "A long bridge", "A hundred planks and three boxes.", bridge_scene(100)},

      {measured, "Pendulum", "One link, swinging from 120 degrees on a tilted axis.",
       pendulum_scene()},
      {measured, "Chain", "Ten links on hinges of two directions.", chain_scene(10, 1)},
      {measured, "Ragdoll", "It falls on the ground.", ragdoll_scene()},
      {measured, "Slider crank", "A motor drives a piston.", slider_crank_scene()},
      {measured, "Four-bar linkage", "A closed loop of hinges.", four_bar_scene()},
      {measured, "Elbow", "A wedge of 60 degrees.", wedge_elbow_scene(radians(60))},
      {measured, "Spring", "A slider on a spring.", spring_scene()},
      {measured, "Top", "A heavy top on a ball joint.", top_scene()},
      {measured, "Steering", "Universal joints in a row.", steering_scene()},
      {measured, "Suspension", "A quarter of a car drops onto its springs.", suspension_scene()},
      {measured, "Free pair", "Two bodies on a hinge, and nothing else: momentum must stay.",
       free_pair_scene()},
      {measured, "Cantilever", "A beam of fixed joints bears its weight.", cantilever_scene()},
      {measured, "Door", "It is thrown at its springy stop.", door_scene()},
      {measured, "Rope", "Slack at first, then it catches a fall.", rope_scene(true)},
      {measured, "Rod", "The same with a rod.", rope_scene(false)},
      {measured, "Bounce", "A ball on a plane, as a joint.", bounce_scene()},
      {measured, "Tilt", "A leaning cube is pushed against the limit of an angle.", tilt_scene()},
  };
}

}  // namespace scenes
