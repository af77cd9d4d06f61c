#include <pintle/solver/system/load_stiffness.h>

#include <pintle/solver/constants.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Of a symmetric matrix: without its negative eigenvalues.
Matrix3d clipped(const Matrix3d& m) {
  if (Eigen::LLT<Matrix3d>(-m).info() == Eigen::Success) return Matrix3d::Zero();
  Eigen::SelfAdjointEigenSolver<Matrix3d> axes;
  axes.computeDirect(m);
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() *
         axes.eigenvectors().transpose();
}

// No eigenvalue of the stiffness of a force f on a lever r is above |f| |r|. Returns whether any body may swing fast.
bool mayBeFast(const Island& island, const Component& component, double stable_swing,
               Workspace& work) {
  std::vector<double>& most = work.most_stiffness;
  setZero(size_t(component.bodies), most);
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    double load = 0;
    for (int i = 0; i < joint.rows; ++i)
      if (joint.isOnLever(i)) load += std::abs(work.load[size_t(joint.row_of_component + i)]);
    for (size_t side = 0; side < 2; ++side)
      if (const int body = joint.body[side]; body >= 0)
        most[size_t(body - component.first_body)] += load * joint.lever[side];
  }
  bool any = false;
  for (int i = 0; i < component.bodies; ++i) {
    double& of = most[size_t(i)];
    of *= island.dt / stable_swing;
    if (of <= island.bodies[size_t(component.first_body + i)].least_inertia) of = 0;
    any = any || of > 0;
  }
  return any;
}

}  // namespace

void addLoad(const std::vector<double>& impulses, Workspace& work) {
  for (size_t r = 0; r < work.load.size(); ++r) work.load[r] = (work.load[r] + impulses[r]) / 2;
}

// The torque of a force f on a lever r falls by -[f]x [r]x dphi as the body turns, of which the symmetric part is a stiffness.
void findStiffness(const Island& island, const Component& component, double stable_swing,
                   Workspace& work) {
  work.is_resolved = true;
  if (!mayBeFast(island, component, stable_swing, work)) return;
  std::vector<Matrix3d>& stiffness = work.stiffness;
  stiffness.assign(size_t(component.bodies), Matrix3d::Zero());
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i) {
      if (!joint.isOnLever(i)) continue;
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      for (int side = 0; side < 2; ++side) {
        if (joint.body[size_t(side)] < 0 ||
            !(work.most_stiffness[size_t(joint.body[size_t(side)] - component.first_body)] > 0))
          continue;
        const Vector3d p = work.load[size_t(joint.row_of_component + i)] * row.J.L(side),
                       r = inDouble(side ? row.shape.b : row.shape.a);
        const Matrix3d rp = r * p.transpose();
        stiffness[size_t(joint.body[size_t(side)] - component.first_body)] +=
            r.dot(p) * Matrix3d::Identity() - (rp + rp.transpose()) / 2;
      }
    }
  }
  for (int i = 0; i < component.bodies; ++i) {
    if (!(work.most_stiffness[size_t(i)] > 0)) continue;
    Matrix3d& of = stiffness[size_t(i)];
    of = clipped(island.dt / stable_swing * of -
                 island.bodies[size_t(component.first_body + i)].inertia);
    work.is_resolved = work.is_resolved && of.isZero(0);
  }
}

bool foreseeLoad(const Island& island, const Component& component, double stable_swing,
                 Workspace& work) {
  const bool was_resolved = work.is_resolved;
  work.last_load = work.load;
  if (!was_resolved) work.last_stiffness = work.stiffness;
  addLoad(work.lambda, work);
  findStiffness(island, component, stable_swing, work);
  work.load = work.last_load;
  if (work.is_resolved) return false;
  for (int i = 0; i < component.bodies; ++i) {
    const double own = island.bodies[size_t(component.first_body + i)].inertia.trace(),
                 was = own + (was_resolved ? 0 : work.last_stiffness[size_t(i)].trace()),
                 is = own + work.stiffness[size_t(i)].trace();
    if (is * stable_swing > unstable_swing * was) return true;
  }
  return false;
}

void stiffen(const Island& island, const Component& component, const Workspace& work,
             JointMatrix& K) {
  std::vector<InverseInertia>& bodies = K.bodies();
  bodies.clear();
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    if (work.is_resolved)
      bodies.emplace_back(body);
    else
      bodies.emplace_back(body, work.stiffness[size_t(i)]);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
