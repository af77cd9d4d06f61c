// Purpose: memory that all solvers of a world share. They know the world by its dispatcher.
#pragma once

#include <iterator>
#include <memory>
#include <mutex>
#include <unordered_map>

class btDispatcher;

namespace pintle {

/// The memory of all solvers that are given this dispatcher. `own`: it becomes this one if there is none.
template <class Memory>
std::shared_ptr<Memory> memoryOf(const btDispatcher& world, const std::shared_ptr<Memory>& own) {
  static std::mutex mutex;
  static std::unordered_map<const btDispatcher*, std::weak_ptr<Memory>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  for (auto i = all.begin(); i != all.end();) i = i->second.expired() ? all.erase(i) : std::next(i);
  std::weak_ptr<Memory>& known = all[&world];
  if (known.expired()) known = own;
  return known.lock();
}

}  // namespace pintle
