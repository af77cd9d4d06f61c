// The scenes that a page shows, in its order: each with words for who has never seen it.

#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace scenes {

struct Exhibit {
  std::string group, title, text;
  Scene scene;
};

std::vector<Exhibit> gallery();

}  // namespace scenes
