#include "picture.h"

#include <cstdio>

namespace drawings {
namespace {

std::string rounded(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value + 0.0);
  std::string s = text;
  if (s.find_first_not_of("-0.") == std::string::npos && s[0] == '-') s.erase(0, 1);
  if (s[0] == '-') s.replace(0, 1, "\u2212");
  return s;
}

}  // namespace

std::string degrees(btScalar angle) {
  return rounded(double(angle * SIMD_DEGS_PER_RAD), 0) + "\u00b0";
}

std::string metres(btScalar length) { return rounded(double(length), 1) + " m"; }

std::string between(const std::string& low, const std::string& high) { return low + " to " + high; }

std::string handed(btScalar sign, const char* who, const char* axis) {
  return std::string("+ : ") + who + " turns " + (sign > 0 ? "right" : "left") + "-handed about " +
         axis;
}

Sketch::Caption caption(const char* title, const char* subtitle, const char* table_title,
                        const Degrees& degrees) {
  Sketch::Caption made{title, subtitle, table_title, {}, {}, {}};
  for (int k = 0; k < 3; ++k) {
    made.cells[0][k] = name(degrees.slide[k]);
    made.cells[1][k] = name(degrees.turn[k]);
  }
  return made;
}

Arc rangeOf(const pintle::Joint& joint, double radius) {
  Arc arc = Drawn(joint).arcs.at(0);
  arc.radius = btScalar(radius);
  return arc;
}

Arc onwards(const Arc& range, btScalar from, btScalar sign, double part, double degrees) {
  Arc arc = range;
  arc.radius *= btScalar(part);
  arc.low = from;
  arc.high = from + sign * rad(degrees);
  return arc;
}

}  // namespace drawings
