// Cables that are let go from a V, and the distance of the pivots of any joint.
#pragma once

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

#include "bodies.h"
#include "support.h"

namespace support {

template <class Joint>
constexpr bool is_ball =
    std::is_same_v<Joint, pintle::BallJoint> || std::is_same_v<Joint, btPoint2PointConstraint>;

/// Joins two bodies at a point of the world; hinges turn about y.
template <class Joint>
void joinAt(Bodies& bodies, btRigidBody& a, btRigidBody& b, const btVector3& point) {
  const btTransform to_a = a.getCenterOfMassTransform().inverse(),
                    to_b = b.getCenterOfMassTransform().inverse();
  if constexpr (is_ball<Joint>) {
    bodies.join(std::make_unique<Joint>(a, b, to_a * point, to_b * point));
  } else {
    const btTransform frame(btMatrix3x3(1, 0, 0, 0, 0, -1, 0, 1, 0), point);
    bodies.join(std::make_unique<Joint>(a, b, to_a * frame, to_b * frame));
  }
}

/// Links of 0.5 m and 1 kg, held at both ends, let go from a V; the middle one of `load` kg, if that is more than 0.
template <class Joint>
void addCable(Bodies& bodies, int links, double slack, double load = 0) {
  const double length = 0.5, all = links * length, span = all * (1 - slack),
               depth = std::sqrt(all * all - span * span) / 2;
  btRigidBody& post = bodies.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody* last = &post;
  btVector3 end(0, 0, 0);
  for (int i = 0; i < links; ++i) {
    const bool down = 2 * i < links;
    const btVector3 along = vec(span / links, 0, (down ? -2 : 2) * depth / links);
    const btQuaternion turn(btVector3(0, 1, 0),
                            scalar(std::atan2(down ? 2 * depth : -2 * depth, span)));
    const bool loaded = load > 0 && i == links / 2;
    btRigidBody& link = bodies.add(loaded ? load : 1, vec(length / 2, 0.05, 0.05),
                                   btTransform(turn, end + along / 2));
    joinAt<Joint>(bodies, *last, link, end);
    last = &link;
    end += along;
  }
  joinAt<Joint>(bodies, *last, post, end);
}

/// m: the largest distance of the pivots of joints, all of one type.
template <class Joint>
double largestGapOf(const Bodies& bodies) {
  double largest = 0;
  for (const auto& constraint : bodies.joints) {
    auto& joint = static_cast<Joint&>(*constraint);
    const btTransform &a = joint.getRigidBodyA().getCenterOfMassTransform(),
                      &b = joint.getRigidBodyB().getCenterOfMassTransform();
    btVector3 gap;
    if constexpr (is_ball<Joint>)
      gap = a * joint.getPivotInA() - b * joint.getPivotInB();
    else
      gap = a * joint.getFrameOffsetA().getOrigin() - b * joint.getFrameOffsetB().getOrigin();
    largest = std::max(largest, double(gap.length()));
  }
  return largest;
}

}  // namespace support
