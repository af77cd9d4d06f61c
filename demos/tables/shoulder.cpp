// A limb is thrown at its cone.

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <pintle/joints/cone_twist_joint.h>

#include "../scenes/shoulder.h"
#include "table.h"
#include "tables.h"

namespace tables {
namespace {

template <class Joint>
Measurement measure(const scenes::ShoulderSettings& settings) {
  const scenes::ShoulderResult r = scenes::shoulder<Joint>(settings);
  const double beyond = or_infinite(r.finite, r.swing_beyond);
  return {{degrees(beyond), degrees(or_infinite(r.finite, r.twist_beyond)),
           or_infinite(r.finite, r.top_speed), or_infinite(r.finite, r.rest_speed)},
          std::max(beyond, 0.0),
          r.microseconds_per_step};
}

}  // namespace

void run_shoulder(Output& out) {
  Table table(out, "shoulder", "a limb thrown at its cone (spans of swing 1 x 2, twist; speed)",
              {{"swing", "deg over", "%+.3f", "lost"},
               {"twist", "deg over", "%+.3f", "lost"},
               {"top", "rad/s", "%.2f", "lost"},
               {"rest", "rad/s", "%.1e", "lost"}});
  struct Spans {
    double swing_1, swing_2, twist;  // degrees
  };
  for (const Spans& spans :
       {Spans{45, 45, 30}, Spans{30, 70, 30}, Spans{6, 70, 30}, Spans{170, 170, 30}}) {
    for (const double speed : {3, 12}) {
      scenes::ShoulderSettings settings;
      settings.span_1 = radians(spans.swing_1);
      settings.span_2 = radians(spans.swing_2);
      settings.twist_span = radians(spans.twist);
      settings.spin = settings.spin.normalized() * speed;
      table.compare(text("%gx%g %g; %g", spans.swing_1, spans.swing_2, spans.twist, speed),
                    {{"stock", [&] { return measure<btConeTwistConstraint>(settings); }},
                     {"pintle", [&] { return measure<pintle::ConeTwistJoint>(settings); }}});
    }
  }
}

}  // namespace tables
