// Chains of hinges: what joints lack, and what energy does.
#include <pintle/joints/quaternion_hinge.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>

#include <scenes/chain.h>

#include <cstdio>

#include "solver_bench.h"

namespace solver_bench {
namespace {

class Dantzig : public btMLCPSolver {
 public:
  Dantzig() : btMLCPSolver(&m_dantzig) {}

 private:
  btDantzigSolver m_dantzig;
};

}  // namespace

void chains() {
  std::printf("%-24s %-16s %9s %9s %9s %9s %9s %9s %7s %7s  tip\n", "chain", "", "mean gap",
              "max gap", "axes rad", "energy", "in step", "gain", "us/step", "ratio");
  struct Case {
    int links;
    double ratio, hz;
    const char* load;  // in words
  };
  for (const Case& c : {Case{10, 1, 60, ""},
                        {10, 1, 120, ""},
                        {10, 100, 60, ", load 100:1"},
                        {10, 1e4, 60, ", load 10 000:1"},
                        {10, 1e6, 60, ", load 1 000 000:1"},
                        {100, 1000, 240, ", load 1000:1"},
                        {100, 1e4, 60, ", load 10 000:1"}}) {
    scenes::ChainSettings stock;
    stock.links = c.links;
    stock.ratio = c.ratio;
    stock.dt = 1 / c.hz;
    scenes::ChainSettings none = stock, hundred = stock, dantzig = stock, ours = stock;
    none.iterations = 0;  // what Bullet's step takes whatever solves it
    hundred.iterations = 100;
    dantzig.make_solver = [] { return std::make_unique<Dantzig>(); };
    ours.make_solver = exact;
    using Run = std::function<scenes::ChainResult()>;
    const char* names[] = {"stock, 10", "stock, 0", "stock, 100",
                           "Dantzig",   "exact",    "exact, stock j."};
    std::vector<Run> runs = {[&] { return scenes::chain<btHingeConstraint>(stock); },
                             [&] { return scenes::chain<btHingeConstraint>(none); },
                             [&] { return scenes::chain<btHingeConstraint>(hundred); },
                             [&] { return scenes::chain<btHingeConstraint>(dantzig); },
                             [&] { return scenes::chain<pintle::QuaternionHinge>(ours); },
                             [&] { return scenes::chain<btHingeConstraint>(ours); }};
    // Dense, and cubic in the rows: minutes.
    if (c.links > 10) runs[3] = [] { return scenes::ChainResult(); };
    const auto results = inTurn(runs);
    char title[48];
    std::snprintf(title, sizeof(title), "chain of %d%s, %g Hz", c.links, c.load, c.hz);
    addHolds(title, results[0], results[4], results[5]);
    for (size_t i = 0; i < results.size(); ++i) {
      const auto& r = results[i];
      if (c.links > 10 && i == 3) continue;
      char scene[40];
      std::snprintf(scene, sizeof(scene), "chain(%d, %g, 1/%g)", c.links, c.ratio, c.hz);
      std::printf("%-24s %-16s %9.1e %9.1e %9.1e %9.1e %9.1e %+9.4f %7.1f %7.2f  %.2f %.2f %.2f\n",
                  scene, names[i], r.mean_gap, r.max_gap, r.max_axis_angle, r.max_energy_error,
                  r.in_step_energy_error, r.energy_gain, r.microseconds_per_step,
                  r.microseconds_per_step / results[0].microseconds_per_step, r.tip.x(), r.tip.y(),
                  r.tip.z());
    }
  }
}

}  // namespace solver_bench
