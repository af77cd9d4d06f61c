#include <pintle/solver/joint_report.h>

#include <pintle/solver/joint_access.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

template <class Visit>
void forEachJoint(const Component& component, Island& island, const Visit& visit) {
  size_t row = 0;
  for (int c = 0; c < component.joints; ++c) {
    IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    visit(joint, row);
    row += size_t(joint.rows);
  }
}

btVector3 toBullet(const Vector3d& v) { return {Scalar(v[0]), Scalar(v[1]), Scalar(v[2])}; }

}  // namespace

bool breakOverloaded(Island& island, const Component& component, const Iterate& at) {
  bool any = false;
  forEachJoint(component, island, [&](IslandJoint& joint, size_t first) {
    const double threshold = double(joint.constraint->getBreakingImpulseThreshold());
    if (!(threshold < double(infinity)) || !joint.constraint->isEnabled()) return;
    bool overloaded = false;
    for (int i = 0; i < joint.rows; ++i)
      overloaded = overloaded || std::abs(at.lambda[first + size_t(i)]) >= threshold;
    if (!overloaded) return;
    any = true;
    joint.constraint->setEnabled(false);
    for (int i = 0; i < joint.rows; ++i) {
      IslandRow& row = island.rows[size_t(joint.first_row + i)];
      row.law.clear();
      row.law.add({0, 0, 0, 0});
      row.open = 0;
    }
  });
  return any;
}

void report(const Island& island, const Component& component, const Iterate& at) {
  forEachJoint(component, const_cast<Island&>(island), [&](IslandJoint& joint, size_t first) {
    btTypedConstraint& constraint = *joint.constraint;
    Joint* const ours = JointAccess::ours(constraint);
    btJointFeedback* const feedback = constraint.getJointFeedback();
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      const RowAtEnd& end = at.rows[first + size_t(i)];
      const double lambda = at.lambda[first + size_t(i)];
      // Bullet's sign is the other one, and coordinates may fall along their rows.
      constraint.internalSetAppliedImpulse(Scalar(-row.sign * lambda));
      if (feedback != nullptr) {
        const double force = lambda / island.dt;
        feedback->m_appliedForceBodyA += toBullet(force * end.G.L_a);
        feedback->m_appliedTorqueBodyA += toBullet(force * end.G.A_a);
        feedback->m_appliedForceBodyB += toBullet(force * end.G.L_b);
        feedback->m_appliedTorqueBodyB += toBullet(force * end.G.A_b);
      }
      if (ours == nullptr || row.start.axis < 0) continue;
      AxisState& state = JointAccess::axis(*ours, row.start);
      double impulse[AxisLaw::max_parts];
      row.law.split(end.u, lambda, impulse);
      state.impulse = {};
      for (int k = 0; k < row.law.parts(); ++k)
        state.impulse[size_t(row.law.part(k).role)] += Scalar(impulse[k]);
    }
  });
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
