// The document's unstable joints, beside those that hold.

#include "../scenes/unstable.h"

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>

#include "joints.h"
#include "recovery.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

using tables::measure;  // of a recovery

template <class Joint>
Measurement measure(const scenes::BeamSettings& settings) {
  const scenes::BeamResult r = scenes::beam<Joint>(settings);
  const double last = or_infinite(r.finite, degrees(r.last_error));
  return {{degrees(r.first_error), last, degrees(r.max_error), r.max_angular_speed},
          last,
          r.microseconds_per_step};
}

template <class Joint>
Measurement measure(const scenes::SpinSettings& settings) {
  const scenes::SpinResult r = scenes::spin<Joint>(settings);
  const double change = or_infinite(r.finite, r.momentum_change);
  return {{change, degrees(r.end_error)}, change, r.microseconds_per_step};
}

// The joint that is measured as its settings ask, by name.
template <class Joint, class Settings>
Contender contender(const char* who, const Settings& settings) {
  return {who, [settings] { return measure<Joint>(settings); }};
}
template <class Settings>
std::vector<Contender> hinges(const Settings& settings) {
  return {contender<Stock>("stock", settings),
          contender<Ours>("pintle", settings),
          contender<pintle::DotHinge>("dot", settings),
          contender<pintle::TwoPointHinge>("2 points", settings),
          contender<pintle::CrossProductHinge>("1 row", settings),
          contender<pintle::CrossProductMatrixHinge>("3 rows", settings)};
}
template <class Settings>
std::vector<Contender> locks(Settings settings) {
  settings.lock = true;
  return {contender<btFixedConstraint>("stock", settings),
          contender<pintle::FixedJoint>("pintle", settings),
          contender<pintle::SingleRowLock>("1 row", settings)};
}

template <class Settings>
void compareAtTwoRates(Table& table) {
  for (const double hz : {60, 240}) {
    Settings settings;
    settings.dt = 1 / hz;
    table.compare(text("hinge %gHz", hz), hinges(settings));
    table.compare(text("lock %gHz", hz), locks(settings));
  }
}

}  // namespace

void run_unstable(Output& out) {
  {
    Table table(out, "beam", "held level by its end for 10 s: error in the first and last",
                {{"first s", "deg", "%.1e"},
                 {"last s", "deg", "%.1e"},
                 {"max", "deg", "%.1e"},
                 {"speed", "rad/s", "%.2f"}});
    compareAtTwoRates<scenes::BeamSettings>(table);
  }
  {
    Table table(out, "spin", "a free pair, violated by 40 deg, spins for 5 s",
                {{"momentum", "relative", "%.1e"}, {"end", "deg", "%.1e"}});
    compareAtTwoRates<scenes::SpinSettings>(table);
  }
  Table table(out, "recovers", "two free boxes, their frames apart at the start",
              {{"steps", "to 1 deg", "%.0f"},
               {"speed", "rad/s", "%.1f"},
               {"end", "deg", "%.1e"},
               {"max gap", "m", "%.2e"}});
  for (const double angle : {45, 120, 179}) {
    scenes::RecoverySettings settings;
    settings.angle = radians(angle);
    settings.about = {0.6, 0.8, 0};
    table.compare(text("hinge %g deg", angle), hinges(settings));
  }
  for (const double angle : {45, 90, 120, 179, 180}) {
    scenes::RecoverySettings settings;
    settings.angle = radians(angle);
    settings.about = {0, 1, 0};
    table.compare(text("lock %g about y", angle), locks(settings));
    settings.about = Eigen::Vector3d(1, 1, 1).normalized();
    table.compare(text("lock %g about xyz", angle), locks(settings));
  }
}

}  // namespace tables
