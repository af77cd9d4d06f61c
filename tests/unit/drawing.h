// A debug drawer that keeps the lines.
#pragma once

#include <LinearMath/btIDebugDraw.h>

#include <vector>

namespace drawing {

struct Line {
  btVector3 from, to;
};

class Recorder : public btIDebugDraw {
 public:
  explicit Recorder(int mode = DBG_DrawConstraints | DBG_DrawConstraintLimits) : m_mode(mode) {}
  using btIDebugDraw::drawLine;
  void drawLine(const btVector3& from, const btVector3& to, const btVector3&) override {
    lines.push_back({from, to});
  }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int mode) override { m_mode = mode; }
  int getDebugMode() const override { return m_mode; }

  std::vector<Line> lines;

 private:
  int m_mode;
};

}  // namespace drawing
