// A reader of JSON, as small as the tests of recordings need it.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace json {

struct Value {
  enum class Kind { null, number, text, array, object } kind = Kind::null;
  double number = std::numeric_limits<double>::quiet_NaN();
  std::string text;
  std::vector<Value> items;
  std::map<std::string, Value> members;

  const Value& operator[](const char* name) const { return members.at(name); }
  const Value& operator[](int i) const { return items.at(std::size_t(i)); }
  int size() const { return int(items.size()); }

  // Of base64, little-endian Float32.
  std::vector<float> floats() const {
    std::vector<float> values;
    std::vector<unsigned char> bytes;
    unsigned group = 0;
    int digits = 0;
    static const std::string alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (const char c : text) {
      if (c == '=') break;
      group = group << 6 | unsigned(alphabet.find(c));
      digits += 6;
      if (digits < 8) continue;
      digits -= 8;
      bytes.push_back(static_cast<unsigned char>(group >> digits & 0xff));
    }
    for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
      std::uint32_t bits = 0;
      for (int k = 3; k >= 0; --k) bits = bits << 8 | bytes[i + std::size_t(k)];
      float value;
      std::memcpy(&value, &bits, sizeof value);
      values.push_back(value);
    }
    return values;
  }
};

class Reader {
 public:
  explicit Reader(const std::string& text) : m_at(text.c_str()) {}

  Value read() {
    Value value;
    if (*m_at == '{') {
      value.kind = Value::Kind::object;
      for (++m_at; *m_at != '}'; skip(',')) {
        const std::string name = string();
        expect(':');
        value.members[name] = read();
      }
      ++m_at;
    } else if (*m_at == '[') {
      value.kind = Value::Kind::array;
      for (++m_at; *m_at != ']'; skip(',')) value.items.push_back(read());
      ++m_at;
    } else if (*m_at == '"') {
      value.kind = Value::Kind::text;
      value.text = string();
    } else if (std::strncmp(m_at, "null", 4) == 0) {
      m_at += 4;
    } else {
      value.kind = Value::Kind::number;
      char* end;
      value.number = std::strtod(m_at, &end);
      if (end == m_at) throw std::runtime_error(std::string("no JSON: ") + m_at);
      m_at = end;
    }
    return value;
  }

 private:
  void skip(char c) {
    if (*m_at == c) ++m_at;
  }
  void expect(char c) {
    if (*m_at++ != c) throw std::runtime_error(std::string("no JSON: wanted ") + c);
  }
  std::string string() {
    std::string text;
    for (expect('"'); *m_at != '"'; ++m_at) {
      if (*m_at == '\\' && *++m_at == 'u') {
        text += char(std::strtol(std::string(m_at + 1, 4).c_str(), nullptr, 16));
        m_at += 4;
      } else {
        text += *m_at;
      }
    }
    ++m_at;
    return text;
  }

  const char* m_at;
};

inline Value read(const std::string& text) { return Reader(text).read(); }

}  // namespace json
