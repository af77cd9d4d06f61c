// A debug drawer that counts lines and looks at their ends.
#pragma once

#include <LinearMath/btIDebugDraw.h>

#include <cmath>

namespace support {

class LineCounter : public btIDebugDraw {
 public:
  explicit LineCounter(int mode) : m_mode(mode) {}

  void drawLine(const btVector3& from, const btVector3& to, const btVector3&) override {
    ++lines;
    for (int i = 0; i < 3; ++i) finite = finite && std::isfinite(from[i]) && std::isfinite(to[i]);
  }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int mode) override { m_mode = mode; }
  int getDebugMode() const override { return m_mode; }

  int lines = 0;
  bool finite = true;

 private:
  int m_mode;
};

/// What a joint draws in a mode; -1: a point that is not finite.
template <class Joint>
int linesDrawn(const Joint& joint, int mode) {
  LineCounter drawer(mode);
  joint.drawJoint(drawer);
  return drawer.finite ? drawer.lines : -1;
}

}  // namespace support
