// A ball is dropped on a plane.

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include "../measures/courses.h"
#include "catalog_scenes.h"
#include "tables.h"

namespace tables {
namespace {

// Bullet's contact is the collision of a sphere with a plane, which its centre then stays a radius above.
std::unique_ptr<engines::BulletEngine> make_collision(const scenes::Scene& scene) {
  static btSphereShape sphere(btScalar(0.1));
  static btStaticPlaneShape plane(btVector3(0, 0, 1), btScalar(-0.1));
  auto engine = std::make_unique<engines::BulletEngine>(scene, 10);
  for (const int i : {0, 1}) {
    btRigidBody& body = engine->body(i);
    engine->world().removeRigidBody(&body);
    body.setCollisionShape(i == 0 ? static_cast<btCollisionShape*>(&plane) : &sphere);
    // Bullet takes the product.
    body.setRestitution(btScalar(std::sqrt(scene.joints[0].restitution)));
    engine->world().addRigidBody(&body);
  }
  return engine;
}

Measurement measure_bounce(const scenes::Scene& scene, double dt, const Make& make) {
  const auto engine = make(scene);
  const double height = scene.bodies.back().pose.translation().z();
  measures::BounceCourse course(height);
  const measures::Outcome outcome =
      measures::run(scene, *engine, dt, [&](double, const std::vector<engines::State>& states) {
        course.observe(states.back().pose.translation().z());
      });
  const double e = scene.joints[0].restitution, wanted = e * e * height;
  const double rebound = wanted > 0 ? course.rebound / wanted : course.rebound;
  return {{or_infinite(outcome.finite, rebound), or_infinite(outcome.finite, course.below),
           or_infinite(outcome.finite, course.rest)},
          or_infinite(outcome.finite, std::abs(rebound - (wanted > 0 ? 1 : 0))),
          microseconds_per_step(outcome)};
}

}  // namespace

void run_bounce(Output& out) {
  Table table(out, "bounce", "a ball is dropped on a plane, and bounces until it rests",
              {{"rebound", "of e^2 h", "%.3f", "lost"},
               {"below", "m", "%.1e", "lost"},
               {"rest at", "m", "%.1e", "lost"}});
  for (const double restitution : {0., 0.5, 0.8}) {
    const scenes::Scene scene = scenes::bounce_scene(restitution);
    const Make ours = with(engines::make_conditioned_joint);
    for (const double hz : {60, 240}) {
      table.compare(text("e = %g %gHz", restitution, hz),
                    {{"stock", [&] { return measure_bounce(scene, 1 / hz, make_collision); }},
                     {"pintle", [&] { return measure_bounce(scene, 1 / hz, ours); }}});
    }
  }
}

}  // namespace tables
