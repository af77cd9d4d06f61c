// Axes that start opposite. Their cross product, which stock corrects by, is 0 there.

#include "../catalog.h"

namespace scenes {

Scene opposite_axes_scene() {
  Scene scene = recovery_scene(pi);
  scene.name = "opposite_axes";
  scene.title = "two free boxes, the axes of their hinge opposite at the start";
  scene.show(Group::wrong, "Axes that start opposite",
             "A hinge whose axes are 180 degrees apart. Look at the second box: with stock, "
             "nothing but rounding begins to turn it.");
  scene.mended = {Error::recovery, 1.5, 1};
  return scene;
}

}  // namespace scenes
