// Purpose: the pages of documentation, as text.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pages {

inline std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) found.push_back(line);
  return found;
}

/// The README, the changelog and plugin/docs.
inline std::vector<std::filesystem::path> all(const std::filesystem::path& source) {
  std::vector<std::filesystem::path> found{source / "README.md", source / "CHANGELOG.md"};
  for (const auto& entry : std::filesystem::directory_iterator(source / "plugin/docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin() + 2, found.end());
  return found;
}

/// A line between ``` and ```, or one of these: `language` is that of the block, "" outside.
class Fence {
 public:
  /// Whether the line is code, or opens or closes a block of it.
  bool takes(const std::string& line) {
    if (line.rfind("```", 0) != 0) return m_open;
    m_open = !m_open;
    m_language = m_open ? line.substr(3) : "";
    return true;
  }
  bool open() const { return m_open; }
  const std::string& language() const { return m_language; }

 private:
  bool m_open = false;
  std::string m_language;
};

}  // namespace pages
