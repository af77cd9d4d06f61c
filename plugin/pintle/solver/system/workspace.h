// Purpose: what the solve of a component of joints works with, and what it leaves.
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/island.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct SolveReport {
  bool converged = false;
  bool is_solvable = true;  ///< which rows act was found, and they have a factor
  int steps = 0;
  double error = 0;  ///< the largest, m or rad
};

struct Workspace {
  std::vector<Vector6d> v;  ///< of each body: where the solve begins, and with which the step ends
  std::vector<Vector6d> way;      ///< chord velocity of each body: it leads to where the step ends
  std::vector<double> u, lambda;  ///< of each row: its velocity, and its impulse, N s or N m s
  std::vector<double> at_end;  ///< impulse of each row along the rows of the end (end_velocities.h)
  std::vector<double> last_at_end;  ///< the same of the last step
  std::vector<double> load;      ///< of each row: its mean impulse in this step and those before it
  std::vector<LawPiece> pieces;  ///< of each row: the piece of its law on which it is
  /// Of each row: the impulses of the parts of its law, where they are found part by part. Else empty.
  std::vector<AxisLaw::Parts> parts;
  std::vector<double> softness;     ///< of each row that acts, relative to K
  bool is_resolved = true;          ///< steps resolve the swing of all bodies
  std::vector<Matrix3d> stiffness;  ///< else, of each: added to its inertia (load_stiffness.h)
  bool is_missed = false;           ///< impulses do not lead to what is foreseen (chord.h)
  std::vector<double> of_loop;      ///< of each joint: the softness of its rows (softness.h)
  bool has_loops = false;           ///< some joints may be in loops (softness.h)

  /// The impulses of the parts of the law of row r.
  AxisLaw::Parts split(const AxisLaw& law, size_t r) const {
    if (!parts.empty() && !law.isEquality()) return parts[r];
    return law.split(pieces[r].velocityAt(u[r], lambda[r]), lambda[r]);
  }

  /// Of a soft row: what its spring has of its impulse.
  double impulseOfSpring(const IslandRow& row, size_t r) const {
    return row.law.parts() == 1 ? lambda[r] : split(row.law, r)[size_t(row.extras->spring.part)];
  }

  // Memory of the solves.
  std::vector<double> y, x,
      aim;  ///< impulses, a residual, and targets, in the units of K (joint_matrix.h)
  /// Of each row: what scales it in the units of K, and where it is among the unknowns of K.
  struct Scale {
    double root_K, by_root_K;
    size_t at;
  };
  std::vector<Scale> scales;
  std::vector<MovedBody> moved;
  struct Place {
    const IslandRow* row;
    int joint;
    size_t r, at;  ///< among the rows of the component, and among the unknowns of K
  };
  std::vector<Place> bounded, limits, pressing, held, all;  ///< rows
  /// Rows that go on as contacts do, and where these are.
  struct AsContact {
    Place of;
    size_t first;
  };
  std::vector<AsContact> as_contacts;
  std::vector<Vector6d> change;  ///< of each body: of its velocity
  std::vector<double> last_load;
  std::vector<double> most_stiffness;  ///< of each body: a bound, kg m^2; 0: it needs none
  std::vector<Matrix3d> last_stiffness;

  /// For any solve of a component of this size: hardly a step allocates because it is the first one that takes another way. (The
  /// first contact does.)
  void reserve(size_t bodies, size_t joints, size_t rows, size_t unknowns) {
    pintle::reserve(bodies, v, way, stiffness, moved, change, last_stiffness, most_stiffness);
    pintle::reserve(joints, of_loop);
    pintle::reserve(rows, u, lambda, at_end, last_at_end, load, pieces, softness, scales, bounded,
                    limits, pressing, held, parts, as_contacts, last_load);
    pintle::reserve(unknowns, y, x, aim);
  }

  size_t bytes() const {
    return bytesOf(v, way, u, lambda, at_end, last_at_end, load, pieces, parts, softness, stiffness,
                   of_loop, y, x, aim, scales, moved, bounded, limits, pressing, held, as_contacts,
                   all, change, last_load, last_stiffness, most_stiffness);
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
