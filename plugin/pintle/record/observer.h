// Purpose: looks at a world step by step. It copies and compares; whatever else is to be computed waits until the
// recording is written.
#pragma once

#include <pintle/record/recording.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <chrono>
#include <deque>
#include <unordered_map>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

class Observer : private btActionInterface {
 public:
  Observer(btDynamicsWorld& world, RecorderOptions options);
  ~Observer() override;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;

  void begin();
  void step();

  Recording& recording() { return m_recording; }
  std::size_t bytes() const { return m_bytes; }
  double time() const { return m_time; }

 private:
  using Clock = std::chrono::steady_clock;

  // In the world's order.
  struct Object {
    const btCollisionObject* object;
    const btCollisionShape* shape;
    int body, slot;
  };
  struct Seen {
    btTypedConstraint* constraint;
    int index;
  };

  void updateAction(btCollisionWorld*, btScalar dt) override;
  void debugDraw(btIDebugDraw*) override {}

  void capture();
  void dropFrames();
  bool lookForBodies();  // whether others are there than before
  void lookForConstraints(bool bodies_changed);
  void lookForTrees(bool bodies_changed);
  void lookForMoves();
  Object addBody(const btCollisionObject& object);
  int addShape(const btCollisionShape* shape);
  int addConstraint(const Description& description, int a, int b);
  void feed(btTypedConstraint& constraint);
  int bodyOf(const btCollisionObject* object) const;
  static void read(const btCollisionObject& object, State& state);
  void readVelocities(btMultiBody& tree, Frame& frame);
  void readContacts(Frame& frame);
  float impulseOf(btTypedConstraint& constraint) const;

  btDynamicsWorld& m_world;
  btMultiBodyDynamicsWorld* const m_trees;  // null: the world has none
  Recording m_recording;
  std::vector<Object> m_objects;
  std::vector<Seen> m_constraints;
  std::vector<btMultiBody*> m_tree_list;
  std::vector<int> m_tree_constraints;
  std::unordered_map<const btCollisionObject*, int> m_body_of;
  std::unordered_map<const btCollisionShape*, int> m_shape_of;
  std::deque<btJointFeedback> m_feedback;  // of constraints that had none
  std::vector<btTypedConstraint*> m_fed;
  std::vector<Contact> m_contacts;
  btAlignedObjectArray<btVector3> m_tree_linear,
      m_tree_angular;  // of one tree, in its links' frames
  int m_slots = 0, m_next_number = 0;
  std::size_t m_bytes = 0;
  double m_time = 0, m_next_time = 0, m_interval, m_last_dt = 0;  // s
  int m_substeps = 0;                                             // since the last step()
  Clock::time_point m_begun;
  bool m_is_timed = false;
  double m_step_seconds = 0;  // of steps since the last frame
  int m_timed_steps = 0;
};

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
