#include <pintle/upgrade/upgraded_joints.h>

#include <pintle/joints/joint.h>

#include <iterator>

namespace pintle {
inline namespace PINTLE_PRECISION {

void UpgradedJoints::beginStep() {
  const std::lock_guard<std::mutex> lock(m_mutex);
  beginStep(1);
}

void UpgradedJoints::beginStep(long kept_for) {
  ++m_step;
  for (auto i = m_all.begin(); i != m_all.end();)
    i = m_step - i->second.step > kept_for ? m_all.erase(i) : std::next(i);
}

void UpgradedJoints::find(btTypedConstraint* const* constraints, int count,
                          std::vector<UpgradedJoint*>& to) {
  to.assign(std::size_t(count), nullptr);
  const std::lock_guard<std::mutex> lock(m_mutex);
  for (int i = 0; i < count; ++i)
    if (const StockClass* const of = stockClassOf(*constraints[i], m_solver))
      to[std::size_t(i)] = &joint(*of, *constraints[i]);
}

// A constraint that comes before any that has come before still counts as of the last step: hence 2.
UpgradedJoint& UpgradedJoints::joint(const StockClass& of, btTypedConstraint& stock) {
  Entry& entry = m_all[&stock];
  const bool comes_again = entry.step == m_step, was_in_last_step = m_step - entry.step <= 1;
  if (entry.joint == nullptr || !was_in_last_step || !entry.joint->standsFor(of, stock))
    entry.joint = UpgradedJoint::make(of, stock);
  entry.step = comes_again ? m_step + 1 : m_step;
  if (comes_again) beginStep(2);
  return *entry.joint;
}

std::string UpgradedJoints::whyIgnored(const btTypedConstraint& constraint) {
  auto& stock = const_cast<btTypedConstraint&>(constraint);
  const StockClass* const of = stockClassOf(constraint, m_solver);
  if (of == nullptr) {
    auto* const ours = dynamic_cast<Joint*>(&stock);
    return ours != nullptr ? ours->whyIgnored() : std::string();
  }
  const std::lock_guard<std::mutex> lock(m_mutex);
  const auto known = m_all.find(&constraint);
  if (known != m_all.end() && known->second.joint->standsFor(*of, stock))
    return known->second.joint->joint().whyIgnored();
  return UpgradedJoint::make(*of, stock)->joint().whyIgnored();
}

std::size_t UpgradedJoints::size() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_all.size();
}

std::size_t UpgradedJoints::bytes() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  std::size_t sum = 0;
  for (const auto& known : m_all) sum += sizeof(known) + known.second.joint->bytes();
  return sum;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
