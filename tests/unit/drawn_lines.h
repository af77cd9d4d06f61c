// How many lines a joint draws, all of them from somewhere to somewhere.
#pragma once

#include <gtest/gtest.h>
#include <pintle/joints/joint.h>

#include "support.h"

namespace support {

class LineCounter : public btIDebugDraw {
 public:
  explicit LineCounter(int mode) : m_mode(mode) {}

  void drawLine(const btVector3& from, const btVector3& to, const btVector3&) override {
    EXPECT_TRUE(is_finite(from) && is_finite(to));
    ++lines;
  }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int mode) override { m_mode = mode; }
  int getDebugMode() const override { return m_mode; }

  int lines = 0;

 private:
  int m_mode;
};

inline int linesOf(const pintle::Joint& joint, int mode) {
  LineCounter counter(mode);
  joint.drawJoint(counter);
  return counter.lines;
}

}  // namespace support
