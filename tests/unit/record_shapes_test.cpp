// Shapes and joints in a recording.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <gtest/gtest.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/record.h>

#include "json.h"
#include "recordings.h"
#include "support.h"

namespace record_shapes_test {

using pintle::Recorder;
using recordings::values;
using support::scalar;
using support::vec;

// Every shape of Bullet's that a page draws as itself.
TEST(RecorderOf, Shapes) {
  btBoxShape box(vec(1, 2, 3));
  btSphereShape sphere(scalar(0.5));
  btCapsuleShapeX capsule(scalar(0.2), scalar(1));
  btCylinderShapeZ cylinder(vec(0.3, 0.3, 0.7));
  btConeShape cone(scalar(0.4), scalar(2));
  btStaticPlaneShape plane(vec(0, 0, 1), scalar(0.25));
  btConvexHullShape hull;
  for (int i = 0; i < 8; ++i) hull.addPoint(vec(i & 1, i >> 1 & 1, i >> 2));
  hull.addPoint(vec(0.5, 0.5, 0.5));  // inside
  btTriangleMesh triangles;
  triangles.addTriangle(vec(0, 0, 0), vec(1, 0, 0), vec(0, 1, 0));
  triangles.addTriangle(vec(1, 0, 0), vec(1, 1, 0), vec(0, 1, 0));
  btBvhTriangleMeshShape mesh(&triangles, true);
  btCompoundShape compound;
  compound.addChildShape(scenes::pose_at(vec(0, 0, 1)), &sphere);
  const btVector3 centres[] = {vec(0, 0, 0), vec(1, 0, 0)};
  const btScalar radii[] = {scalar(0.5), scalar(0.3)};
  btMultiSphereShape spheres(centres, radii, 2);
  btCollisionShape* const all[] = {&box,  &sphere, &capsule,  &cylinder, &cone, &plane,
                                   &hull, &mesh,   &compound, &spheres,  &box};

  scenes::World world;
  std::vector<std::unique_ptr<btCollisionObject>> objects;
  for (btCollisionShape* const shape : all) {
    objects.push_back(std::make_unique<btCollisionObject>());
    objects.back()->setCollisionShape(shape);
    world.bullet().addCollisionObject(objects.back().get(), 1, 0);
  }
  const json::Value run = json::read(Recorder(world.bullet()).toJson());
  for (const auto& object : objects) world.bullet().removeCollisionObject(object.get());

  const json::Value& shapes = run["shapes"];
  ASSERT_EQ(shapes.size(), 10);
  EXPECT_EQ(run["bodies"][10]["shape"].number, 0);
  EXPECT_EQ(shapes[0]["kind"].text, "box");
  EXPECT_NEAR(shapes[0]["half"][2].number, 3, 1e-6);
  EXPECT_NEAR(shapes[1]["radius"].number, 0.5, 1e-6);
  EXPECT_EQ(shapes[2]["kind"].text, "capsule");
  EXPECT_NEAR(shapes[2]["half"].number, 0.5, 1e-6);
  EXPECT_EQ(shapes[2]["axis"].number, 0);
  EXPECT_EQ(shapes[3]["kind"].text, "cylinder");
  EXPECT_NEAR(shapes[3]["half"].number, 0.7, 1e-6);
  EXPECT_NEAR(shapes[3]["radius"].number, 0.3, 1e-6);
  EXPECT_EQ(shapes[4]["kind"].text, "cone");
  EXPECT_NEAR(shapes[4]["half"].number, 1, 1e-6);
  EXPECT_NEAR(shapes[5]["constant"].number, 0.25, 1e-6);
  EXPECT_EQ(shapes[6]["points"].floats().size(), 8u * 3);
  EXPECT_EQ(shapes[6]["triangles"].floats().size(), 12u * 3);
  EXPECT_EQ(shapes[7]["points"].floats().size(), 4u * 3);
  EXPECT_EQ(shapes[7]["triangles"].floats().size(), 2u * 3);
  EXPECT_EQ(shapes[8]["kind"].text, "compound");
  EXPECT_EQ(shapes[8]["parts"][0]["pose"][2].number, 1);
  EXPECT_EQ(shapes[9]["kind"].text, "mesh");
  EXPECT_GT(shapes[9]["points"].floats().size(), 60u);
}

// The joint of this type that `add` makes between two boxes, as it is written after one step without a force.
template <class Add>
json::Value describe(Add add, const btTransform& pose_b = scenes::pose_at(vec(1, 0, 0))) {
  scenes::World world(0);
  btRigidBody& a = world.add_box(0, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(0, 0, 0)));
  btRigidBody& b = world.add_box(0, vec(0.5, 0.1, 0.1), pose_b);
  add(world, a, b);
  return json::read(Recorder(world.bullet()).toJson());
}

btTransform turned(double about_z) {
  return btTransform(btQuaternion(vec(0, 0, 1), scalar(about_z)), vec(1, 0, 0));
}
const btTransform in_a = scenes::pose_at(vec(0.5, 0, 0)), in_b = scenes::pose_at(vec(-0.5, 0, 0));

// Bullet's and ours have the same range, whichever body the angle is measured from.
TEST(RecorderOf, HingesOfBothKinds) {
  const auto check = [](auto* type, bool reference_a, double overshoot) {
    using Hinge = std::remove_pointer_t<decltype(type)>;
    const json::Value run = describe(
        [=](scenes::World& world, btRigidBody& a, btRigidBody& b) {
          world.add_joint<Hinge>(a, b, in_a, in_b, reference_a).setLimit(scalar(-0.2), scalar(0.5));
        },
        turned(0.7));
    const json::Value& limit = run["joints"][0]["limits"][0];
    EXPECT_EQ(run["joints"][0]["align"].text, "z");
    EXPECT_EQ(limit["kind"].text, "angle");
    EXPECT_NEAR(limit["low"].number, reference_a ? -0.2 : -0.5, 1e-6);
    EXPECT_NEAR(limit["high"].number, reference_a ? 0.5 : 0.2, 1e-6);
    EXPECT_NEAR(values(run, "overshoot")[0], overshoot, 1e-6);
  };
  check(static_cast<btHingeConstraint*>(nullptr), true, 0.2);
  check(static_cast<pintle::QuaternionHinge*>(nullptr), true, 0.2);
  check(static_cast<btHingeConstraint*>(nullptr), false, 0.5);
  check(static_cast<pintle::QuaternionHinge*>(nullptr), false, 0.5);
}

TEST(RecorderOf, TypesOfJoints) {
  const auto type = [](auto add) { return describe(add)["joints"][0]["type"].text; };
  using World = scenes::World;
  using Body = btRigidBody;
  EXPECT_EQ(type([](World& w, Body& a, Body& b) {
              w.add_joint<btPoint2PointConstraint>(a, b, vec(0.5, 0, 0), vec(-0.5, 0, 0));
            }),
            "btPoint2PointConstraint");
  EXPECT_EQ(type([](World& w, Body& a, Body& b) {
              w.add_joint<btSliderConstraint>(a, b, in_a, in_b, true);
            }),
            "btSliderConstraint");
  EXPECT_EQ(type([](World& w, Body& a, Body& b) {
              w.add_joint<btUniversalConstraint>(a, b, vec(0.5, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
            }),
            "btUniversalConstraint");
  EXPECT_EQ(type([](World& w, Body& a, Body& b) {
              w.add_joint<pintle::ConeTwistJoint>(a, b, in_a, in_b);
            }),
            "ConeTwistJoint");
}

// The angles are Bullet's own, whatever the order of the turns.
TEST(RecorderOf, LimitsOfThreeAngles) {
  const btTransform pose_b(btQuaternion(vec(0.36, -0.48, 0.8), scalar(1.1)), vec(1, 0, 0));
  const double range = 0.05;
  for (int order = 0; order < 6; ++order) {
    for (int axis = 0; axis < 3; ++axis) {
      double angle = 0;
      const json::Value run = describe(
          [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
            auto& joint = world.add_joint<btGeneric6DofSpring2Constraint>(a, b, in_a, in_b,
                                                                          RotateOrder(order));
            for (int i = 0; i < 3; ++i) joint.setLimit(3 + i, scalar(1), scalar(-1));
            joint.setLimit(3 + axis, scalar(-range), scalar(range));
            joint.calculateTransforms();
            angle = double(joint.getAngle(axis));
          },
          pose_b);
      const json::Value& joint = run["joints"][0];
      ASSERT_EQ(joint["limits"].size(), 1) << order << ' ' << axis;
      EXPECT_EQ(joint["limits"][0]["kind"].text, "turn");
      EXPECT_EQ(joint["limits"][0]["axis"].number, axis);
      EXPECT_EQ(joint["order"].size(), 3);
      ASSERT_GT(std::abs(angle), range);
      EXPECT_NEAR(values(run, "overshoot")[0], std::abs(angle) - range, 1e-5) << order << axis;
    }
  }
}

TEST(RecorderOf, LimitsOfUniversalJoints) {
  const auto pose_b =
      btTransform(btQuaternion(vec(0, 0, 1), scalar(0.7)) * btQuaternion(vec(0, 1, 0), scalar(0.4)),
                  vec(1, 0, 0));
  const auto check = [&](auto* type) {
    using Universal = std::remove_pointer_t<decltype(type)>;
    for (const int axis : {4, 5}) {
      double angle = 0;
      const json::Value run = describe(
          [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
            // Made where the frames coincide, and turned after it.
            b.setCenterOfMassTransform(scenes::pose_at(vec(1, 0, 0)));
            auto& joint =
                world.add_joint<Universal>(a, b, vec(0.5, 0, 0), vec(0, 0, 1), vec(0, 1, 0));
            b.setCenterOfMassTransform(pose_b);
            joint.setLimit(axis, scalar(-0.1), scalar(0.1));
            joint.calculateTransforms(a.getCenterOfMassTransform(), b.getCenterOfMassTransform());
            angle = double(joint.getAngle(axis - 3));
          },
          pose_b);
      const json::Value& limits =
          run["joints"][0]["limits"];  // beside it, the other angle's default
      ASSERT_GE(limits.size(), 1);
      EXPECT_EQ(limits[axis == 4 ? 0 : limits.size() - 1]["axis"].number, axis - 3);
      ASSERT_GT(std::abs(angle), 0.1);
      EXPECT_NEAR(values(run, "overshoot")[0], std::abs(angle) - 0.1, 1e-5) << axis;
    }
  };
  check(static_cast<btUniversalConstraint*>(nullptr));
  check(static_cast<pintle::UniversalJoint*>(nullptr));
}

TEST(RecorderOf, LimitsOfASlidersAngle) {
  const auto pose_b = btTransform(btQuaternion(vec(1, 0, 0), scalar(0.7)), vec(1, 0, 0));
  const auto overshoot = [&](bool reference_a) {
    return values(describe(
                      [&](scenes::World& world, btRigidBody& a, btRigidBody& b) {
                        auto& joint =
                            world.add_joint<btSliderConstraint>(a, b, in_a, in_b, reference_a);
                        joint.setLowerAngLimit(scalar(-0.2));
                        joint.setUpperAngLimit(scalar(0.5));
                      },
                      pose_b),
                  "overshoot")[0];
  };
  EXPECT_NEAR(overshoot(true), 0.2, 1e-6);
  EXPECT_NEAR(overshoot(false), 0.5, 1e-6);
}

TEST(RecorderOf, GapOfAJoint) {
  const auto far = scenes::pose_at(vec(1.25, 0.5, 0));
  const json::Value ball = describe(
      [](scenes::World& world, btRigidBody& a, btRigidBody& b) {
        world.add_joint<btPoint2PointConstraint>(a, b, vec(0.5, 0, 0), vec(-0.5, 0, 0));
      },
      far);
  EXPECT_NEAR(values(ball, "gap")[0], std::hypot(0.25, 0.5), 1e-6);
  const json::Value slider = describe(
      [](scenes::World& world, btRigidBody& a, btRigidBody& b) {
        auto& joint = world.add_joint<btSliderConstraint>(a, b, in_a, in_b, true);
        joint.setLowerLinLimit(scalar(-0.1));
        joint.setUpperLinLimit(scalar(0.1));
      },
      far);
  EXPECT_NEAR(values(slider, "gap")[0], 0.5, 1e-6);
  EXPECT_NEAR(values(slider, "overshoot")[0], 0.15, 1e-6);
  const json::Value rope = describe(
      [](scenes::World& world, btRigidBody& a, btRigidBody& b) {
        world.add_joint<pintle::DistanceJoint>(a, b, vec(0, 0, 0), vec(0, 0, 0), scalar(1));
      },
      far);
  EXPECT_NEAR(values(rope, "gap")[0], std::hypot(1.25, 0.5) - 1, 1e-6);
}

}  // namespace record_shapes_test
