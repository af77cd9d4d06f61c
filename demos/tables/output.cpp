#include "output.h"

#include <cmath>

#include "../engines/engine.h"

namespace tables {
namespace {

// JSON has no infinity and no NaN.
void write_json_value(std::ostream& out, double value) {
  if (std::isnan(value)) {
    out << "null";
  } else if (std::isinf(value)) {
    out << "\"inf\"";
  } else {
    out << value;
  }
}

}  // namespace

bool NumberFile::open(const std::string& path, Form form) {
  form_ = form;
  file_.open(path);
  file_.precision(9);
  file_ << (form == Form::csv ? "precision,scene,case,who,quantity,unit,value\n" : "[");
  return bool(file_);
}

// Names hold nothing that either form would have to escape.
void NumberFile::write(const Number& number) {
  if (!file_.is_open()) return;
  const auto& [scene, name, who, quantity, unit, value] = number;
  if (form_ == Form::csv) {
    file_ << engines::precision() << ',' << scene << ',' << name << ',' << who << ',' << quantity
          << ',' << unit << ',' << value << '\n';
    return;
  }
  file_ << (is_first_ ? "\n" : ",\n") << R"({"precision": ")" << engines::precision()
        << R"(", "scene": ")" << scene << R"(", "case": ")" << name << R"(", "who": ")" << who
        << R"(", "quantity": ")" << quantity << R"(", "unit": ")" << unit << R"(", "value": )";
  write_json_value(file_, value);
  file_ << '}';
  is_first_ = false;
}

bool NumberFile::close() {
  if (!file_.is_open()) return true;
  if (form_ == Form::json) file_ << "\n]\n";
  file_.close();
  return bool(file_);
}

}  // namespace tables
