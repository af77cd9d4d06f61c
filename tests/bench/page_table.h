// Purpose: a table of a page of documentation, in Markdown, of numbers that a benchmark measures.
#pragma once

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

class PageTable {
 public:
  /// `name` is that of the file, and of the marks in the page.
  PageTable(std::string name, const std::vector<std::string>& head) : m_name(std::move(name)) {
    add(head);
    add(std::vector<std::string>(head.size(), "---"));
  }

  void add(const std::vector<std::string>& cells) {
    m_text += '|';
    for (const std::string& text : cells) m_text += ' ' + text + " |";
    m_text += '\n';
    ++m_lines;
  }

  /// Writes FOLDER/NAME.md; nothing, if the table has no rows. False: it cannot be written.
  bool write(const std::string& folder) const {
    if (m_lines <= 2) return true;
    std::ofstream file(folder + "/" + m_name + ".md");
    file << m_text;
    return bool(file.flush());
  }

 private:
  std::string m_name, m_text;
  int m_lines = 0;
};

}  // namespace bench
