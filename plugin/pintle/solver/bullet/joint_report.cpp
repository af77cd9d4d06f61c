#include <pintle/solver/bullet/joint_report.h>

#include <pintle/solver/bullet/joint_access.h>
#include <pintle/solver/energy/energy_ledger.h>
#include <pintle/solver/model/row_velocities.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

bool breakOverloaded(Island& island, const Component& component, const Workspace& end) {
  bool any = false;
  for (int c = 0; c < component.joints; ++c) {
    IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const double threshold = double(joint.constraint->getBreakingImpulseThreshold());
    if (!(threshold < double(infinity)) || !joint.constraint->isEnabled()) continue;
    bool overloaded = false;
    for (int i = 0; i < joint.rows; ++i)
      overloaded =
          overloaded || std::abs(end.lambda[size_t(joint.row_of_component + i)]) >= threshold;
    if (!overloaded) continue;
    any = true;
    joint.constraint->setEnabled(false);
    for (int i = 0; i < joint.rows; ++i) {
      IslandRow& row = island.rows[size_t(joint.first_row + i)];
      row.law = AxisLaw();  // no part has an impulse
      row.open = 0;
      row.extras = nullptr;
    }
    joint.release();
  }
  return any;
}

void report(const Island& island, const Component& component, const Workspace& end) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    btTypedConstraint& constraint = *joint.constraint;
    btJointFeedback* const feedback = constraint.getJointFeedback();
    if (feedback == nullptr && !joint.has_axes) {
      constraint.internalSetAppliedImpulse(
          Scalar(-end.lambda[size_t(joint.row_of_component + joint.rows - 1)]));
      continue;
    }
    const IslandRow* const rows = &island.rows[size_t(joint.first_row)];
    const double* const impulses = &end.lambda[size_t(joint.row_of_component)];
    for (int i = 0, count = joint.rows; i < count; ++i) {
      const IslandRow& row = rows[i];
      const double lambda = impulses[i];
      if (feedback != nullptr) {
        const double force = lambda / island.dt;
        feedback->m_appliedForceBodyA += toBullet(force * row.J.L_a);
        feedback->m_appliedTorqueBodyA += toBullet(force * row.J.A_a);
        feedback->m_appliedForceBodyB += toBullet(force * row.J.L_b);
        feedback->m_appliedTorqueBodyB += toBullet(force * row.J.A_b);
      }
      // Bullet's sign is the other one, and coordinates may fall along their rows.
      if (!row.isOfAxis()) {
        constraint.internalSetAppliedImpulse(Scalar(-lambda));
        continue;
      }
      AxisState& state = JointAccess::axis(*joint.ours, *row.start);
      const AxisLaw::Parts impulse = end.split(row.law, size_t(joint.row_of_component + i));
      state.taken = 0;
      state.impulse = {};
      for (int k = 0; k < row.law.parts(); ++k)
        state.impulse[size_t(row.law.part(k).role)] += Scalar(impulse[size_t(k)]);
      // As in Bullet, where each part is a row and the last one is known.
      const Axis& axis = *state.axis;
      const Axis::Part last = state.impulse[Axis::limit] != 0  ? Axis::limit
                              : axis.drive != Axis::Drive::off ? Axis::motor
                              : axis.max_friction > 0          ? Axis::friction
                              : axis.spring.isSet()            ? Axis::spring_pull
                                                               : Axis::limit;
      // A limit that does not act has no row there.
      if (last != Axis::limit || state.impulse[last] != 0)
        constraint.internalSetAppliedImpulse(Scalar(-row.sign) * state.impulse[size_t(last)]);
      if (state.impulse[Axis::limit] == 0)
        state.incoming = 0;  // it was not met
      else if (state.incoming > 0) {
        const double u = row.J.along(meanVelocity(island, joint, 0, component, end.v),
                                     meanVelocity(island, joint, 1, component, end.v));
        state.taken = Scalar(
            keptForRebound(island, component, row, end, size_t(joint.row_of_component + i), u));
      }
    }
  }
}

void clearImpulses(btTypedConstraint& joint) {
  joint.internalSetAppliedImpulse(0);
  if (btJointFeedback* feedback = joint.getJointFeedback())
    for (btVector3* of : {&feedback->m_appliedForceBodyA, &feedback->m_appliedTorqueBodyA,
                          &feedback->m_appliedForceBodyB, &feedback->m_appliedTorqueBodyB})
      of->setZero();
}

void reportNothing(const Island& island, const Component& component) {
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    clearImpulses(*joint.constraint);
    for (int i = 0; i < joint.rows; ++i) {
      const IslandRow& row = island.rows[size_t(joint.first_row + i)];
      if (!row.isOfAxis()) continue;
      AxisState& state = JointAccess::axis(*joint.ours, *row.start);
      state.impulse = {};
      state.taken = state.incoming = 0;
    }
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
