#include "joints.h"

#include <iterator>

#include "picture.h"

namespace drawings {
namespace {

// In the order of the picture of all.
constexpr const char* kOverview[] = {
    "quaternion_hinge", "ball_joint",  "slider_joint",    "fixed_joint",
    "cone_twist_joint", "wedge_joint", "universal_joint", "constant_velocity_joint"};

}  // namespace

std::vector<Drawing> drawings() {
  std::vector<Drawing> all;
  std::vector<Sketch::Tile> tiles(std::size(kOverview));
  for (const auto& draw : {drawHinges, drawPoints, drawFrames, drawSwings, drawShafts, drawGears})
    for (const Made& made : draw()) {
      all.push_back({made.name, made.svg});
      for (std::size_t i = 0; i < tiles.size(); ++i)
        if (made.name == kOverview[i]) tiles[i] = made.tile;
    }
  all.push_back({"overview", Sketch::overview("Joints of Pintle", tiles, 4)});
  return all;
}

}  // namespace drawings
