#include <pintle/solver/contact_push.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// J w of the rows of a component that act, and then what they do against it.
void holdJoints(const Island& island, const BlockOfJoints& of, std::vector<Vector6d>& push) {
  Workspace& work = *of.work;
  const Vector6d zero = Vector6d::Zero();
  work.x.assign(of.K->unknowns(), 0.);
  forEachRow(island, *of.component, [&](int c, int i, const IslandRow& row, size_t r) {
    if (!work.pieces[r].acts) return;
    const IslandJoint& joint = island.joints[size_t(of.component->first_joint + c)];
    const auto at = [&](int side) -> const Vector6d& {
      const int body = joint.body[size_t(side)];
      return body < 0 ? zero : push[size_t(body)];
    };
    work.x[of.K->row(c) + size_t(i)] = -row.J.along(at(0), at(1)) / row.root_K;
  });
  of.K->solve(work.x.data());
  of.K->addResponse(work.x.data(), push.data() + of.component->first_body);
}

}  // namespace

// As block_gauss_seidel.h does it: contacts see what joints do to their own bodies, and no pass goes too far.
void findPush(const Island& island, const std::vector<BlockOfJoints>& blocks,
              std::vector<ContactRow>& contacts, const SolverOptions& options, int most,
              std::vector<Vector6d>& push) {
  push.assign(island.bodies.size(), Vector6d::Zero());
  std::vector<Vector6d> start;
  std::vector<double> impulse(contacts.size(), 0.), before;
  for (int pass = 0; pass < most; ++pass) {
    start = push;
    before = impulse;
    double largest = 0;
    for (size_t r = 0; r < contacts.size(); ++r) {
      ContactRow& row = contacts[r];
      if (!(row.push_target > 0) || !(row.K > 0)) continue;
      const double left = row.push_target - row.velocity(push) - row.softness * impulse[r],
                   next = std::fmax(0, impulse[r] + left / (row.K + row.softness));
      row.push(next - impulse[r], row.with_joints, push);
      largest = std::fmax(largest, std::abs(row.K * (next - impulse[r])));
      impulse[r] = next;
    }
    push = start;
    for (size_t r = 0; r < contacts.size(); ++r) contacts[r].push(impulse[r] - before[r], push);
    for (const BlockOfJoints& of : blocks) holdJoints(island, of, push);
    double slope = 0, bend = 0;
    for (size_t r = 0; r < contacts.size(); ++r) {
      const ContactRow& row = contacts[r];
      const double by = impulse[r] - before[r];
      if (by == 0) continue;
      const double u = row.velocity(start);
      slope += by * (u + row.softness * before[r] - row.push_target);
      bend += by * (row.velocity(push) - u + row.softness * by);
    }
    if (slope < 0 && bend > -slope) {
      const double part = -slope / bend;
      for (size_t i = 0; i < push.size(); ++i) push[i] = start[i] + part * (push[i] - start[i]);
      for (size_t r = 0; r < impulse.size(); ++r)
        impulse[r] = before[r] + part * (impulse[r] - before[r]);
    }
    if (largest * island.dt <= options.contact_tolerance) break;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
