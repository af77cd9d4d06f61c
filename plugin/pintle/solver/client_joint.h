// Purpose: joints of clients, derived from Pintle's, that answer what Bullet asks a joint for otherwise than their bases do.
#pragma once

#include <pintle/joints/joint.h>

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Rows of a joint that answers as Bullet's do: btGeneric6DofSpring2Constraint has the most, four an axis.
constexpr int most_stock_rows = 24;

/// Whether the joint is of a type of Pintle's own, which asks for nothing but its rows.
bool isOfPintle(const Joint& joint);

/// Rows of a joint in this step, as its virtual methods give them.
struct ClientRows {
  int of_base;        ///< so many come first that are those of its base, unchanged
  bool adds_rows;     ///< others come after them
  bool changes_base;  ///< of the base's rows some are others, or missing
};

/// Asks the joint once, as Bullet does. Leaves what it remembers of its axes as it was.
ClientRows findClientRows(Joint& joint, const btContactSolverInfo& info);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
