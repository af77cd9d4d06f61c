// A ball is dropped on a plane, from 1 m, and bounces until it rests.

#include "bouncing.h"
#include "catalog.h"

namespace scenes {

Scene bounce_scene(double restitution) {
  const double height = 1;
  Scene scene{"bounce", "a ball is dropped on a plane"};
  scene.show(Group::measured, "Bounce", "A ball on a plane, as a joint.");
  const int ball = scene.add(box(1, {0.1, 0.1, 0.1}, {0, 0, height}));
  Joint& contact = scene.connect(Kind::contact, 0, ball, at({0, 0, 0}));
  contact.in_b.setIdentity();
  contact.restitution = restitution;
  scene.seconds = 10;
  scene.errors = {Error::trajectory, Error::overshoot};
  scene.compared = Compared::nowhere;
  scene.probe_body = ball;
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) -> Vector3d {
    const double g = standard_gravity, impact = std::sqrt(2 * g * height);
    return {0, 0, bouncing(time + impact / g, impact, g, restitution)};  // as if it was thrown up
  };
  return scene;
}

}  // namespace scenes
