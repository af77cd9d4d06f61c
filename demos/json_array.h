// A file that holds one array of JSON, element by element.

#pragma once

#include <cmath>
#include <fstream>
#include <string>

// JSON has no infinity and no NaN: what is not finite is null.
inline void write_json_number(std::ostream& out, double value) {
  if (std::isfinite(value))
    out << value;
  else
    out << "null";
}

class JsonArray {
 public:
  // False: the file cannot be written.
  bool open(const std::string& path, int digits) {
    file_.open(path);
    file_.precision(digits);
    file_ << '[';
    return bool(file_);
  }
  bool is_open() const { return file_.is_open(); }
  // Where the next element is to be written, on a line of its own.
  std::ostream& next() {
    file_ << (is_first_ ? "\n" : ",\n");
    is_first_ = false;
    return file_;
  }
  // False: something was not written.
  bool close() {
    if (!is_open()) return true;
    file_ << "\n]\n";
    file_.close();
    return bool(file_);
  }

 private:
  std::ofstream file_;
  bool is_first_ = true;
};
