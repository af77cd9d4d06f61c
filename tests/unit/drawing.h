// A debug drawer that keeps the lines.
#pragma once

#include <LinearMath/btIDebugDraw.h>
#include <gtest/gtest.h>
#include <pintle/joints/joint.h>

#include <vector>

#include "support.h"

namespace drawing {

struct Line {
  btVector3 from, to, color;
};

class Recorder : public btIDebugDraw {
 public:
  explicit Recorder(int mode = DBG_DrawConstraints | DBG_DrawConstraintLimits) : m_mode(mode) {}
  using btIDebugDraw::drawLine;
  void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override {
    lines.push_back({from, to, color});
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

/// How many lines a joint draws in a mode, all of them from somewhere to somewhere.
inline int linesOf(const pintle::Joint& joint, int mode) {
  Recorder recorder(mode);
  joint.drawJoint(recorder);
  for (const Line& line : recorder.lines)
    EXPECT_TRUE(support::is_finite(line.from) && support::is_finite(line.to));
  return int(recorder.lines.size());
}

}  // namespace drawing
