#include <pintle/joints/gear_model.h>

#include <pintle/body_pair.h>
#include <pintle/bullet/complaints.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/gear_row.h>
#include <pintle/joints/gear_side.h>
#include <pintle/rows/row.h>

#include <limits>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Both coordinates at one pose.
struct GearReadings {
  GearReading a, b;
  Scalar places;  ///< a body that is nowhere has no row
  bool areFinite() const { return a.isFinite() && b.isFinite() && isFinite(places); }
};

// Adds what a coordinate, times a weight, changes by with the velocities of the gear's bodies, and with those of others.
void addTo(GearRow& row, const GearSide& side, const GearReading& of, Scalar weight,
           const btRigidBody& a, const btRigidBody& b, Scalar dt) {
  const auto add = [&](const btRigidBody& body, Scalar L_weight, Scalar A_weight, const Vec3& A) {
    if (&body == &a) {
      row.L_a += L_weight * of.L;
      row.A_a += A_weight * A;
    } else if (&body == &b) {
      row.L_b += L_weight * of.L;
      row.A_b += A_weight * A;
    } else if (body.isKinematicObject() || !body.isStaticObject()) {
      row.rate +=
          L_weight * of.L.dot(freeLinear(body, dt)) + A_weight * A.dot(freeAngular(body, dt));
    }
  };
  add(side.bodyB(), weight, weight, of.A_b);
  if (side.bodyA() != nullptr) add(*side.bodyA(), -weight, -weight, of.A_a);
}

void put(btScalar* to, const Vec3& v) {
  for (int i = 0; i < 3; ++i) to[i] = v[i];
}

}  // namespace

struct GearModel::State {
  State(const btRigidBody& body_a, const btRigidBody& body_b) : a(body_a), b(body_b) {}

  /// Not finite where one is unknown, or a body is nowhere.
  GearReadings read(const GearPoses& at) const {
    return {a.read(at), b.read(at), at.of.x_a().sum() + at.of.x_b().sum()};
  }
  /// The change of the sum (rad or m) by changes of the coordinates, as their sides count them.
  double weigh(double change_a, double change_b) const {
    return double(a.factor()) * change_a + double(ratio) * double(b.factor()) * change_b;
  }
  /// Counts the motion of the bodies since the last call. `holds_now`: the gear holds them from here on.
  void follow(const GearReadings& now, bool holds_now);
  /// rad or m.
  double sum() const { return a.value() + double(ratio) * b.value(); }

  GearSide a, b;
  /// C, rad or m. A step rounds it by 1e-16 of what it adds, whatever the count.
  double error = 0;
  Scalar ratio = std::numeric_limits<Scalar>::quiet_NaN();  ///< none was given
  bool holds = true;
  Scalar dt = Scalar(1) / 60;  ///< s, of the last step
  bool has_row = false;
  GearRow row;
};

// A coordinate that was put elsewhere changes what is held, and not the error.
void GearModel::State::follow(const GearReadings& now, bool holds_now) {
  const bool held = std::exchange(holds, holds_now);
  const GearSide::Change of_a = a.changeInStep(now.a, dt), of_b = b.changeInStep(now.b, dt);
  if (holds && held && !of_a.is_put_elsewhere && !of_b.is_put_elsewhere) {
    const double sum = error + weigh(of_a.size, of_b.size);
    if (isFinite(sum)) error = sum;
  }
  a.follow(now.a, of_a.size);
  b.follow(now.b, of_b.size);
}

GearModel::GearModel(btGearConstraint& gear, RowCount max_rows)
    : Joint(gear, max_rows), m_state(std::make_unique<State>(bodyA(), bodyB())) {
  GearModel::read(nullptr);
}

GearModel::~GearModel() = default;

const char* GearModel::name() const { return "GearJoint"; }

btGearConstraint& GearModel::gear() const {
  return static_cast<btGearConstraint&>(const_cast<GearModel*>(this)->constraint());
}

void GearModel::couple(const GearCoordinate& a, const GearCoordinate& b) {
  const BodyPair pair(bodyA(), bodyB());
  const GearPoses at{bodyA(), bodyB(), pair};
  m_state->a.name(a, gear().getAxisA(), at);
  m_state->b.name(b, gear().getAxisB(), at);
  m_state->error = 0;
}

// --- what stands in Bullet's object --------------------------------------------------------------

// The motion until now was one of the gear as it was.
void GearModel::read(Complaints* complaints) {
  State& state = *m_state;
  const auto isLong = [&](const btVector3& axis, const char* field) {
    const Scalar length2 = axis.length2();
    if (isFinite(length2)) return true;
    if (complaints != nullptr) complaints->add(field, length2, "must have a finite length");
    return false;
  };
  const btVector3 &axis_a = gear().getAxisA(), &axis_b = gear().getAxisB();
  const Scalar ratio = gear().getRatio();
  const bool is_ratio = isFinite(ratio);
  if (!is_ratio && complaints != nullptr) complaints->add("ratio", ratio, "must be finite");
  const bool is_a = isLong(axis_a, "axisA"), is_b = isLong(axis_b, "axisB");
  const bool has_other_ratio = is_ratio && ratio != state.ratio,
             has_other_a = is_a && !state.a.hasAxis(axis_a),
             has_other_b = is_b && !state.b.hasAxis(axis_b);
  if (!has_other_ratio && !has_other_a && !has_other_b) return;
  const BodyPair pair(bodyA(), bodyB());
  if (pair.finite()) updateState(pair);
  if (has_other_ratio) state.ratio = ratio;
  const GearPoses at{bodyA(), bodyB(), pair};
  if (has_other_a) state.a.takeAxis(axis_a, bodyA(), at);
  if (has_other_b) state.b.takeAxis(axis_b, bodyB(), at);
}

void GearModel::updateState(const PosePair& poses) {
  const GearReadings now = m_state->read({bodyA(), bodyB(), poses});
  if (now.areFinite()) m_state->follow(now, constraint().isEnabled());
}

// --- what it says of itself ----------------------------------------------------------------------

double GearModel::coordinateA() const { return m_state->a.value(); }
double GearModel::coordinateB() const { return m_state->b.value(); }
double GearModel::error() const { return m_state->error; }
double GearModel::heldSum() const { return m_state->sum() - m_state->error; }
void GearModel::hold(double sum) { m_state->error = m_state->sum() - sum; }

// --- rows ----------------------------------------------------------------------------------------

// rad/s or m/s: neither coordinate is to be corrected faster by itself than joints are.
Scalar GearModel::maxCorrection() const {
  const auto most = [this](const GearSide& side) {
    return side.isPosition() ? getMaxLinearCorrectionSpeed() : getMaxCorrectionSpeed();
  };
  const Scalar of_b = btFabs(m_state->ratio) * most(m_state->b);
  return of_b > 0 ? btMin(most(m_state->a), of_b) : most(m_state->a);
}

const GearRow* GearModel::beginStep() {
  readFromBullet();
  State& state = *m_state;
  state.has_row = false;
  const BodyPair pair(bodyA(), bodyB());
  if (!pair.finite()) return nullptr;
  const GearReadings now = state.read({bodyA(), bodyB(), pair});
  if (!now.areFinite()) return nullptr;
  state.follow(now, true);
  GearRow& row = state.row;
  row = {};
  addTo(row, state.a, now.a, 1, bodyA(), bodyB(), state.dt);
  addTo(row, state.b, now.b, state.ratio, bodyA(), bodyB(), state.dt);
  row.position = Scalar(state.error);
  row.max_speed = maxCorrection();
  const Vec3 sum = row.L_a + row.A_a + row.L_b + row.A_b;
  state.has_row = isFinite(row.position + row.rate + sum.sum());
  return state.has_row ? &row : nullptr;
}

const GearRow* GearModel::beginStep(Scalar dt) {
  m_state->dt = dt;
  return beginStep();
}

void GearModel::announceRows(Info1& info, int) {
  info.m_numConstraintRows = beginStep() != nullptr ? 1 : 0;
  info.nub = info.m_numConstraintRows;
}

void GearModel::writeRows(Info2& info) {
  const GearRow& row = m_state->row;
  if (!m_state->has_row) return;
  const Scalar dt = m_state->dt = 1 / info.fps;
  const Scalar away = info.erp * info.fps * row.position;
  Scalar target = -row.rate - btMax(-row.max_speed, btMin(away, row.max_speed));
  Scalar cfm = info.cfm[0];
  if (!(cfm < diverging_cfm)) {  // a rigid row, to where the soft one would come by itself
    const btRigidBody &a = bodyA(), &b = bodyB();
    const Scalar free = row.L_a.dot(freeLinear(a, dt)) + row.A_a.dot(freeAngular(a, dt)) +
                        row.L_b.dot(freeLinear(b, dt)) + row.A_b.dot(freeAngular(b, dt));
    target = free + (target - free) / (1 + cfm);
    cfm = 0;
  }
  put(info.m_J1linearAxis, row.L_a);
  put(info.m_J1angularAxis, row.A_a);
  put(info.m_J2linearAxis, row.L_b);
  put(info.m_J2angularAxis, row.A_b);
  info.m_constraintError[0] = target;
  info.cfm[0] = cfm;
  info.m_lowerLimit[0] = -infinity;
  info.m_upperLimit[0] = infinity;
}

void GearModel::addRows(const PosePair& poses, Rows& rows) const {
  const State& state = *m_state;
  const GearReadings there = state.read({bodyA(), bodyB(), poses});
  if (!there.areFinite()) return;
  GearRow row;
  addTo(row, state.a, there.a, 1, bodyA(), bodyB(), state.dt);
  addTo(row, state.b, there.b, state.ratio, bodyA(), bodyB(), state.dt);
  const auto C = Scalar(
      state.error + state.weigh(state.a.nearestChange(there.a), state.b.nearestChange(there.b)));
  if (row.isPair() && isFinite(C + row.A_a.sum() + row.A_b.sum() + row.L_b.sum()))
    rows.addEquality(row.L_b, -row.A_a, row.A_b, C).max_speed = maxCorrection();
}

void GearModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<GearModel*>(this)->readFromBullet();
  if (!drawsFrames(drawer)) return;
  const btScalar size = gear().getDbgDrawSize();
  for (const GearSide* const side : {&m_state->a, &m_state->b}) {
    if (!(btFabs(side->factor()) > 0)) continue;
    const btVector3 x = side->place(), n = side->axis();
    btVector3 across, other;
    btPlaneSpace1(n, across, other);
    drawer.drawLine(x - n * size, x + n * size, limitColor());
    if (!side->isPosition())
      drawer.drawArc(x, n, across, size, size, 0, SIMD_2_PI, limitColor(), false);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
