// Purpose: what a solver's side knows of a step when it asks a joint for its rows: how the bodies move. A joint does not
// see it: Rows (row.h) applies it to what the joint adds.
#pragma once

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct StepMotion {
  const BodyPair& pair;
  Scalar dt;           ///< s
  Scalar turn;         ///< rad: the faster body turns by no more in the step
  Scalar curved_part;  ///< of the curvature of the motion, 0 to 1: what bodies that turn far in a step have of it
  /// All joints are solved at once: each keeps the angular momentum of its bodies, whatever holds these.
  bool solved_at_once;

  /// The part of a gap that is in the lever of body a (3.1.3, conditioned). With all of it two bodies that move freely are
  /// held at one point, and angular momentum is conserved at any gap. But Bullet turns no body by more than pi/4 in a step,
  /// whatever its velocity: such ones come apart in every step, and would swing about each other for seconds. Held at two
  /// points they are braked: by degrees, beyond a tenth of a radian. Against a body that cannot move nothing is to be
  /// conserved: there the lever takes what its own turn puts the pivot off by, as a pendulum's does, but not the gap of a
  /// pull, which would turn the body.
  Scalar gapInLever(const Vec3& lever, const Vec3& gap) const {
    if (!isFree(pair.a())) return 0;
    constexpr Scalar from = Scalar(0.1), to = SIMD_PI / 4;
    const Scalar part = turn <= from ? Scalar(1) : (to - turn) / (to - from);
    if (!(part > 0)) return 0;
    if (isFree(pair.b()) || solved_at_once) return part;
    if (pair.inv_mass_b() > 0) return 0;
    // What a turn of the lever is off the straight way.
    const Scalar off2 = turn * turn * turn * turn / 4 * lever.dot(lever), gap2 = gap.dot(gap);
    if (gap2 < off2) return part;
    return off2 > 0 ? part * (off2 / gap2) : Scalar(0);
  }

 private:
  // Whether it moves along every axis.
  static bool isFree(const btRigidBody& body) {
    const btVector3& f = body.getLinearFactor();
    return body.getInvMass() > 0 && f.x() == 1 && f.y() == 1 && f.z() == 1;
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
