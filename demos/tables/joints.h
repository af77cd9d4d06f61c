// The hinges that most tables compare.

#pragma once

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <pintle/joints/quaternion_hinge.h>

namespace tables {

using Stock = btHingeConstraint;
using StockCounting = btHingeAccumulatedAngleConstraint;
using Ours = pintle::QuaternionHinge;

// Two variants of ours, to see what the defaults are worth.
const auto plain_rows = [](Ours& hinge) { hinge.setBlockRows(false); };
const auto document = [](Ours& hinge) { hinge.setFormulation(pintle::Formulation::document); };

}  // namespace tables
