// Purpose: the stops among the parts of a law. A rigid one is a unilateral constraint, which its impulse meets by Signorini's law:
//   u >= target,   Lambda >= 0,   Lambda (u - target) = 0
// of a lower one; of an upper one with the other signs. A target that points back into the range is a rebound (Newton's law of impact).
#pragma once

#include <pintle/solver/model/island.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Whether the law has rigid stops, and nothing else. (That of a broken joint has nothing at all.)
inline bool isLimit(const AxisLaw& law) {
  for (int i = 0; i < law.parts(); ++i)
    if (!law.part(i).isRigidStop()) return false;
  return true;
}

inline bool hasRigidStops(const AxisLaw& law) {
  if (law.isEquality()) return false;
  for (int i = 0; i < law.parts(); ++i)
    if (law.part(i).isRigidStop()) return true;
  return false;
}

/// Whether u is beyond a stop, be it rigid or not.
inline bool isBeyondStop(const AxisLaw& law, double u) {
  for (int i = 0; i < law.parts(); ++i)
    if (law.part(i).isBeyond(u)) return true;
  return false;
}

/// The target of the rigid stop that u is beyond; null: of none.
inline const double* passedRigidStop(const AxisLaw& law, double u) {
  if (law.isEquality()) return nullptr;
  for (int i = 0; i < law.parts(); ++i)
    if (const LawPart& part = law.part(i); part.isRigidStop() && part.isBeyond(u))
      return &part.target;
  return nullptr;
}

/// Whether a row may be moved out of a stop.
inline bool hasStops(const IslandRow& row) { return row.hasSoftStop() || hasRigidStops(row.law); }

/// The target, but for what its spring pulls, of the stop that a row is beyond at velocity u; null: of none.
inline const double* passedStop(const IslandRow& row, double u) {
  static constexpr double at_start = 0;
  if (row.hasSoftStop()) return u * row.open > 0 ? &at_start : nullptr;
  return row.has_position || row.open != 0 ? passedRigidStop(row.law, u) : nullptr;
}

/// Whether a stop sends its row back with velocity u.
inline bool rebounds(const AxisLaw& law, double u) {
  for (int i = 0; i < law.parts(); ++i)
    if (law.part(i).rebounds() && law.part(i).target == u) return true;
  return false;
}

/// The stop of a limit that an impulse presses on; null: on none.
inline const LawPart* pressedStop(const AxisLaw& law, double impulse) {
  for (int i = 0; i < law.parts(); ++i)
    if (const LawPart& part = law.part(i);
        impulse != 0 && part.lower <= impulse && impulse <= part.upper)
      return &part;
  return nullptr;
}

/// Stops give back nothing of the speed with which they are met. Returns whether they did.
inline bool stopRebounds(AxisLaw& law) {
  bool any = false;
  for (int i = 0; i < law.parts(); ++i) {
    if (!law.part(i).rebounds()) continue;
    law.setTarget(i, 0);
    any = true;
  }
  return any;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
