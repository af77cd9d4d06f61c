#include <pintle/solver/energy_ledger.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

double kineticEnergyOfStart(const Island& island, const Component& component) {
  double sum = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(i)];
    const auto w = body.v0.tail<3>();
    sum += (body.mass * body.v0.head<3>().squaredNorm() + w.dot(body.inertia * w)) / 2;
  }
  return sum;
}

// An impulse p works by p . (v0 + v1) / 2, v0 and v1 the velocities before and after the step: that of all joints is what the
// bodies have gained but for their forces.
double workOfJoints(const Island& island, const Component& component, const Iterate& at) {
  double work = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    const Vector6d &v = at.bodies[size_t(i)].v, twice = v + body.v0, by_joints = v - body.v_free;
    work += (body.mass * by_joints.head<3>().dot(twice.head<3>()) +
             by_joints.tail<3>().dot(body.inertia * twice.tail<3>())) /
            2;
  }
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const auto mean = [&](int side) -> Vector6d {
      const int body = joint.body[size_t(side)];
      if (body < 0) return Vector6d::Zero();
      return (at.bodies[size_t(body - component.first_body)].v + island.bodies[size_t(body)].v0) /
             2;
    };
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const AxisLaw& law = island.rows[size_t(joint.first_row + i)].law;
      if (!law.hasDrives()) continue;
      double impulse[AxisLaw::max_parts], driving = 0;
      law.split(at.rows[r].u, at.lambda[r], impulse);
      for (int k = 0; k < law.parts(); ++k)
        if (law.part(k).drives) driving += impulse[k];
      work -= driving * at.rows[r].G.along(mean(0), mean(1));
    }
  }
  return work;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
