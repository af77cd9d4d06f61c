// Purpose: shapes of collision objects as the page draws them.
#pragma once

#include <pintle/precision.h>

#include <string>

class btCollisionShape;

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

/// As JSON: {"kind": "box", "half": [x, y, z]} and so on, in m, in the frame of the object. Margins that are part of
/// what collides are part of it.
std::string describeShape(const btCollisionShape& shape);

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
