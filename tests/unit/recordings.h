// What tests read of a recording.
#pragma once

#include <string>
#include <vector>

#include "json.h"

namespace recordings {

inline const json::Value* series(const json::Value& run, const std::string& key) {
  for (const json::Value& one : run["series"].items) {
    if (one["key"].text == key) return &one;
  }
  return nullptr;
}
inline std::vector<float> values(const json::Value& run, const std::string& key) {
  const json::Value* const found = series(run, key);
  return found != nullptr ? (*found)["values"].floats() : std::vector<float>();
}

}  // namespace recordings
