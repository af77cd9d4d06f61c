// Limits three turns apart. A stock hinge wraps them to one turn: from 0 to 0.

#include "../catalog.h"

namespace scenes {

Scene limits_of_turns_scene() {
  Scene scene = valve_scene(3, 6);
  scene.name = "limits_of_turns";
  scene.show(Group::wrong, "Limits over several turns",
             "A motor turns a wheel by three turns, and back. Look at the wheel: a stock hinge "
             "takes the range for none, and is locked.");
  scene.mended = {Error::trajectory, 0.5, 0.05};
  return scene;
}

}  // namespace scenes
