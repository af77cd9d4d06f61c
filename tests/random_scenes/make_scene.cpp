#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "draws.h"
#include "random_joints.h"
#include "random_scene.h"

namespace random_scenes {
namespace {

using support::Random;

const char* nameOf(int kind) { return kind < 0 ? "mixed" : kindOf(kind).name; }

const char* const shapes[] = {"chain", "tree", "loop", "cable", "net", "star"};

// A spring that the start has stretched may give what it stores.
Variant makeVariant(const Scene& scene, Random& random) {
  Variant variant;
  variant.bends = chance(random, 0.5);
  variant.document = chance(random, 0.2);
  if (chance(random, 0.2) && !(scene.overlap > 0)) {
    variant.spring_hz = scene.hz * power(random, -3, -0.8);
    variant.spring_damping = chance(random, 0.3) ? 0 : random.uniform(0, 1);
  }
  return variant;
}

}  // namespace

Scene makeScene(unsigned seed) {
  Random random(seed ^ 0x9e3779b9u);
  Scene scene = {};
  scene.seed = seed;
  scene.shape = Shape(std::min(5, int(random.uniform(0, 6))));
  scene.kind = std::min(kindCount() - 1, int(random.uniform(0, kindCount())));
  if (random.uniform(0, 1) < 0.2) scene.kind = -1;
  scene.bodies = 1 + int(random.uniform(0, 8));
  if (scene.shape == Shape::cable || scene.shape == Shape::loop) scene.bodies += 2;
  if (scene.shape == Shape::net) scene.bodies = chance(random, 0.5) ? 4 : 9;
  scene.hz = chance(random, 0.5) ? (chance(random, 0.5) ? 60 : 120)
                                 : std::round(15 * power(random, 0, 1.82));
  scene.mass_decades = random.uniform(0, 3);
  scene.load = chance(random, 0.2) ? power(random, 0, 6) : 1;
  if (scene.load > 1) scene.mass_decades = 0;
  scene.speed = random.uniform(0, 5);
  scene.erp = chance(random, 0.5) ? 0.2 : random.uniform(0, 1);
  scene.cfm = chance(random, 0.7) ? 0 : power(random, -9, -2);
  scene.contacts = chance(random, 0.3);
  scene.friction = chance(random, 0.7);
  scene.rubs = chance(random, 0.3);
  scene.threshold = chance(random, 0.15) ? power(random, -1, 2) : 0;
  scene.locks = chance(random, 0.15);
  scene.kinematic = chance(random, 0.15);
  scene.overlap = chance(random, 0.15) ? random.uniform(0, 0.3) : 0;
  scene.has_own = chance(random, 0.3);
  scene.own_erp = random.uniform(0, 1);
  scene.own_stop_erp = random.uniform(0, 1);
  const auto softness = [&] { return chance(random, 0.5) ? 0 : power(random, -9, -2); };
  scene.own_cfm = softness();
  scene.own_stop_cfm = softness();
  scene.variant = makeVariant(scene, random);
  return scene;
}

Scene withSoftStops(unsigned seed) {
  Scene scene = makeScene(seed);
  scene.has_own = true;
  if (!(scene.own_stop_cfm > 0)) scene.own_stop_cfm = 1e-3;
  return scene;
}

Scene withHeavyLoadOnRopes(unsigned seed) {
  Scene scene = makeScene(seed);
  scene.shape = seed % 2 ? Shape::tree : Shape::chain;
  scene.kind = 0;
  while (std::strcmp(kindOf(scene.kind).name, "rope") != 0) ++scene.kind;
  scene.bodies = 3 + int(seed % 5);
  scene.hz = 30;
  scene.mass_decades = 0;
  scene.load = 1e5;
  scene.contacts = scene.locks = false;
  scene.threshold = scene.overlap = 0;
  return scene;
}

std::string describe(const Scene& s) {
  std::ostringstream out;
  out << s.seed << ": " << shapes[int(s.shape)] << " of " << nameOf(s.kind) << ", " << s.bodies
      << " bodies, " << s.hz << " Hz, masses of " << s.mass_decades << " decades, load " << s.load
      << ", speed " << s.speed << ", ERP " << s.erp << ", CFM " << s.cfm;
  if (s.contacts) out << (s.friction ? ", contacts with friction" : ", contacts");
  if (s.rubs) out << ", friction in joints";
  if (s.threshold > 0) out << ", breaks at " << s.threshold;
  if (s.locks) out << ", locked factors";
  if (s.kinematic) out << ", kinematic";
  if (s.overlap > 0) out << ", starts " << s.overlap << " m apart";
  if (s.has_own)
    out << ", joints' own ERP " << s.own_erp << " and CFM " << s.own_cfm << ", of stops "
        << s.own_stop_erp << " and " << s.own_stop_cfm;
  if (s.variant.bends) out << ", bends have limits";
  if (s.variant.document) out << ", the document's forms";
  if (s.variant.spring_hz > 0)
    out << ", limits spring at " << s.variant.spring_hz << " Hz, damped by "
        << s.variant.spring_damping;
  return out.str();
}

}  // namespace random_scenes
