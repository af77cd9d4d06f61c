// Bodies and joints of an island, sorted by who hangs together.
#include <pintle/solver/bullet/island_builder.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pintle {
inline namespace PINTLE_PRECISION {

namespace {

// Element i comes to number to[i]. Mostly they are sorted.
template <class T>
void moveTo(const std::vector<int>& to, std::vector<T>& elements, std::vector<T>& memory) {
  if (std::is_sorted(to.begin(), to.end())) return;
  memory.resize(elements.size());
  for (size_t i = 0; i < elements.size(); ++i) memory[size_t(to[i])] = elements[i];
  elements.swap(memory);
}

}  // namespace

void IslandBuilder::finish(std::vector<Component>& components) {
  // Union of bodies that a joint connects.
  const size_t n = m_island.bodies.size();
  std::vector<int>&root = m_root, &number = m_number, &to = m_to;
  root.resize(n);
  number.assign(n, -1);
  to.resize(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[size_t(i)] != i) i = root[size_t(i)] = root[size_t(root[size_t(i)])];
    return i;
  };
  for (const IslandJoint& joint : m_island.joints)
    if (joint.body[0] >= 0 && joint.body[1] >= 0)
      root[size_t(find(joint.body[0]))] = find(joint.body[1]);
  components.clear();
  const auto numberOf = [&](int body) -> int& { return number[size_t(find(body))]; };
  const auto numberOfJoint = [&](const IslandJoint& joint) {
    return size_t(numberOf(joint.body[0] >= 0 ? joint.body[0] : joint.body[1]));
  };
  for (size_t i = 0; i < n; ++i) {
    int& known = numberOf(int(i));
    if (known < 0) {
      known = int(components.size());
      components.emplace_back();
    }
    ++components[size_t(known)].bodies;
  }
  for (const IslandJoint& joint : m_island.joints) ++components[numberOfJoint(joint)].joints;
  int first_body = 0, first_joint = 0;
  for (Component& c : components) {
    c.first_body = first_body;
    c.first_joint = first_joint;
    first_body += c.bodies;
    first_joint += c.joints;
    c.bodies = c.joints = 0;  // and counted again, as they come to their places
  }
  std::vector<int>& joints_to = m_joints_to;
  joints_to.clear();
  for (IslandJoint& joint : m_island.joints) {
    Component& c = components[numberOfJoint(joint)];
    joints_to.push_back(c.first_joint + c.joints++);
    joint.row_of_component = c.rows;
    c.rows += joint.rows;
    c.lever = std::max({c.lever, joint.lever[0], joint.lever[1]});
    c.is_anchored = c.is_anchored || joint.body[0] < 0 || joint.body[1] < 0;
  }
  for (size_t i = 0; i < n; ++i) {
    Component& c = components[size_t(numberOf(int(i)))];
    to[i] = c.first_body + c.bodies++;
  }
  moveTo(to, m_island.bodies, m_sorted_bodies);
  moveTo(joints_to, m_island.joints, m_sorted_joints);
  for (IslandJoint& joint : m_island.joints)
    for (int& body : joint.body)
      if (body >= 0) body = to[size_t(body)];
  for (int& known : m_body_of)
    if (known >= 0) known = to[size_t(known)];
  // A body whose joints have no rows is free.
  components.erase(std::remove_if(components.begin(), components.end(),
                                  [](const Component& c) { return c.joints == 0; }),
                   components.end());
  if (m_has_springs) foreseeSprings();
}

// A spring that pulls by where the step starts neither gives nor takes (symplectic Euler, Hairer, Lubich and Wanner 2003), while (w dt)^2
// of all that its bodies do is below 4. That is no more than s_a + s_b, s the sum of dt^2 k J M^-1 J^T over the springs of a body, with
// joints that hold and without. A faster one pulls by so much of the way of the step that its bodies swing as if they were slow enough.
void IslandBuilder::foreseeSprings() {
  std::vector<double>& of_body = m_springs;
  of_body.assign(m_island.bodies.size(), 0.);
  const auto forEachSpring = [&](const auto& visit) {
    for (IslandJoint& joint : m_island.joints)
      for (int i = 0; i < joint.rows; ++i) {
        IslandRow& row = m_island.rows[size_t(joint.first_row + i)];
        if (const double k = springs(row.law); k > 0) visit(joint, row, k);
      }
  };
  forEachSpring([&](const IslandJoint& joint, const IslandRow& row, double k) {
    for (int side = 0; side < 2; ++side)
      if (const int body = joint.body[size_t(side)]; body >= 0)
        of_body[size_t(body)] += k * m_island.bodies[size_t(body)].inverseMass(row.J, row.J, side);
  });
  forEachSpring([&](IslandJoint& joint, IslandRow& row, double) {
    double swing = 0;
    for (const int body : joint.body)
      if (body >= 0) swing += of_body[size_t(body)];
    const bool was_equality = row.law.isEquality();
    row.law.foresee(std::fmax(0, 1 - m_options.stable_swing / swing));
    if (was_equality && !row.law.isEquality()) ++joint.bounded;  // its impulse is known
  });
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
