// Purpose: what a joint holds, limits and leaves free, found by asking the joint for its rows.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <pintle/joints/joint.h>

#include <functional>
#include <memory>

namespace drawings {

struct Poses {
  btTransform a = btTransform::getIdentity(), b = btTransform::getIdentity();
};

/// Two bodies at their poses, and the joint between them.
struct Pair {
  Pair(const Poses& poses,
       const std::function<std::unique_ptr<pintle::Joint>(btRigidBody&, btRigidBody&)>& make);

  std::unique_ptr<btRigidBody> a, b;
  std::unique_ptr<pintle::Joint> joint;
};
using MakeJoint = std::function<std::unique_ptr<pintle::Joint>(btRigidBody&, btRigidBody&)>;

enum class Freedom { held, limited, free };
const char* name(Freedom freedom);

/// Of one body against the other, along and about the axes of a frame.
struct Degrees {
  Freedom slide[3], turn[3];
};

/// Of body a (`moves_a`) or b, where the bodies are at `poses`. The frame (world) has its origin where the joint holds that body.
/// Held is what the joint's equalities allow no velocity of; limited, what leads within 1 m or 80 degrees to a row that pushes
/// one way only.
Degrees degreesOf(const MakeJoint& make, const Poses& poses, bool moves_a,
                  const btTransform& frame);

}  // namespace drawings
