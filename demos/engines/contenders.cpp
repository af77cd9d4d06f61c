// The list of contenders. A new one is a line here.

#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <pintle/solver/exact_joint_solver.h>

#include "bullet.h"
#include "multibody.h"
#include "peers.h"

namespace engines {
namespace {

// btMLCPSolver does not own what it solves with.
class DantzigSolver : private btDantzigSolver, public btMLCPSolver {
 public:
  DantzigSolver() : btMLCPSolver(this) {}
};

template <class Solver>
std::unique_ptr<btConstraintSolver> make() {
  return std::make_unique<Solver>();
}

std::unique_ptr<btConstraintSolver> make_second_order() {
  auto solver = std::make_unique<pintle::ExactJointSolver>();
  pintle::SolverOptions options;
  options.second_order = true;
  solver->setOptions(options);
  return solver;
}

Contender with(const char* name, const char* what, const char* colour, MakeJoint joints,
               const scenes::SolverFactory& solver = {}, Iterates iterates = Iterates::always) {
  return {name, what, colour, iterates, [=](const scenes::Scene& scene, int iterations) {
            return make_bullet(scene, iterations, joints, solver);
          }};
}

}  // namespace

const std::vector<Contender>& contenders() {
  static const std::vector<Contender> list = {
    // Colours are Okabe and Ito's, which the colour-blind tell apart, with a grey for stock and a wine red in the place of
    // their yellow, which is lost on white. (Tol's olive is for steps of second order.)
    // A Bullet solver of one's own: with("name", "what", "#rrggbb", make_conditioned_joint, make<Solver>),
    with("stock", "Bullet's joints", "#7d8590", make_stock_joint),
    with("document", "Pintle's, in the document's form", "#e69f00", make_document_joint),
    with("pintle", "Pintle's, conditioned", "#0072b2", make_conditioned_joint),
    with("exact", "Pintle's on ExactJointSolver", "#d55e00", make_conditioned_joint,
         make<pintle::ExactJointSolver>, Iterates::with_bounds),
    with("second_order", "Pintle's on ExactJointSolver, in steps of second order", "#999933",
         make_conditioned_joint, make_second_order, Iterates::with_bounds),
    with("dantzig", "Bullet's joints, btMLCPSolver with Dantzig", "#cc79a7", make_stock_joint,
         make<DantzigSolver>, Iterates::never),
    {"multibody", "btMultiBody", "#009e73", Iterates::never,
     [](const scenes::Scene& scene, int) { return make_multibody(scene); }},
#if defined(PINTLE_ODE) && defined(BT_USE_DOUBLE_PRECISION)
    {"ode", "ODE's iterative solver", "#56b4e9", Iterates::always, make_ode},
#endif
#if defined(PINTLE_JOLT) && defined(BT_USE_DOUBLE_PRECISION)
    {"jolt", "Jolt in WebAssembly, in single", "#882255", Iterates::always, make_jolt},
#endif
#if defined(PINTLE_MUJOCO) && defined(BT_USE_DOUBLE_PRECISION)
    {"mujoco", "MuJoCo", "#000000", Iterates::always, make_mujoco},
#endif
  };
  return list;
}

const Contender* find_contender(const std::string& name) {
  for (const Contender& contender : contenders())
    if (contender.name == name) return &contender;
  return nullptr;
}

}  // namespace engines
