#include "output.h"

#include <cmath>

#include "../engines/engine.h"

namespace tables {
namespace {

// What is infinite is told from what is not known.
void write_json_value(std::ostream& out, double value) {
  if (std::isinf(value))
    out << "\"inf\"";
  else
    write_json_number(out, value);
}

}  // namespace

bool NumberFiles::open_csv(const std::string& path) {
  csv_.open(path);
  csv_.precision(digits);
  csv_ << "precision,scene,case,who,quantity,unit,value\n";
  return bool(csv_);
}

// Names hold nothing that either form would have to escape.
void NumberFiles::write(const Number& number) {
  const auto& [scene, name, who, quantity, unit, value] = number;
  if (csv_.is_open())
    csv_ << engines::precision() << ',' << scene << ',' << name << ',' << who << ',' << quantity
         << ',' << unit << ',' << value << '\n';
  if (!json_.is_open()) return;
  std::ostream& out = json_.next();
  out << R"({"precision": ")" << engines::precision() << R"(", "scene": ")" << scene
      << R"(", "case": ")" << name << R"(", "who": ")" << who << R"(", "quantity": ")" << quantity
      << R"(", "unit": ")" << unit << R"(", "value": )";
  write_json_value(out, value);
  out << '}';
}

bool NumberFiles::close() {
  if (csv_.is_open()) csv_.close();
  const bool is_written = json_.close();
  return bool(csv_) && is_written;
}

}  // namespace tables
