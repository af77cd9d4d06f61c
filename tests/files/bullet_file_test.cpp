// A .bullet file that is written with Pintle's joints is one of Bullet's joints: Bullet's importer loads it.
#include <BulletWorldImporter/btBulletWorldImporter.h>
#include <LinearMath/btSerializer.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <scenes/world.h>

#include <memory>
#include <typeinfo>
#include <vector>

namespace {

// A world as it comes out of the file that another one is written to.
class Loaded {
 public:
  explicit Loaded(const btDiscreteDynamicsWorld& from) : m_importer(&m_world.bullet()) {
    btDefaultSerializer serializer;
    // It is not const, and changes nothing.
    const_cast<btDiscreteDynamicsWorld&>(from).serialize(&serializer);
    std::vector<char> file(serializer.getBufferPointer(),
                           serializer.getBufferPointer() + serializer.getCurrentBufferSize());
    EXPECT_TRUE(m_importer.loadFileFromMemory(file.data(), int(file.size())));
  }
  ~Loaded() { m_importer.deleteAllData(); }

  btDiscreteDynamicsWorld& world() { return m_world.bullet(); }

 private:
  scenes::World m_world;
  btBulletWorldImporter m_importer;
};

btTransform at(double x, double angle) {
  return btTransform(btQuaternion(btVector3(1, 0, 0), btScalar(angle)),
                     btVector3(btScalar(x), 0, 0));
}

TEST(BulletFile, AHingeIsLoadedAsBullets) {
  scenes::World written;
  const btVector3 half(btScalar(0.3), btScalar(0.1), btScalar(0.1));
  btRigidBody& a = written.add_box(0, half, scenes::pose_at(btVector3(0, 0, 0)));
  btRigidBody& b = written.add_box(2, half, scenes::pose_at(btVector3(1, 0, 0)));
  auto& hinge = written.add_joint<pintle::QuaternionHinge>(a, b, at(0.5, 0.3), at(-0.5, 0.3), true);
  hinge.setLimit(btScalar(-0.5), btScalar(0.75), btScalar(0.9), btScalar(0.6), btScalar(0.5));
  hinge.enableAngularMotor(true, 2, 3);
  hinge.setAngularOnly(true);
  Loaded loaded(written.bullet());
  ASSERT_EQ(loaded.world().getNumConstraints(), 1);
  auto* const of = dynamic_cast<btHingeConstraint*>(loaded.world().getConstraint(0));
  ASSERT_NE(of, nullptr);
  EXPECT_EQ(typeid(*of), typeid(btHingeConstraint));
  EXPECT_FLOAT_EQ(float(of->getLowerLimit()), -0.5f);
  EXPECT_FLOAT_EQ(float(of->getUpperLimit()), 0.75f);
  EXPECT_FLOAT_EQ(float(of->getLimitBiasFactor()), 0.6f);
  EXPECT_FLOAT_EQ(float(of->getLimitRelaxationFactor()), 0.5f);
  EXPECT_TRUE(of->getEnableAngularMotor());
  EXPECT_FLOAT_EQ(float(of->getMaxMotorImpulse()), 3);
  EXPECT_TRUE(of->getAngularOnly());
  EXPECT_TRUE(of->getUseReferenceFrameA());
  EXPECT_EQ(of->getFrameOffsetA().getOrigin(), hinge.getFrameOffsetA().getOrigin());
  EXPECT_EQ(&of->getRigidBodyA() == &of->getRigidBodyB(), false);
  for (int i = 0; i < 60; ++i) loaded.world().stepSimulation(btScalar(1. / 60), 0);
}

// Bullet has no limits of a turn or more: they are none in a file.
TEST(BulletFile, ALimitOfSeveralTurnsIsLoadedAsNone) {
  scenes::World written;
  const btVector3 half(btScalar(0.3), btScalar(0.1), btScalar(0.1));
  btRigidBody& a = written.add_box(0, half, scenes::pose_at(btVector3(0, 0, 0)));
  btRigidBody& b = written.add_box(2, half, scenes::pose_at(btVector3(1, 0, 0)));
  auto& hinge = written.add_joint<pintle::QuaternionHinge>(a, b, at(0.5, 0), at(-0.5, 0), true);
  hinge.setLimit(-SIMD_2_PI, SIMD_2_PI);
  Loaded loaded(written.bullet());
  ASSERT_EQ(loaded.world().getNumConstraints(), 1);
  auto* const of = dynamic_cast<btHingeConstraint*>(loaded.world().getConstraint(0));
  ASSERT_NE(of, nullptr);
  EXPECT_FALSE(of->hasLimit());
  for (const double angle : {-3., -1., 0., 1., 3.}) {
    of->testLimit(at(0.5, 0) * btTransform(btQuaternion(btVector3(0, 0, 1), btScalar(angle))),
                  at(0.5, 0));
    EXPECT_EQ(of->getSolveLimit(), 0) << angle;
  }
}

// Two boxes in a world, a fixed one and one that moves.
struct Boxes {
  const btVector3 half{btScalar(0.3), btScalar(0.1), btScalar(0.1)};
  scenes::World world;
  btRigidBody& a = world.add_box(0, half, scenes::pose_at(btVector3(0, 0, 0)));
  btRigidBody& b = world.add_box(2, half, scenes::pose_at(btVector3(1, 0, 0)));
};

// The only joint of a loaded world, which is exactly Bullet's.
template <class Stock>
Stock* onlyJoint(Loaded& loaded) {
  if (loaded.world().getNumConstraints() != 1) return nullptr;
  btTypedConstraint* const joint = loaded.world().getConstraint(0);
  EXPECT_EQ(typeid(*joint), typeid(Stock));
  return dynamic_cast<Stock*>(joint);
}

TEST(BulletFile, ABallIsLoadedAsBullets) {
  Boxes written;
  written.world.add_joint<pintle::BallJoint>(written.a, written.b, btVector3(btScalar(0.5), 0, 0),
                                             btVector3(btScalar(-0.5), btScalar(0.25), 0));
  Loaded loaded(written.world.bullet());
  const auto* const of = onlyJoint<btPoint2PointConstraint>(loaded);
  ASSERT_NE(of, nullptr);
  EXPECT_EQ(of->getPivotInA(), btVector3(btScalar(0.5), 0, 0));
  EXPECT_EQ(of->getPivotInB(), btVector3(btScalar(-0.5), btScalar(0.25), 0));
}

TEST(BulletFile, AGearIsLoadedAsBullets) {
  Boxes written;
  written.world.add_joint<pintle::GearJoint>(written.a, written.b, btVector3(0, 0, 1),
                                             btVector3(0, btScalar(0.5), 0), btScalar(-2.5));
  Loaded loaded(written.world.bullet());
  const auto* const of = onlyJoint<btGearConstraint>(loaded);
  ASSERT_NE(of, nullptr);
  EXPECT_EQ(of->getAxisA(), btVector3(0, 0, 1));
  EXPECT_EQ(of->getAxisB(), btVector3(0, btScalar(0.5), 0));
  EXPECT_EQ(of->getRatio(), btScalar(-2.5));
}

// The file of a gear between two hinges has their axes in the bodies that it acts on.
TEST(BulletFile, AGearOfHingesIsLoadedAsOneOfAxes) {
  Boxes written;
  btRigidBody& post = written.world.add_box(0, written.half, scenes::pose_at(btVector3(2, 0, 0)));
  auto& fixed = written.world.add_joint<pintle::QuaternionHinge>(post, written.b, at(-0.5, 0.3),
                                                                 at(0.5, 0.3), true);
  auto& other = written.world.add_joint<pintle::QuaternionHinge>(written.a, written.b, at(0.5, 0),
                                                                 at(-0.5, 0), false);
  pintle::GearJoint gear(fixed, other, 2);
  EXPECT_EQ(&gear.getRigidBodyA(), &written.b);
  EXPECT_EQ(gear.getAxisA(), at(0.5, 0.3).getBasis().getColumn(2));
  EXPECT_EQ(&gear.getRigidBodyB(), &written.a);
  EXPECT_EQ(gear.getAxisB(), at(0.5, 0).getBasis().getColumn(2));
}

TEST(BulletFile, ASliderIsLoadedAsBullets) {
  Boxes written;
  auto& slider = written.world.add_joint<pintle::SliderJoint>(written.a, written.b, at(0.5, 0.3),
                                                              at(-0.5, 0.3), true);
  slider.setLowerLinLimit(btScalar(-0.5));
  slider.setUpperLinLimit(btScalar(0.75));
  slider.setLowerAngLimit(btScalar(-0.25));
  slider.setUpperAngLimit(btScalar(0.125));
  Loaded loaded(written.world.bullet());
  auto* const of = onlyJoint<btSliderConstraint>(loaded);
  ASSERT_NE(of, nullptr);
  EXPECT_FLOAT_EQ(float(of->getLowerLinLimit()), -0.5f);
  EXPECT_FLOAT_EQ(float(of->getUpperLinLimit()), 0.75f);
  EXPECT_FLOAT_EQ(float(of->getLowerAngLimit()), -0.25f);
  EXPECT_FLOAT_EQ(float(of->getUpperAngLimit()), 0.125f);
  EXPECT_TRUE(of->getUseLinearReferenceFrameA());
  EXPECT_EQ(of->getFrameOffsetA().getOrigin(), slider.getFrameOffsetA().getOrigin());
}

TEST(BulletFile, AConeTwistIsLoadedAsBullets) {
  Boxes written;
  auto& cone = written.world.add_joint<pintle::ConeTwistJoint>(written.b, written.a, at(-0.5, 0.3),
                                                               at(0.5, 0.3));
  cone.setLimit(btScalar(0.5), btScalar(0.75), btScalar(0.25), btScalar(0.875), btScalar(0.625),
                btScalar(0.5));
  cone.setDamping(btScalar(0.125));
  // Bullet's file has the larger side for both.
  cone.setTwistLimit(btScalar(-0.375), btScalar(0.125));
  Loaded loaded(written.world.bullet());
  const auto* const of = onlyJoint<btConeTwistConstraint>(loaded);
  ASSERT_NE(of, nullptr);
  EXPECT_FLOAT_EQ(float(of->getSwingSpan1()), 0.5f);
  EXPECT_FLOAT_EQ(float(of->getSwingSpan2()), 0.75f);
  EXPECT_FLOAT_EQ(float(of->getTwistSpan()), 0.375f);
  EXPECT_FLOAT_EQ(float(of->getLimitSoftness()), 0.875f);
  EXPECT_FLOAT_EQ(float(of->getBiasFactor()), 0.625f);
  EXPECT_FLOAT_EQ(float(of->getRelaxationFactor()), 0.5f);
  EXPECT_FLOAT_EQ(float(of->getDamping()), 0.125f);
  EXPECT_EQ(of->getAFrame().getOrigin(), cone.getAFrame().getOrigin());
  for (int i = 0; i < 60; ++i) loaded.world().stepSimulation(btScalar(1. / 60), 0);
}

// Files of any of them, and that a loaded one moves.
template <class Stock, class J>
void expectLoadedAsBullets() {
  Boxes written;
  auto& joint = written.world.add_joint<J>(written.a, written.b, at(0.5, 0.3), at(-0.5, 0.3));
  for (int i = 0; i < 6; ++i)
    joint.setLimit(i, btScalar(-0.125) * btScalar(i), btScalar(0.25) * btScalar(i));
  Loaded loaded(written.world.bullet());
  auto* const of = onlyJoint<Stock>(loaded);
  ASSERT_NE(of, nullptr);
  btVector3 low, high, low_angle, high_angle;
  of->getLinearLowerLimit(low);
  of->getLinearUpperLimit(high);
  of->getAngularLowerLimit(low_angle);
  of->getAngularUpperLimit(high_angle);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FLOAT_EQ(float(low[i]), -0.125f * float(i));
    EXPECT_FLOAT_EQ(float(high[i]), 0.25f * float(i));
    EXPECT_NEAR(double(low_angle[i]), -0.125 * (3 + i), 1e-6);
    EXPECT_NEAR(double(high_angle[i]), 0.25 * (3 + i), 1e-6);
  }
  EXPECT_EQ(of->getFrameOffsetA().getOrigin(), joint.getFrameOffsetA().getOrigin());
  for (int i = 0; i < 60; ++i) loaded.world().stepSimulation(btScalar(1. / 60), 0);
}

// (Files keep only Bullet's type number: a hinge 2 is the joint that its settings make.)
TEST(BulletFile, JointsOfSixDegreesOfFreedomAreLoadedAsBullets) {
  expectLoadedAsBullets<btGeneric6DofConstraint, pintle::Generic6DofJoint>();
  expectLoadedAsBullets<btGeneric6DofSpringConstraint, pintle::Generic6DofSpringJoint>();
  expectLoadedAsBullets<btGeneric6DofSpring2Constraint, pintle::Generic6DofSpring2Joint>();
  expectLoadedAsBullets<btGeneric6DofSpring2Constraint, pintle::Hinge2Joint>();
}

TEST(BulletFile, SpringsAreLoadedAsBullets) {
  Boxes written;
  auto& joint = written.world.add_joint<pintle::Generic6DofSpring2Joint>(
      written.a, written.b, at(0.5, 0.3), at(-0.5, 0.3));
  joint.enableSpring(4, true);
  joint.setStiffness(4, 20);
  joint.setDamping(4, btScalar(0.5));
  joint.setEquilibriumPoint(4, btScalar(0.25));
  Loaded loaded(written.world.bullet());
  auto* const of = onlyJoint<btGeneric6DofSpring2Constraint>(loaded);
  ASSERT_NE(of, nullptr);
  const btRotationalLimitMotor2& motor = *of->getRotationalLimitMotor(1);
  EXPECT_TRUE(motor.m_enableSpring);
  EXPECT_FLOAT_EQ(float(motor.m_springStiffness), 20);
  EXPECT_FLOAT_EQ(float(motor.m_springDamping), 0.5f);
  EXPECT_FLOAT_EQ(float(motor.m_equilibriumPoint), 0.25f);
}

}  // namespace
