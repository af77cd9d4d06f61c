// A recording, read back from what was written of it.
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <gtest/gtest.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/record.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "json.h"
#include "recordings.h"
#include "support.h"

namespace record_test {

using pintle::Recorder;
using pintle::RecorderOptions;
using recordings::series;
using recordings::values;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

RecorderOptions every_step() {
  RecorderOptions options;
  options.frames_per_second = 1 / dt;
  return options;
}

// A link that swings on a hinge at the origin.
struct Pendulum {
  scenes::World world;
  btRigidBody& link = world.add_box(2, vec(0.5, 0.1, 0.1), scenes::pose_at(vec(0.5, 0, 0)));
  pintle::QuaternionHinge& hinge =
      world.add_joint<pintle::QuaternionHinge>(link, vec(-0.5, 0, 0), vec(0, 1, 0));

  void run(Recorder& record, int steps) {
    for (int i = 0; i < steps; ++i) {
      record.begin();
      world.step(dt);
      record.step();
    }
  }
};

TEST(Recorder, PosesAreThoseOfTheWorld) {
  Pendulum pendulum;
  RecorderOptions options = every_step();
  options.name = "mine";
  Recorder record(pendulum.world.bullet(), options);
  std::vector<btTransform> poses = {pendulum.link.getWorldTransform()};
  for (int i = 0; i < 30; ++i) {
    pendulum.run(record, 1);
    poses.push_back(pendulum.link.getWorldTransform());
  }
  const json::Value run = json::read(record.toJson());
  EXPECT_EQ(run["name"].text, "mine");
  EXPECT_EQ(run["frames"].number, 31);
  const std::vector<float> times = run["times"].floats(), written = run["poses"].floats();
  ASSERT_EQ(times.size(), 31u);
  ASSERT_EQ(written.size(), 31u * 7);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(times[i], double(i) * dt, 1e-5);
    const btVector3& p = poses[i].getOrigin();
    const btQuaternion q = poses[i].getRotation();
    const btScalar wanted[] = {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
    for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(written[7 * i + k], float(wanted[k]));
  }
}

TEST(Recorder, WorldsNumbersStayTheSame) {
  Pendulum plain, recorded;
  RecorderOptions options = every_step();
  options.measure_forces = true;
  Recorder record(recorded.world.bullet(), options);
  for (int i = 0; i < 60; ++i) {
    plain.world.step(dt);
    recorded.run(record, 1);
    ASSERT_EQ(0, std::memcmp(&plain.link.getWorldTransform(), &recorded.link.getWorldTransform(),
                             sizeof(btTransform)));
  }
}

TEST(Recorder, EnergyAndForces) {
  Pendulum pendulum;
  RecorderOptions options = every_step();
  options.measure_forces = true;
  Recorder record(pendulum.world.bullet(), options);
  pendulum.run(record, 60);
  const json::Value run = json::read(record.toJson());
  const std::vector<float> total = values(run, "total"), potential = values(run, "potential"),
                           linear = values(run, "linear"), angular = values(run, "angular"),
                           impulse = values(run, "impulse"), step = values(run, "step");
  ASSERT_EQ(total.size(), 61u);
  for (std::size_t i = 0; i < total.size(); ++i) {
    EXPECT_NEAR(total[i], linear[i] + angular[i] + potential[i], 1e-4);
    EXPECT_NEAR(total[i], 0, 0.05 * 2 * 9.81 * 0.5);
  }
  EXPECT_GT(*std::max_element(linear.begin(), linear.end()), 1);
  EXPECT_GT(*std::max_element(angular.begin(), angular.end()), 0.1);
  // At the lowest point it bears its weight and the centripetal force, which is 1.5 m g for a rod.
  const double weight = 2 * 9.81;
  EXPECT_NEAR(*std::max_element(impulse.begin(), impulse.end()), 2.5 * weight * dt,
              0.15 * weight * dt);
  EXPECT_TRUE(std::isnan(step[0]));
  EXPECT_GT(step[1], 0);
}

TEST(Recorder, TimeOfStepsOnlyWhereItIsMeasured) {
  Pendulum pendulum;
  Recorder record(pendulum.world.bullet(), every_step());
  for (int i = 0; i < 5; ++i) {
    pendulum.world.step(dt);
    record.step();
  }
  EXPECT_EQ(series(json::read(record.toJson()), "step"), nullptr);
}

TEST(Recorder, FramesComeAsOftenAsAskedFor) {
  Pendulum pendulum;
  RecorderOptions options = every_step();
  options.frames_per_second = 20;
  Recorder record(pendulum.world.bullet(), options);
  pendulum.run(record, 60);
  EXPECT_EQ(record.getNumFrames(), 21);
  EXPECT_NEAR(record.getTime(), 1, 1e-4);
  const std::vector<float> times = json::read(record.toJson())["times"].floats();
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], double(i) / 20, 1e-4);
  record.step();  // no substep since
  EXPECT_EQ(record.getNumFrames(), 21);
}

TEST(Recorder, MemoryIsBounded) {
  Pendulum pendulum;
  RecorderOptions options = every_step();
  options.max_bytes = 20000;
  Recorder record(pendulum.world.bullet(), options);
  for (int i = 0; i < 2000; ++i) {
    pendulum.run(record, 1);
    ASSERT_LE(record.getNumBytes(), options.max_bytes);
  }
  EXPECT_GT(record.getStride(), 2);
  EXPECT_GT(record.getNumFrames(), 20);
  const std::vector<float> times = json::read(record.toJson())["times"].floats();
  EXPECT_EQ(times[0], 0);
  for (std::size_t i = 1; i < times.size(); ++i)
    EXPECT_NEAR(times[i] - times[i - 1], dt * record.getStride(), 1e-3);
}

TEST(Recorder, BodiesComeAndGo) {
  scenes::World world;
  world.add_box(1, vec(1, 1, 1), scenes::pose_at(vec(0, 0, 0)));
  btBoxShape shape(vec(1, 1, 1));
  btRigidBody guest(1, nullptr, &shape, vec(1, 1, 1));
  guest.setCenterOfMassTransform(scenes::pose_at(vec(0, 9, 0)));
  btPoint2PointConstraint joint(guest, vec(0, 0, 0));
  Recorder record(world.bullet(), every_step());
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      world.step(dt);
      record.step();
    }
  };
  run(3);  // frames 0 to 3
  world.bullet().addRigidBody(&guest);
  world.bullet().addConstraint(&joint);
  run(4);
  world.bullet().removeConstraint(&joint);
  world.bullet().removeRigidBody(&guest);
  run(2);
  const json::Value written = json::read(record.toJson());
  ASSERT_EQ(written["bodies"].size(), 2);
  const json::Value& alive = written["bodies"][1]["alive"];
  ASSERT_EQ(alive.size(), 1);
  EXPECT_EQ(alive[0][0].number, 4);
  EXPECT_EQ(alive[0][1].number, 8);
  EXPECT_EQ(written["joints"][0]["alive"][0][0].number, 4);
  EXPECT_EQ(written["joints"][0]["alive"][0][1].number, 8);
  const std::vector<float> poses = written["poses"].floats();
  EXPECT_TRUE(std::isnan(poses[7 * (10 + 3)]));
  EXPECT_EQ(poses[7 * (10 + 4) + 1], 9);
  EXPECT_TRUE(std::isnan(poses[7 * (10 + 8)]));
}

TEST(Recorder, NotFiniteIsWrittenAsSuch) {
  Pendulum pendulum;
  Recorder record(pendulum.world.bullet(), every_step());
  pendulum.run(record, 2);
  pendulum.link.setWorldTransform(scenes::pose_at(vec(NAN, 0, 0)));
  pendulum.run(record, 1);
  const json::Value run = json::read(record.toJson());
  EXPECT_TRUE(std::isnan(run["poses"].floats()[7 * 3]));
  EXPECT_EQ(run["bodies"][0]["alive"][0][1].number, 4);
}

TEST(Recorder, StaticBodiesAreWrittenOnceUntilTheyMove) {
  scenes::World world;
  btRigidBody& still = world.add_box(0, vec(1, 1, 1), scenes::pose_at(vec(0, 0, -1)));
  btRigidBody& moved = world.add_box(0, vec(1, 1, 1), scenes::pose_at(vec(5, 0, -1)));
  Recorder record(world.bullet(), every_step());
  for (int i = 0; i < 4; ++i) {
    if (i == 2) moved.setWorldTransform(scenes::pose_at(vec(5, 0, 7)));
    world.step(dt);
    record.step();
  }
  (void)still;
  const json::Value run = json::read(record.toJson());
  EXPECT_EQ(run["bodies"][0]["pose"][2].number, -1);
  EXPECT_EQ(run["bodies"][0].members.count("track"), 0u);
  const std::vector<float> poses = run["poses"].floats();
  ASSERT_EQ(poses.size(), 5u * 7);
  EXPECT_EQ(poses[2], -1);
  EXPECT_EQ(poses[7 * 2 + 2], -1);
  EXPECT_EQ(poses[7 * 3 + 2], 7);
}

TEST(Recorder, LinksOfMultiBodies) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(vec(0, 0, -9.81));
  btBoxShape shape(vec(0.5, 0.1, 0.1));
  btMultiBody tree(1, 0, vec(0, 0, 0), true, false);
  tree.setupRevolute(0, 2, vec(0.1, 0.2, 0.2), -1, btQuaternion::getIdentity(), vec(0, 1, 0),
                     vec(0, 0, 0), vec(0.5, 0, 0), true);
  tree.finalizeMultiDof();
  tree.setLinearDamping(0);
  tree.setAngularDamping(0);
  btMultiBodyLinkCollider collider(&tree, 0);
  collider.setCollisionShape(&shape);
  world.addCollisionObject(&collider, 1, 0);
  tree.getLink(0).m_collider = &collider;
  world.addMultiBody(&tree);
  btAlignedObjectArray<btQuaternion> turns;
  btAlignedObjectArray<btVector3> origins;
  tree.forwardKinematics(turns, origins);
  tree.updateCollisionObjectWorldTransforms(turns, origins);
  {
    Recorder record(world, every_step());
    for (int i = 0; i < 30; ++i) {
      world.stepSimulation(scalar(dt), 0);
      record.step();
    }
    const json::Value run = json::read(record.toJson());
    EXPECT_EQ(run["bodies"][0]["kind"].text, "link");
    EXPECT_EQ(run["joints"][0]["type"].text, "btMultiBody");
    EXPECT_EQ(run["joints"][0]["a"].number, -1);
    const std::vector<float> gap = values(run, "gap"), total = values(run, "total"),
                             linear = values(run, "linear");
    EXPECT_LT(*std::max_element(gap.begin(), gap.end()), 1e-5);
    EXPECT_GT(linear.back(), 1);
    EXPECT_NEAR(total.back(), total.front(), 0.6);
  }
  world.removeMultiBody(&tree);
  world.removeCollisionObject(&collider);
}

TEST(Recorder, BadSettingsAreSaid) {
  scenes::World world;
  const auto rejects = [&](void (*change)(RecorderOptions&), const char* named) {
    RecorderOptions options;
    change(options);
    try {
      Recorder record(world.bullet(), options);
      ADD_FAILURE() << named;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  };
  rejects([](RecorderOptions& o) { o.frames_per_second = 0; }, "frames_per_second");
  rejects([](RecorderOptions& o) { o.frames_per_second = NAN; }, "frames_per_second");
  rejects([](RecorderOptions& o) { o.frames_per_second = HUGE_VAL; }, "frames_per_second");
  rejects([](RecorderOptions& o) { o.max_bytes = 0; }, "max_bytes");
  rejects([](RecorderOptions& o) { o.name.clear(); }, "name");
  rejects([](RecorderOptions& o) { o.colour = "red"; }, "colour");
  Recorder record(world.bullet());
  EXPECT_THROW(record.addFigure("", "m", 1), std::invalid_argument);
  EXPECT_THROW(pintle::writePage("page.html", {}), std::invalid_argument);
}

TEST(Recorder, WritesAPage) {
  Pendulum pendulum;
  RecorderOptions options;
  options.text = "</script><!-- \"quoted\" \\ \n";
  Recorder a(pendulum.world.bullet(), options), b(pendulum.world.bullet(), "other");
  b.addFigure("error", "m", 0.125);
  b.addFigure("lost", "m", HUGE_VAL);
  const std::string directory = testing::TempDir(), form = directory + "pintle_form.html",
                    page = directory + "pintle_page.html";
  std::ofstream(form) << "<p>before</p><!-- pintle: runs --><p>after</p>";
  pintle::writePage(page, {a, b}, form);
  std::ostringstream text;
  text << std::ifstream(page).rdbuf();
  const std::string written = text.str(), open = "class=\"pintle-run\">", close = "</script>";
  EXPECT_EQ(written.find("<p>before</p><script"), 0u);
  EXPECT_NE(written.find("</script>\n<p>after</p>"), std::string::npos);
  std::vector<json::Value> runs;
  for (std::size_t at = written.find(open); at != std::string::npos; at = written.find(open, at)) {
    at += open.size();
    runs.push_back(json::read(written.substr(at, written.find(close, at) - at)));
  }
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["text"].text, options.text);
  EXPECT_EQ(runs[1]["name"].text, "other");
  EXPECT_EQ(runs[1]["figures"][0]["value"].number, 0.125);
  EXPECT_TRUE(std::isnan(runs[1]["figures"][1]["value"].number));

  EXPECT_THROW(a.write(page, directory + "no such file"), std::runtime_error);
  EXPECT_THROW(a.write(directory + "no such directory/page.html", form), std::runtime_error);
  std::ofstream(form) << "no place";
  EXPECT_THROW(a.write(page, form), std::runtime_error);
}

}  // namespace record_test
