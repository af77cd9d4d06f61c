#include <pintle/record/observer.h>
#include <pintle/record/shapes.h>

#include <pintle/bullet/private_member.h>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pintle {
namespace {

// Public from Bullet 2.87 on.
using LinkVelocities = void(btVector3* angular, btVector3* linear) const;
PINTLE_PRIVATE_MEMBER(TreeVelocities, LinkVelocities, btMultiBody, compTreeLinkVelocities);

}  // namespace

inline namespace PINTLE_PRECISION {
namespace record {
namespace {

constexpr int max_contacts = 1024;  // of a frame: those that come first
constexpr std::size_t min_frames = 4;

void copy(const btVector3& from, btScalar* to) {
  to[0] = from.x();
  to[1] = from.y();
  to[2] = from.z();
}

const btCollisionObject* colliderOf(const btMultiBody& tree, int link) {
  if (link < 0) return tree.getBaseCollider();
  return tree.getLink(link).m_collider;
}

const btMultiBodyLinkCollider* linkOf(const btCollisionObject& object) {
  return btMultiBodyLinkCollider::upcast(&object);
}

void readBody(const btCollisionObject& object, Body& body, const btVector3& gravity) {
  body.kind = object.isKinematicObject() ? "kinematic" : "static";
  if (const btRigidBody* const rigid = btRigidBody::upcast(&object)) {
    if (object.isStaticOrKinematicObject() || !(rigid->getInvMass() > 0)) return;
    body.kind = "dynamic";
    body.mass = 1 / double(rigid->getInvMass());
    body.inertia = rigid->getLocalInertia();
    body.gravity = rigid->getGravity();
  } else if (const btMultiBodyLinkCollider* const link = linkOf(object)) {
    const btMultiBody& tree = *link->m_multiBody;
    const bool is_base = link->m_link < 0;
    if (is_base && tree.hasFixedBase()) return;
    body.kind = "link";
    body.mass = double(is_base ? tree.getBaseMass() : tree.getLinkMass(link->m_link));
    body.inertia = is_base ? tree.getBaseInertia() : tree.getLinkInertia(link->m_link);
    body.gravity = gravity;
  }
}

}  // namespace

Observer::Observer(btDynamicsWorld& world, RecorderOptions options)
    : m_world(world),
      m_trees(dynamic_cast<btMultiBodyDynamicsWorld*>(&world)),
      m_interval(1 / options.frames_per_second) {
  m_recording.options = std::move(options);
  m_recording.gravity = world.getGravity();
  world.addAction(this);
  capture();
  m_next_time = m_interval;
}

Observer::~Observer() {
  m_world.removeAction(this);
  for (std::size_t i = 0; i < m_fed.size(); ++i) {
    if (m_fed[i]->getJointFeedback() == &m_feedback[i]) m_fed[i]->setJointFeedback(nullptr);
  }
}

void Observer::updateAction(btCollisionWorld*, btScalar dt) {
  m_time += double(dt);
  m_last_dt = double(dt);
  ++m_substeps;
}

void Observer::begin() {
  m_is_timed = true;
  m_begun = Clock::now();
}

void Observer::step() {
  if (m_is_timed) {
    m_step_seconds += std::chrono::duration<double>(Clock::now() - m_begun).count();
    m_timed_steps += m_substeps;
    m_is_timed = false;
  }
  if (m_substeps == 0) return;
  m_substeps = 0;
  if (m_time < m_next_time - m_last_dt / 2) return;
  m_next_time = std::max(m_next_time + m_interval, m_time + m_interval / 2);
  capture();
}

void Observer::capture() {
  const bool changed = lookForBodies();
  lookForConstraints(changed);
  if (m_trees != nullptr) lookForTrees(changed);
  lookForMoves();

  Frame frame;
  frame.number = m_next_number++;
  frame.time = m_time;
  if (m_timed_steps > 0) frame.step_seconds = m_step_seconds / m_timed_steps;
  m_step_seconds = 0;
  m_timed_steps = 0;
  frame.states = m_slots;
  frame.state.reset(new State[std::size_t(m_slots)]);
  for (const Object& object : m_objects) {
    if (object.slot >= 0) read(*object.object, frame.state[std::size_t(object.slot)]);
  }
  for (btMultiBody* const tree : m_tree_list) readVelocities(*tree, frame);
  frame.impulses = int(m_recording.constraints.size());
  frame.impulse.reset(new float[std::size_t(frame.impulses)]());
  for (const Seen& seen : m_constraints)
    frame.impulse[std::size_t(seen.index)] = impulseOf(*seen.constraint);
  readContacts(frame);
  m_bytes += frame.bytes();
  m_recording.frames.push_back(std::move(frame));
  while (m_bytes > m_recording.options.max_bytes && m_recording.frames.size() > min_frames)
    dropFrames();
}

// Every second one, but not the first.
void Observer::dropFrames() {
  std::vector<Frame>& frames = m_recording.frames;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < frames.size(); i += 2) {
    if (i != kept) frames[kept] = std::move(frames[i]);
    ++kept;
  }
  frames.resize(kept);
  m_bytes = 0;
  for (const Frame& frame : frames) m_bytes += frame.bytes();
  m_interval *= 2;
  m_recording.stride *= 2;
  m_next_time = frames.back().time + m_interval;
}

void Observer::read(const btCollisionObject& object, State& state) {
  const btTransform& pose = object.getWorldTransform();
  for (int i = 0; i < 3; ++i) copy(pose.getBasis()[i], state.basis + 3 * i);
  copy(pose.getOrigin(), state.origin);
  if (const btRigidBody* const rigid = btRigidBody::upcast(&object)) {
    copy(rigid->getLinearVelocity(), state.velocity);
    copy(rigid->getAngularVelocity(), state.angular_velocity);
  } else {
    std::memset(state.velocity, 0, sizeof state.velocity);
    std::memset(state.angular_velocity, 0, sizeof state.angular_velocity);
  }
}

// Links keep none of their own in the world's frame.
void Observer::readVelocities(btMultiBody& tree, Frame& frame) {
  m_tree_linear.resize(tree.getNumLinks() + 1);
  m_tree_angular.resize(tree.getNumLinks() + 1);
  (tree.*pointer(TreeVelocities()))(&m_tree_angular[0], &m_tree_linear[0]);
  for (int link = -1; link < tree.getNumLinks(); ++link) {
    const btCollisionObject* const collider = colliderOf(tree, link);
    const int body = bodyOf(collider);
    if (body < 0 || m_recording.bodies[std::size_t(body)].slot < 0) continue;
    State& state = frame.state[std::size_t(m_recording.bodies[std::size_t(body)].slot)];
    const btMatrix3x3& turn = collider->getWorldTransform().getBasis();
    copy(turn * m_tree_linear[link + 1], state.velocity);
    copy(turn * m_tree_angular[link + 1], state.angular_velocity);
  }
}

void Observer::readContacts(Frame& frame) {
  m_contacts.clear();
  btDispatcher& dispatcher = *m_world.getDispatcher();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    // Bullet has some between bodies that never move, too.
    if (manifold.getBody0()->isStaticObject() && manifold.getBody1()->isStaticObject()) continue;
    for (int j = 0; j < manifold.getNumContacts(); ++j) {
      const btManifoldPoint& point = manifold.getContactPoint(j);
      if (point.getDistance() > 0 && !(point.getAppliedImpulse() > 0)) continue;
      if (int(m_contacts.size()) >= max_contacts) break;
      const btVector3& at = point.getPositionWorldOnB();
      m_contacts.push_back(
          {{float(at.x()), float(at.y()), float(at.z())}, float(point.getAppliedImpulse())});
    }
  }
  frame.contacts = m_contacts;  // a copy has no room to spare
}

float Observer::impulseOf(btTypedConstraint& constraint) const {
  const btJointFeedback* const feedback = constraint.getJointFeedback();
  if (feedback == nullptr) return float(btFabs(constraint.internalGetAppliedImpulse()));
  return float(double(feedback->m_appliedForceBodyB.length()) * m_last_dt);
}

bool Observer::lookForBodies() {
  const btCollisionObjectArray& now = m_world.getCollisionObjectArray();
  bool same = std::size_t(now.size()) == m_objects.size();
  for (std::size_t i = 0; same && i < m_objects.size(); ++i)
    same = m_objects[i].object == now[int(i)] &&
           m_objects[i].shape == now[int(i)]->getCollisionShape();
  if (same) return false;

  std::unordered_map<const btCollisionObject*, Object> before;
  for (const Object& object : m_objects) before[object.object] = object;
  m_objects.clear();
  m_body_of.clear();
  m_shape_of.clear();  // another shape may have come to an address
  for (int i = 0; i < now.size(); ++i) {
    const auto found = before.find(now[i]);
    if (found != before.end() && found->second.shape == now[i]->getCollisionShape()) {
      m_objects.push_back(found->second);
      before.erase(found);
    } else {
      m_objects.push_back(addBody(*now[i]));
    }
    m_body_of[now[i]] = m_objects.back().body;
  }
  for (const auto& gone : before)
    m_recording.bodies[std::size_t(gone.second.body)].lifetime.end(m_next_number);
  return true;
}

Observer::Object Observer::addBody(const btCollisionObject& object) {
  Body body;
  body.shape = addShape(object.getCollisionShape());
  readBody(object, body, m_recording.gravity);
  if (body.kind != "static") body.slot = m_slots++;
  read(object, body.initial);
  body.lifetime.begin(m_next_number);
  m_recording.bodies.push_back(body);
  return {&object, object.getCollisionShape(), int(m_recording.bodies.size()) - 1, body.slot};
}

int Observer::addShape(const btCollisionShape* shape) {
  const auto found = m_shape_of.find(shape);
  if (found != m_shape_of.end()) return found->second;
  const std::string text = shape != nullptr ? describeShape(*shape) : "{\"kind\":\"none\"}";
  std::vector<std::string>& shapes = m_recording.shapes;
  const int index = int(std::find(shapes.begin(), shapes.end(), text) - shapes.begin());
  if (index == int(shapes.size())) shapes.push_back(text);
  return m_shape_of[shape] = index;
}

int Observer::bodyOf(const btCollisionObject* object) const {
  const auto found = m_body_of.find(object);
  return found != m_body_of.end() ? found->second : -1;
}

// What is static stays where it is, until somebody puts it elsewhere.
void Observer::lookForMoves() {
  for (Object& object : m_objects) {
    if (object.slot >= 0) continue;
    Body& body = m_recording.bodies[std::size_t(object.body)];
    State now;
    read(*object.object, now);
    if (std::memcmp(&now, &body.initial, sizeof now) != 0) object.slot = body.slot = m_slots++;
  }
}

// One that has broken, or was disabled, is gone.
template <class Visit>
static void forEachEnabled(btDynamicsWorld& world, const Visit& visit) {
  for (int i = 0; i < world.getNumConstraints(); ++i)
    if (btTypedConstraint* const one = world.getConstraint(i); one->isEnabled()) visit(one);
}

void Observer::lookForConstraints(bool bodies_changed) {
  // Settings that a program makes after the recorder belong to the first step.
  bool same = !bodies_changed && m_next_number != 1;
  std::size_t seen = 0;
  forEachEnabled(m_world, [&](btTypedConstraint* constraint) {
    same = same && seen < m_constraints.size() && m_constraints[seen].constraint == constraint;
    ++seen;
  });
  if (same && seen == m_constraints.size()) return;

  std::unordered_map<const btTypedConstraint*, int> before;
  for (const Seen& of : m_constraints) before[of.constraint] = of.index;
  m_constraints.clear();
  forEachEnabled(m_world, [&](btTypedConstraint* constraint) {
    const int a = bodyOf(&constraint->getRigidBodyA()), b = bodyOf(&constraint->getRigidBodyB());
    const auto found = before.find(constraint);
    int index = found != before.end() ? found->second : -1;
    if (index >= 0) {
      Constraint& known = m_recording.constraints[std::size_t(index)];
      if (known.a != a || known.b != b) index = -1;
      if (index >= 0 && m_next_number == 1) known.description = describe(*constraint);
    }
    if (index >= 0) {
      before.erase(found);
    } else {
      index = addConstraint(describe(*constraint), a, b);
      feed(*constraint);
    }
    m_constraints.push_back({constraint, index});
  });
  for (const auto& gone : before)
    m_recording.constraints[std::size_t(gone.second)].lifetime.end(m_next_number);
}

int Observer::addConstraint(const Description& description, int a, int b) {
  Constraint constraint{description, a, b, {}};
  constraint.lifetime.begin(m_next_number);
  m_recording.constraints.push_back(constraint);
  return int(m_recording.constraints.size()) - 1;
}

void Observer::feed(btTypedConstraint& constraint) {
  if (!m_recording.options.measure_forces || constraint.getJointFeedback() != nullptr) return;
  m_feedback.emplace_back();
  constraint.setJointFeedback(&m_feedback.back());
  m_fed.push_back(&constraint);
}

void Observer::lookForTrees(bool bodies_changed) {
  const int count = m_trees->getNumMultibodies();
  bool same = std::size_t(count) == m_tree_list.size() && !bodies_changed;
  for (int i = 0; same && i < count; ++i)
    same = m_tree_list[std::size_t(i)] == m_trees->getMultiBody(i);
  if (same) return;

  for (const int index : m_tree_constraints)
    m_recording.constraints[std::size_t(index)].lifetime.end(m_next_number);
  m_tree_constraints.clear();
  m_tree_list.clear();
  for (int i = 0; i < count; ++i) {
    btMultiBody& tree = *m_trees->getMultiBody(i);
    m_tree_list.push_back(&tree);
    for (int link = 0; link < tree.getNumLinks(); ++link) {
      const int parent = tree.getParent(link);
      const int a = bodyOf(colliderOf(tree, parent)), b = bodyOf(colliderOf(tree, link));
      if (b < 0 || (a < 0 && !(parent < 0 && tree.hasFixedBase())))
        continue;  // nothing to draw it at
      Description description = describe(tree.getLink(link));
      if (a < 0) description.in_a = tree.getBaseWorldTransform() * description.in_a;
      m_tree_constraints.push_back(addConstraint(description, a, b));
    }
  }
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
