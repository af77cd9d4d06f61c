// Five boxes, each fixed to the one before and the first one to the ground, stick out level under
// their weight: nothing moves, or should.

#include "catalog.h"

namespace scenes {

Scene cantilever_scene() {
  constexpr int boxes = 5;
  Scene scene{"cantilever", "five boxes fixed to each other"};
  scene.show(Group::measured, "Cantilever", "A beam of fixed joints bears its weight.");
  for (int i = 0; i < boxes; ++i) {
    const int next = scene.add(box(1, {0.25, 0.1, 0.1}, {0.5 * i + 0.25, 0, 0}));
    scene.connect(Kind::fixed, next - 1, next, at({0.5 * i, 0, 0}));
  }
  scene.seconds = 3;
  scene.errors = {Error::trajectory, Error::gap, Error::axis};
  scene.probe_body = boxes;
  scene.horizon = scene.seconds;
  scene.closed_form = [](double) { return Vector3d(0.5 * boxes - 0.25, 0, 0); };
  return scene;
}

}  // namespace scenes
