// Shared by the tests of the joints that Bullet has none of: worlds of small cubes, settings that
// are refused, and what is drawn.
#pragma once

#include <gtest/gtest.h>
#include <pintle/joints/joint.h>

#include <sstream>

#include "drawing.h"
#include "support.h"

namespace free_joints {

using scenes::pi;
using support::nan_value;
using support::refusal;
using support::scalar;
using support::vec;

/// A tolerance that only rounding decides.
constexpr double rounding(double in_single, double in_double) {
  return support::is_double ? in_double : in_single;
}

/// A cube of 0.1 m: the same inertia about every axis, m (0.1 m)^2 / 6.
inline btRigidBody& addCube(scenes::World& world, double mass, const btVector3& position) {
  return world.add_box(mass, vec(0.05, 0.05, 0.05), scenes::pose_at(position));
}

inline void expectRefusal(const std::string& message, const std::string& joint,
                          const std::string& field, btScalar value) {
  std::ostringstream number;
  number << double(value);
  const std::string text = value != value ? "nan" : number.str();
  for (const std::string& part : {joint, field, text})
    EXPECT_NE(message.find(part), std::string::npos) << message << ", not of " << part;
}

/// The call throws, names joint, field and value, and leaves the rows of `joint` as those of `twin`.
template <class J, class Call>
void expectRefused(J& joint, J& twin, Call call, const std::string& field, btScalar value) {
  expectRefusal(refusal([&] { call(joint, value); }), joint.name(), field, value);
  EXPECT_EQ(support::SolverRows::ofStep(joint), support::SolverRows::ofStep(twin))
      << field << " = " << value;
}

/// Which values a setting takes.
template <class J>
struct Setting {
  const char* field;
  std::function<void(J&, btScalar)> call;
  bool negative, zero, infinity;
};

/// Every setting refuses what it must, and takes the rest. `make` makes the same joint each time.
template <class J, class Make>
void expectChecked(const std::vector<Setting<J>>& settings, Make make) {
  for (const Setting<J>& setting : settings) {
    const auto check = [&](btScalar value, bool good) {
      const auto joint = make(), twin = make();
      if (good) {
        EXPECT_EQ(refusal([&] { setting.call(*joint, value); }), "accepted")
            << setting.field << " = " << value;
        EXPECT_TRUE(support::SolverRows::ofStep(*joint).finite());
      } else {
        expectRefused(*joint, *twin, setting.call, setting.field, value);
      }
    };
    check(nan_value, false);
    check(-support::infinite, false);
    check(support::infinite, setting.infinity);
    check(-1, setting.negative);
    check(0, setting.zero);
    check(scalar(0.5), true);
  }
}

/// Frames only, limits only, both, nothing.
inline void expectDrawn(const pintle::Joint& joint, int frame_lines, bool has_limit) {
  const auto lines = [&](int mode) { return drawing::linesOf(joint, mode); };
  const int frames = btIDebugDraw::DBG_DrawConstraints,
            limits = btIDebugDraw::DBG_DrawConstraintLimits;
  EXPECT_EQ(lines(btIDebugDraw::DBG_NoDebug), 0);
  EXPECT_EQ(lines(frames), frame_lines);
  EXPECT_EQ(lines(limits) > 0, has_limit);
  EXPECT_EQ(lines(frames | limits), frame_lines + lines(limits));
}

}  // namespace free_joints
