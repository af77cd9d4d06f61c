#include <pintle/solver/energy_ledger.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

double kineticEnergy(const IslandBody& body, const Vector6d& v) {
  return (body.mass * v.head<3>().squaredNorm() + v.tail<3>().dot(body.inertia * v.tail<3>())) / 2;
}

}  // namespace

double kineticEnergyOfStart(const Island& island, const Component& component) {
  double sum = 0;
  for (int i = component.first_body; i < component.first_body + component.bodies; ++i)
    sum += kineticEnergy(island.bodies[size_t(i)], island.bodies[size_t(i)].v0);
  return sum;
}

double kineticEnergy(const Island& island, const Component& component, const Iterate& at) {
  double sum = 0;
  for (int i = 0; i < component.bodies; ++i)
    sum += kineticEnergy(island.bodies[size_t(component.first_body + i)], at.bodies[size_t(i)].v);
  return sum;
}

// An impulse lambda along G changes the kinetic energy by lambda . G times the mean of the velocities before and after.
double workOfJoints(const Island& island, const Component& component, const Iterate& at) {
  double work = 0;
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    work += kineticEnergy(body, at.bodies[size_t(i)].v) - kineticEnergy(body, body.v_free);
  }
  size_t r = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    const auto mean = [&](int side) -> Vector6d {
      const int body = joint.body[size_t(side)];
      if (body < 0) return Vector6d::Zero();
      return (at.bodies[size_t(body - component.first_body)].v +
              island.bodies[size_t(body)].v_free) /
             2;
    };
    for (int i = 0; i < joint.rows; ++i, ++r) {
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
