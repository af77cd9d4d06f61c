#include <pintle/solver/acting_rows.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

void setActing(const Island& island, const Component& component, Workspace& work, JointMatrix& K) {
  work.softness.resize(work.scales.size());
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const Workspace::Scale& scale = work.scales[r];
      const LawPiece& piece = work.pieces[r];
      double& softness = work.softness[r];
      softness = work.of_loop[size_t(c)];
      if (piece.softness > 0)
        softness = std::max(softness, piece.softness / (scale.root_K * scale.root_K));
      K.setActing(scale.at, piece.acts, softness);
    }
  }
}

void aimRows(const Island& island, const Component& component, const JointMatrix& K,
             Workspace& work) {
  setZero(K.vectorSize(), work.aim);
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const RowJacobian& J = island.rows[size_t(joint.first_row + i)].J;
      work.aim[work.scales[r].at] =
          (work.pieces[r].target - island.velocityOfUnmoved(joint, J)) * work.scales[r].by_root_K;
    }
  }
}

double findResidual(double dt, Workspace& work) {
  double largest = 0;
  for (size_t r = 0; r < work.scales.size(); ++r) {
    const LawPiece& piece = work.pieces[r];
    const auto& [root_K, by_root_K, at] = work.scales[r];
    const double left =
        piece.acts ? work.u[r] - piece.target + work.softness[r] * root_K * work.y[at] : 0;
    work.x[at] = -left * by_root_K;
    largest = larger(largest, left);
  }
  return largest * dt;
}

double findResidual(double dt, const JointMatrix& K, const Vector6d* v, Workspace& work) {
  return dt * K.findResidual(work.aim.data(), work.y.data(), v, work.x.data());
}

void unscaleImpulses(Workspace& work) {
  work.lambda.resize(work.scales.size());
  for (size_t r = 0; r < work.scales.size(); ++r)
    work.lambda[r] = work.y[work.scales[r].at] * work.scales[r].by_root_K;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
