// Purpose: the equations of the rows that act, of a set of them (active_set.h): what each step of an active-set method solves (Nocedal
// and Wright 2006, chapter 16),
//   J v + softness Lambda = target,   v = v* + A^-1 J^T Lambda,
// in the units of K (joint_matrix.h): K y = aim - J v*.
#pragma once

#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/solver_options.h>
#include <pintle/solver/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// To K which rows act, and how softly.
void setActing(const Island& island, const Component& component, Workspace& work, JointMatrix& K);

/// work.aim: at which velocities of the component's bodies rows are, in the units of K.
void aimRows(const Island& island, const Component& component, const JointMatrix& K,
             Workspace& work);

/// K of the rows that act. Returns false if it has no factor.
inline bool factoriseRows(const Island& island, const Component& component,
                          const SolverOptions& options, Workspace& work, JointMatrix& K) {
  setActing(island, component, work, K);
  return K.factorise(options.least_pivot);
}

/// work.x = what work.u is off of rows that act, in the units of K. Returns the most, m or rad.
double findResidual(double dt, Workspace& work);

/// The same of rows of the start, where bodies move with `v` (those of the component): of the rows of the last factor.
double findResidual(double dt, const JointMatrix& K, const Vector6d* v, Workspace& work);

/// work.lambda from work.y, which is in the units of K.
void unscaleImpulses(Workspace& work);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
