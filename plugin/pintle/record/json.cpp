#include <pintle/record/json.h>

#include <LinearMath/btQuaternion.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {
namespace {

btQuaternion quaternion(const btTransform& pose) {
  btQuaternion q;
  pose.getBasis().getRotation(q);
  return q;
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == '<') {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", unsigned(static_cast<unsigned char>(c)));
      json += code;
    } else {
      json += c;
    }
  }
  return json + '"';
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  for (char* c = text; *c != 0; ++c) {
    if (*c == ',') *c = '.';  // of a locale
  }
  return text;
}

std::string base64(const std::vector<float>& values) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  bytes.reserve(4 * values.size());
  for (const float value : values) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back((bits >> shift) & 0xff);
  }
  std::string text = "\"";
  text.reserve(bytes.size() * 4 / 3 + 6);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const unsigned group = unsigned(bytes[i]) << 16 | (left > 1 ? unsigned(bytes[i + 1]) << 8 : 0) |
                           (left > 2 ? unsigned(bytes[i + 2]) : 0);
    text += digits[group >> 18];
    text += digits[group >> 12 & 63];
    text += left > 1 ? digits[group >> 6 & 63] : '=';
    text += left > 2 ? digits[group & 63] : '=';
  }
  return text + '"';
}

Json& Json::vector(const std::string& name, const btVector3& v) {
  return raw(name, Json('[').item(double(v.x())).item(double(v.y())).item(double(v.z())).str());
}

Json& Json::transform(const std::string& name, const btTransform& t) {
  const btQuaternion q = quaternion(t);
  const btVector3& p = t.getOrigin();
  Json array('[');
  for (const btScalar value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
    array.item(double(value));
  return raw(name, array.str());
}

void appendPose(const btTransform& pose, std::vector<float>& to) {
  const btQuaternion q = quaternion(pose);
  const btVector3& p = pose.getOrigin();
  for (const btScalar value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
    to.push_back(float(value));
}

bool isFinite(const btTransform& pose) {
  const btMatrix3x3& m = pose.getBasis();
  const btVector3 sum = pose.getOrigin() + m[0] + m[1] + m[2];
  return std::isfinite(sum.x()) && std::isfinite(sum.y()) && std::isfinite(sum.z());
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
