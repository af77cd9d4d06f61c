// Purpose: a table of a page of documentation, in Markdown, of numbers that a benchmark measures.
#pragma once

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace bench {

/// Two digits and the unit.
inline std::string cell(double value, const char* unit = "") {
  char text[48];
  std::snprintf(text, sizeof(text), value >= 100 ? "%.0f%s" : "%.2g%s", value, unit);
  return text;
}

/// Of two times.
inline std::string ratio(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), value < 10 ? "%.2f" : "%.0f", value);
  return text;
}

class PageTable {
 public:
  /// `name` is that of the file, and of the marks in the page.
  PageTable(std::string name, const std::vector<std::string>& head)
      : m_name(std::move(name)), m_text(line(head) + '|') {
    for (std::size_t i = 0; i < head.size(); ++i) m_text += "---|";
    m_text += '\n';
  }

  void add(const std::vector<std::string>& cells) {
    m_text += line(cells);
    m_is_empty = false;
  }

  /// Writes FOLDER/NAME.md; nothing, if the table has no rows. False: it cannot be written.
  bool write(const std::string& folder) const {
    if (m_is_empty) return true;
    std::ofstream file(folder + "/" + m_name + ".md");
    file << m_text;
    return bool(file.flush());
  }

 private:
  static std::string line(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& one : cells) text += ' ' + one + " |";
    return text + '\n';
  }

  std::string m_name, m_text;
  bool m_is_empty = true;
};

}  // namespace bench
