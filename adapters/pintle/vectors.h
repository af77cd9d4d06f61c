// Purpose: the document's symbols in Bullet's precision. No public header includes it: Eigen is the library's own.
#pragma once

#include <pintle/notation.h>
#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

using Vec3 = Vector3<Scalar>;
using Mat3 = Matrix3<Scalar>;

/// A vector and a spare lane, so that it fills a SIMD register.
using Lanes = Eigen::Array<Scalar, 4, 1>;
using LanesView = Eigen::Map<const Lanes, Eigen::Unaligned>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
