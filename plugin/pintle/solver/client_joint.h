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

/// Whether this one's rows in this step are others than those of its base. It is asked for them once, as by Bullet.
bool hasOtherRows(Joint& joint, const btContactSolverInfo& info);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
