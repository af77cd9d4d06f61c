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
  /// Bullet counts an arc's lines as an int, which the 1e18 rad of its free twist overflow: at most a turn.
  void drawArc(const btVector3& centre, const btVector3& normal, const btVector3& axis,
               btScalar radius_a, btScalar radius_b, btScalar from, btScalar to,
               const btVector3& color, bool sector, btScalar step_degrees = 10) override {
    btIDebugDraw::drawArc(centre, normal, axis, radius_a, radius_b, btMax(from, -SIMD_2_PI),
                          btMin(to, SIMD_2_PI), color, sector, step_degrees);
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
