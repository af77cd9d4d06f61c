// Every joint type in both formulations, with what it can be set to: what the contract is held
// against. A new joint type is a line in joint_kinds.cpp.
#pragma once

#include <pintle/joints/joint.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace kinds {

struct Kind {
  std::string name;
  size_t bytes;
  int variants;  ///< settings from few (0: as constructed) to all
  /// It has equalities: rows at any pose, whatever the settings.
  bool holds;
  /// Why the joint blows up in two dimensions, which no other may; empty: it does not.
  std::string blows_up;
  /// A limit's row is the tangent where the step leads, which turns with it.
  bool limits_look_ahead;
  std::function<std::unique_ptr<btTypedConstraint>(btRigidBody& a, btRigidBody& b,
                                               const btTransform& frame_a,
                                               const btTransform& frame_b, int variant)>
      make;
  /// To Bullet's fixed body.
  std::function<std::unique_ptr<btTypedConstraint>(btRigidBody& a, const btTransform& frame_a)>
      make_one;
  const char* free_body;  ///< which of the joint's bodies is not that one then
};
inline std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }

std::vector<Kind> all();

}  // namespace kinds
