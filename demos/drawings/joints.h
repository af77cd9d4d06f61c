// Purpose: a drawing of each joint, and one of many beside each other, from the joints' own frames, limits, readings and rows.
#pragma once

#include <string>
#include <vector>

namespace drawings {

struct Drawing {
  std::string name;  // of the file, without .svg: that of the joint's header
  std::string svg;
};

std::vector<Drawing> drawings();

}  // namespace drawings
