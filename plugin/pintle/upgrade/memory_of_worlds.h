// Purpose: what solvers keep of their worlds, which they know by their dispatchers. All solvers of a world share it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

class btDispatcher;

namespace pintle {

/// The memory of the worlds of one solver. Nobody tells that a world has died: the last ones are kept.
template <class Memory>
class MemoryOfWorlds {
 public:
  /// The islands that follow are of this world.
  void enter(const btDispatcher& world) {
    if (!m_recent.empty() && m_recent.front().first == &world) return;
    const auto known = std::find_if(m_recent.begin(), m_recent.end(),
                                    [&](const auto& of) { return of.first == &world; });
    if (known != m_recent.end()) {
      std::rotate(m_recent.begin(), known, known + 1);
    } else {
      const auto own = m_recent.empty() ? m_now : std::make_shared<Memory>();
      m_recent.insert(m_recent.begin(), {&world, shared(world, own)});
      m_recent.resize(std::min(m_recent.size(), max_worlds));
    }
    m_now = m_recent.front().second;
  }
  /// As long as neither has a world, both have the same memory.
  void share(const MemoryOfWorlds& other) { m_now = other.m_now; }
  ///@{
  /// That of the world that was entered last; before, what is going to be that of the first one.
  Memory& operator*() const { return *m_now; }
  Memory* operator->() const { return m_now.get(); }
  ///@}

 private:
  static constexpr std::size_t max_worlds = 8;  ///< that take turns in one solver

  /// The memory that a solver of the world has already; else `own`.
  static std::shared_ptr<Memory> shared(const btDispatcher& world,
                                        const std::shared_ptr<Memory>& own) {
    static std::mutex mutex;
    static std::unordered_map<const btDispatcher*, std::weak_ptr<Memory>> all;
    const std::lock_guard<std::mutex> lock(mutex);
    for (auto i = all.begin(); i != all.end();)
      i = i->second.expired() ? all.erase(i) : std::next(i);
    std::weak_ptr<Memory>& known = all[&world];
    if (known.expired()) known = own;
    return known.lock();
  }

  std::shared_ptr<Memory> m_now = std::make_shared<Memory>();
  std::vector<std::pair<const btDispatcher*, std::shared_ptr<Memory>>> m_recent;
};

}  // namespace pintle
