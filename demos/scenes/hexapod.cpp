// A hexapod walks: twelve motors turn hips and knees, three legs at a time.

#include "catalog.h"

namespace scenes {

Scene hexapod_scene() {
  const double period = 1.2, swing = 0.2, lift = 0.5;  // s, rad, rad
  const double thigh = 0.4, shin = 0.6;                // m
  const double height = 0.45;                          // m, of the hips
  const Vector3d z = Vector3d::UnitZ();

  Scene scene{"hexapod", "twelve motors walk"};
  scene.show(Group::known, "Hexapod",
             "Six legs of two motors each walk, three at a time on the ground.");
  scene.bodies[0] = solid(box(0, {30, 30, 1}, {0, 0, -1}));
  scene.bodies[0].friction = 1;
  const int body = scene.add(solid(box(30, {0.6, 0.25, 0.08}, {0, 0, height})));
  for (int leg = 0; leg < 6; ++leg) {
    const double side = leg % 2 == 0 ? 1 : -1;
    const bool first = leg % 4 == 0 || leg == 3;  // a tripod: 0, 3, 4
    const Vector3d hip(0.5 * (leg / 2 - 1), 0.27 * side, height);
    // Half a step back, or forward.
    const Vector3d out((first ? -1 : 1) * std::sin(swing), side * std::cos(swing), 0),
        knee = hip + thigh * (0.9 * out + std::sqrt(1 - 0.81) * z);
    const double fall = knee.z() - 0.045;
    const Vector3d foot = knee + std::sqrt(shin * shin - fall * fall) * out - fall * z;
    const int upper =
        scene.add(capsule(2, 0.04, thigh / 2, (hip + knee) / 2, turn_between(z, knee - hip)));
    Body lower =
        solid(capsule(1.5, 0.04, shin / 2, (knee + foot) / 2, turn_between(z, foot - knee)));
    lower.friction = 1;
    const int shank = scene.add(lower);
    // Hips turn about z, knees across the leg. A leg swings forward while it is lifted: position -cos, lift sin above 0.
    const double phase = first ? 0 : pi;
    Joint& turn = scene.connect(Kind::hinge, body, upper, with_z(hip, z));
    turn.motor = {[=](double time) {
                    return -side * swing * 2 * pi / period *
                           std::sin(2 * pi * time / period + phase);
                  },
                  300};
    Joint& bend = scene.connect(Kind::hinge, upper, shank, with_z(knee, out.cross(z)));
    bend.motor = {[=](double time) {
                    const double angle = 2 * pi * time / period + phase;
                    return std::sin(angle) > 0 ? lift * 2 * pi / period * std::sin(2 * angle) : 0.;
                  },
                  300};
  }
  scene.seconds = 6;
  scene.errors = {Error::gap, Error::axis};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes
