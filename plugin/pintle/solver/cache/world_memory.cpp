#include <pintle/solver/cache/world_memory.h>

#include <iterator>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Lock = std::lock_guard<std::mutex>;

void WorldMemory::beginStep(long kept_for) {
  ++m_step;
  m_report = {};
  const auto forgetOld = [&](auto& all) {
    for (auto i = all.begin(); i != all.end();)
      i = m_step - i->second.step > kept_for ? all.erase(i) : std::next(i);
  };
  forgetOld(m_slots);
  forgetOld(m_motions);
}

MotionsOfBody& WorldMemory::motionsOf(const btRigidBody& body) {
  const Lock lock(m_mutex);
  MotionsOfBody& motions = m_motions[&body];
  if (motions.step == m_step) return motions;
  const MotionOfBody last = m_step - motions.step == 1 ? motions.now : MotionOfBody();
  motions = {};
  motions.last = last;
  motions.step = m_step;
  return motions;
}

void WorldMemory::beginStep() {
  m_upgraded.beginStep();
  const Lock lock(m_mutex);
  beginStep(1);
}

// Components that come for the first time, before any that has come before, still count as of the last step: hence 2.
std::unique_ptr<ComponentMemory>& WorldMemory::slot(const btTypedConstraint* first_joint) {
  const Lock lock(m_mutex);
  Slot& slot = m_slots[first_joint];
  const bool comes_again = slot.step == m_step;
  slot.step = comes_again ? m_step + 1 : m_step;
  if (comes_again) beginStep(2);
  return slot.memory;
}

void WorldMemory::add(const StepReport& island) {
  const Lock lock(m_mutex);
  m_report += island;
}

StepReport WorldMemory::report() const {
  const Lock lock(m_mutex);
  return m_report;
}

int WorldMemory::size() const {
  const Lock lock(m_mutex);
  return int(m_slots.size());
}

size_t WorldMemory::bytes() const {
  const Lock lock(m_mutex);
  size_t sum = 0;
  for (const auto& [joint, slot] : m_slots)
    sum += sizeof(slot) + (slot.memory != nullptr ? slot.memory->bytes() : 0);
  sum += m_upgraded.bytes();
  sum += m_motions.size() * sizeof(decltype(m_motions)::value_type);
  return sum;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
