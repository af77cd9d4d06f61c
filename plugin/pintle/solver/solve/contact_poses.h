// Purpose: what contacts do to the poses of jointed bodies, beside the velocities with which the step ends.
// Bodies that are in each other are led out by pseudo velocities w of their own, which are zero after the step (split impulses):
//   A w = J^T p + R^T lambda,   R w = 0 of joints,   J w >= target,   p >= 0,   p (J w - target) = 0 of contacts
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/solve/projection.h>
#include <pintle/solver/system/contact_response.h>

#include <functional>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Memory of both.
struct ContactPosesMemory {
  std::vector<ContactRow> rows;
  std::vector<Vector6d> push;  ///< of each body
  std::vector<double> most;    ///< of each body, m/s
  size_t bytes() const { return bytesOf(rows, push, most); }
};

/// Adds what joints do to velocities of all bodies, so that they hold.
using HoldJoints = std::function<void(std::vector<Vector6d>& velocities)>;

/// Split impulses: `push` of each body moves it out of those that it is in, as far as Bullet's solver asks for. A contact sees what
/// joints do to it (`response`, of the solve), so that what lies on jointed bodies is pushed off them, and not they from
/// under it. `turn_share`: of the turns that lead out (btContactSolverInfo::m_splitImpulseTurnErp).
/// Returns whether any is pushed.
bool pushApart(Island& island, const std::vector<ContactRow>& contacts,
               const std::vector<Vector6d>& velocities, int passes, double turn_share,
               ContactResponse& response, const HoldJoints& holdJoints, ContactPosesMemory& memory);

/// Where bodies of a component swing or whirl faster than a step resolves, rows of the start hold its velocities in hardly any of the ways
/// that it may go, and poses have to take back the rest. Then velocities follow the poses, of its `bodies` and all that contacts join with
/// them: by that part of their changes that takes most energy. It never gives any.
void followPoses(const Island& island, Span<const int> bodies, std::vector<Vector6d>& velocities,
                 std::vector<PoseChange>& changes);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
