// A door is thrown at its springy stop.

#include "../measures/courses.h"
#include "catalog_scenes.h"
#include "joints.h"
#include "tables.h"

namespace tables {
namespace {

Measurement door_measurement(const measures::DoorCourse& course, double right_overshoot,
                             double microseconds = 0) {
  return {{degrees(course.overshoot), course.rebound, double(course.bounces),
           or_infinite(course.rest_time >= 0, course.rest_time)},
          std::abs(course.overshoot - right_overshoot),
          microseconds};
}

// As it should be: by the scene's closed form, each millisecond.
measures::DoorCourse wanted_door(const scenes::Scene& scene) {
  measures::DoorCourse course;
  constexpr double dt = 1e-3;
  double last = 0;
  for (int step = 1; step * dt <= scene.seconds; ++step) {
    const scenes::Vector3d edge = scene.closed_form(step * dt);
    const double angle = std::atan2(edge.y(), edge.x());
    course.observe(step * dt, angle - scene.joints[0].range.high, (angle - last) / dt);
    last = angle;
  }
  return course;
}

Measurement measure_door(const scenes::Scene& scene, double dt, double right_overshoot,
                         const Make& make) {
  const auto engine = make(scene);
  measures::DoorCourse course;
  scenes::Unwrap angle(0);
  const measures::Outcome outcome = measures::run(
      scene, *engine, dt, [&](double time, const std::vector<engines::State>& states) {
        const engines::State& door = states.back();
        course.observe(time, angle(angle_about_z(door)) - scene.joints[0].range.high,
                       door.angular_velocity.z());
      });
  return door_measurement(course, right_overshoot, microseconds_per_step(outcome));
}

}  // namespace

void run_door(Output& out) {
  Table table(out, "door", "thrown at a soft stop (spring of 3 Hz, damping ratio z)",
              {{"beyond", "deg", "%.2f"},
               {"rebound", "of speed", "%.3f"},
               {"bounces", "", "%.0f"},
               {"rest at", "s", "%.2f"}});
  for (const double hz : {60, 240, 1000}) {
    for (const double damping_ratio : {0.1, 0.3, 1.0}) {
      const scenes::Scene scene = scenes::door_scene(damping_ratio);
      const double dt = 1 / hz;
      // The stock joint's other way to a soft stop: the spring as ERP and CFM of the stop, with the
      // door's inertia put in by hand, and without the softening by setLimit's bias.
      const Make spring_as_cfm = [=](const scenes::Scene& of) {
        auto engine = engines::make_bullet(of, 10, engines::make_stock_joint);
        const scenes::Body& door = of.bodies.back();
        const double arm = door.pose.translation().norm();
        const double inertia = door.inertia.z() + door.mass * arm * arm;
        const double w = 2 * scenes::pi * of.joints[0].spring.frequency;
        const double k = inertia * w * w, c = 2 * damping_ratio * inertia * w;
        const double gain = dt * k + c;
        auto& hinge = static_cast<Stock&>(engine->joint(0));
        hinge.setLimit(hinge.getLowerLimit(), hinge.getUpperLimit(), btScalar(0.9), 1, 0);
        hinge.setParam(BT_CONSTRAINT_STOP_ERP, btScalar(dt * k / gain));
        hinge.setParam(BT_CONSTRAINT_STOP_CFM, btScalar(1 / (dt * gain)));
        return engine;
      };
      const measures::DoorCourse wanted = wanted_door(scene);
      const auto measure = [&](const Make& make) {
        return measure_door(scene, dt, wanted.overshoot, make);
      };
      table.compare(text("z=%g %gHz", damping_ratio, hz),
                    {{"wanted", [&] { return door_measurement(wanted, wanted.overshoot); }},
                     {"stock", [&] { return measure(with(engines::make_stock_joint)); }},
                     {"s. cfm", [&] { return measure(spring_as_cfm); }},
                     {"pintle", [&] { return measure(with(engines::make_conditioned_joint)); }}});
    }
  }
}

}  // namespace tables
