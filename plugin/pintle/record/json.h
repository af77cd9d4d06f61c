// Purpose: the little of JSON that a recording is written in.
#pragma once

#include <pintle/precision.h>

#include <LinearMath/btTransform.h>

#include <string>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

/// Quoted. A "<" is escaped, so that no text ends the page's script element.
std::string quoted(const std::string& text);
/// null if it is not finite.
std::string number(double value);
/// Of little-endian Float32, quoted.
std::string base64(const std::vector<float>& values);

/// Builds an object or an array, its members in their order.
class Json {
 public:
  explicit Json(char open) : m_text(1, open), m_close(open == '{' ? '}' : ']') {}

  Json& raw(const std::string& name, const std::string& json) {
    separate();
    m_text += quoted(name) + ':' + json;
    return *this;
  }
  Json& text(const std::string& name, const std::string& value) { return raw(name, quoted(value)); }
  Json& number(const std::string& name, double value) { return raw(name, record::number(value)); }
  Json& vector(const std::string& name, const btVector3& v);
  Json& transform(const std::string& name, const btTransform& t);
  /// Of an array.
  Json& item(const std::string& json) {
    separate();
    m_text += json;
    return *this;
  }
  Json& item(double value) { return item(record::number(value)); }

  std::string str() const { return m_text + m_close; }

 private:
  void separate() {
    if (m_text.size() > 1) m_text += ',';
  }

  std::string m_text;
  char m_close;
};

/// Position, then quaternion (x, y, z, w): 7 numbers.
void appendPose(const btTransform& pose, std::vector<float>& to);
bool isFinite(const btTransform& pose);

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
