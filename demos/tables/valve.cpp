// A motor turns a wheel onto its stops, several turns apart.

#include "catalog_scenes.h"
#include "joints.h"
#include "tables.h"

namespace tables {
namespace {

engines::BulletJoint make_counting_hinge(const scenes::Joint& joint, btRigidBody& a,
                                         btRigidBody& b) {
  auto hinge = std::make_unique<StockCounting>(a, b, scenes::to_bullet(joint.in_a),
                                               scenes::to_bullet(joint.in_b), true);
  hinge->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  StockCounting* const driven = hinge.get();
  return {std::move(hinge), [driven, torque = joint.motor.max_torque](double speed, double dt) {
            driven->enableAngularMotor(true, btScalar(speed), btScalar(torque * dt));
          }};
}

template <class Hinge>
Measurement measure_valve(const scenes::Scene& scene, engines::MakeJoint make_joint) {
  const auto engine = engines::make_bullet(scene, 10, make_joint);
  auto& hinge = static_cast<Hinge&>(engine->joint(0));
  const double stop = scene.joints[0].range.high;
  double top = 0, bottom = 0, miscount = NAN;
  scenes::Unwrap angle(0);
  const measures::Outcome outcome = measures::run(
      scene, *engine, 1. / 60, [&](double time, const std::vector<engines::State>& states) {
        const double now = angle(angle_about_z(states.back()));
        (time < scene.seconds / 2 + 1e-3 ? top : bottom) = now;
        if constexpr (scenes::HasAccumulatedAngle<Hinge>::value) {
          const double error = std::abs(double(hinge.getAccumulatedHingeAngle()) - now);
          miscount = std::isnan(miscount) ? error : std::max(miscount, error);
        }
      });
  return {{degrees(top), degrees(bottom), degrees(outcome[scenes::Error::overshoot]),
           degrees(miscount)},
          std::max(std::abs(top - stop), std::abs(bottom)),
          microseconds_per_step(outcome)};
}

}  // namespace

void run_valve(Output& out) {
  Table table(out, "valve", "a motor turns a wheel up to 1800 deg and back to 0",
              {{"up", "deg", "%.3f"},
               {"down", "deg", "%.3f"},
               {"beyond", "deg", "%.3f"},
               {"miscount", "deg", "%.1e"}});
  for (const double speed : {6, 12, 20}) {
    const scenes::Scene scene = scenes::valve_scene(5, speed);
    table.compare(
        text("%g rad/s 60Hz", speed),
        {{"stock", [&] { return measure_valve<Stock>(scene, engines::make_stock_joint); }},
         {"stock c.", [&] { return measure_valve<StockCounting>(scene, make_counting_hinge); }},
         {"pintle", [&] { return measure_valve<Ours>(scene, engines::make_conditioned_joint); }}});
  }
}

}  // namespace tables
