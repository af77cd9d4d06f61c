#include <pintle/solver/bullet/island_builder.h>

#include <pintle/joint_rows.h>
#include <pintle/joints/gear_row.h>
#include <pintle/solver/bullet/joint_access.h>
#include <pintle/solver/bullet/row_shapes.h>
#include <pintle/solver/constants.h>
#include <pintle/solver/model/inverse_inertia.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr double pose_tolerance = SolverOptions().loose_pose_tolerance;
constexpr double least_share =
    std::max(double(std::numeric_limits<Scalar>::epsilon()), pose_tolerance* pose_tolerance);
constexpr int unknown = std::numeric_limits<int>::min();

// Bounds of Bullet's, and of ours, that mean none.
double bounded(Scalar impulse) {
  if (!(impulse < infinity)) return AxisLaw::unbounded;
  if (!(impulse > -infinity)) return -AxisLaw::unbounded;
  return double(impulse);
}

}  // namespace

void IslandBuilder::begin(const btContactSolverInfo& info) {
  m_info = info;
  m_island.dt = double(info.m_timeStep);
  m_island.bodies.clear();
  m_island.unmoved_bodies.assign(1, {Vector6d::Zero(), 0});
  m_island.joints.clear();
  m_island.rows.clear();
  m_island.extras.clear();
  m_body_of.clear();
  m_has_springs = false;
}

int IslandBuilder::body(const SolverBodies& bodies, int number) {
  const btSolverBody& from = bodies[number];
  if (from.m_originalBody == nullptr) return Island::unmoved(Island::at_rest);
  if (m_body_of.size() <= size_t(number)) m_body_of.resize(size_t(bodies.size()), unknown);
  int& known = m_body_of[size_t(number)];
  if (known != unknown) return known;
  const btRigidBody& rigid = *from.m_originalBody;
  // Bullet moves no kinematic body, whatever its mass.
  if (!(rigid.getInvMass() > 0) || rigid.isKinematicObject()) return known = unmoved(from);
  known = int(m_island.bodies.size());
  IslandBody& to = m_island.bodies.emplace_back();
  to.body = &rigid;
  to.solver_body = number;
  to.start = from.m_worldTransform;
  const btVector3 &linear = rigid.getLinearFactor(), &angular = rigid.getAngularFactor();
  to.mass = 1 / double(rigid.getInvMass());
  const Matrix3d R = inDouble(to.start.getBasis());
  const Vector3d inverse = inDouble(rigid.getInvInertiaDiagLocal());
  const double largest = inverse.maxCoeff();
  bool turns = largest > 0;
  // An axis about which the body does not turn at all, while it does about others.
  const Vector3d principal =
      inverse.unaryExpr([&](double i) { return i > 0 ? 1 / i : unturned_inertia / largest; });
  to.inertia = turns ? Matrix3d(R * principal.asDiagonal() * R.transpose()) : Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) {
    to.locked[size_t(i)] = !(linear[i] > 0);
    to.inverse_mass[i] = linear[i] > 0 ? double(rigid.getInvMass()) : 0;
    to.locked[size_t(3 + i)] = !turns || !(angular[i] > 0);
  }
  to.follows = turns && inverse.minCoeff() > 0 &&
               std::none_of(to.locked.begin(), to.locked.end(), [](bool is) { return is; });
  to.inverse_inertia = inverseWhereFree(to, to.inertia);
  to.scale[0] = std::sqrt(to.mass);
  to.scale[1] = std::sqrt(to.inertia.trace() / 3);
  to.inverse_scale2[0] = double(rigid.getInvMass());
  to.inverse_scale2[1] = 3 / to.inertia.trace();
  to.least_inertia = turns ? principal.minCoeff() : 1;
  to.v0 << inDouble(from.m_linearVelocity), inDouble(from.m_angularVelocity);
  to.v_free = freeVelocity(from);
  to.by_forces = to.v_free - to.v0;
  to.gyroscopic_work = 0;
  to.acts_in_halves = false;
  if (isGyroscopic(rigid)) {
    to.by_forces.tail<3>() = m_island.dt * (to.inverse_inertia * inDouble(rigid.getTotalTorque()));
    const Vector6d gyroscopic = to.v_free - to.v0 - to.by_forces;
    to.gyroscopic_work = to.product(gyroscopic, 2 * to.v0 + gyroscopic) / 2;
  }
  to.push.setZero();
  return known;
}

int IslandBuilder::unmoved(const btSolverBody& from) {
  const btVector3 &v = from.m_linearVelocity, &w = from.m_angularVelocity;
  if (v.isZero() && w.isZero()) return Island::unmoved(Island::at_rest);
  Vector6d velocity;
  velocity << inDouble(v), inDouble(w);
  m_island.unmoved_bodies.emplace_back(velocity, m_island.dt);
  return Island::unmoved(int(m_island.unmoved_bodies.size()) - 1);
}

// J M^-1 J^T less what the equalities hold of it, by Cholesky's factor of their own; those that repeat others are left out.
double IslandBuilder::inverseMassBeside(const IslandJoint& joint, const RowJacobian& J) const {
  double L[most_stock_rows][most_stock_rows], y[most_stock_rows];
  const IslandRow* equality[most_stock_rows];
  const double own = m_island.inverseMass(joint, J, J);
  double rest = own;
  int n = 0;
  for (int i = 0; i < joint.rows; ++i) {
    const IslandRow& row = m_island.rows[size_t(joint.first_row + i)];
    if (!row.law.isEquality() || n == most_stock_rows) continue;
    double pivot = row.K;
    for (int j = 0; j < n; ++j) {
      double sum = m_island.inverseMass(joint, row.J, equality[j]->J);
      for (int k = 0; k < j; ++k) sum -= L[n][k] * L[j][k];
      L[n][j] = sum / L[j][j];
      pivot -= L[n][j] * L[n][j];
    }
    if (!(pivot > rounding_share * row.K)) continue;
    L[n][n] = std::sqrt(pivot);
    y[n] = m_island.inverseMass(joint, row.J, J);
    for (int j = 0; j < n; ++j) y[n] -= L[n][j] * y[j];
    y[n] /= L[n][n];
    rest -= y[n] * y[n];
    equality[n++] = &row;
  }
  // Where they hold all of it but rounding, a spring has no mass to move but its own.
  return rest > rounding_share * own ? rest : own;
}

// A row that its bodies can follow by rounding alone is none: of what K would be if their factors held nothing. Nor is one that they
// follow by a part of its direction, of which K is the square, that is no more than poses are off: for next to nothing they would go far.
bool IslandBuilder::keepRow(IslandJoint& to, IslandRow& row) {
  double unlocked = 0;  // by the mean inertia
  for (int side = 0; side < 2; ++side)
    if (const int body = to.body[size_t(side)]; body >= 0) {
      const IslandBody& of = m_island.bodies[size_t(body)];
      if (!of.follows)
        unlocked += row.J.L(side).squaredNorm() * of.inverse_scale2[0] +
                    row.J.A(side).squaredNorm() * of.inverse_scale2[1];
    }
  if (!(row.K > least_share * unlocked) || !(row.K < AxisLaw::unbounded) || row.law.parts() == 0)
    return false;
  row.setK(row.K);
  to.add(row);
  m_has_springs = m_has_springs || (row.extras != nullptr && springs(row.law) > 0);
  return true;
}

void IslandBuilder::addOurs(IslandJoint& to, double rate) {
  Joint& joint = *to.ours;
  const BodyPair pair(joint.constraint().getRigidBodyA(), joint.constraint().getRigidBodyB());
  const RowList& rows = JointAccess::begin(joint, pair, m_info.m_timeStep, m_shapes.data());
  to.equalities = rows.equalities();
  EqualitySettings settings = {-1, 0, 0, 0, 0};
  for (int i = 0; i < rows.size(); ++i) {
    IslandRow& row = newRow();
    row.start = &rows[i];
    row.shape = m_shapes[size_t(i)];
    row.has_position = true;
    row.index = i;
    const bool is_axis = rows[i].axis >= 0;
    if (is_axis) row.sign = JointAccess::axis(joint, rows[i]).sign;
    row.J = jacobianOf(rows[i], row.sign);
    row.K = m_island.inverseMass(to, row.J, row.J);
    row.spins = is_axis && row.isOfAngle() &&
                std::abs(velocityAlong(to, row.J, &IslandBody::v_free)) * m_island.dt > pi;
    if (is_axis) {
      setAxisLaw(to, pair, row);
    } else {
      if (settings.group != rows[i].group) settings = settingsOf(joint, rows[i].group);
      setEqualityLaw(to, settings, {double(rows[i].position), double(rows[i].max_speed), rate},
                     row);
    }
    if (!keepRow(to, row)) m_island.rows.pop_back();
  }
}

double IslandBuilder::velocityAlong(const IslandJoint& of, const RowJacobian& J,
                                    Vector6d IslandBody::*v) const {
  return J.along(m_island.velocity(of.body[0], v), m_island.velocity(of.body[1], v));
}

IslandBuilder::EqualitySettings IslandBuilder::settingsOf(const Joint& joint, int group) const {
  const auto soft = JointAccess::softness(joint, group, m_info);
  const ImpulseSetting setting = JointAccess::setting(joint);
  const double bound = bounded(setting.max_impulse);
  const Scalar erp = bound < AxisLaw::unbounded ? soft.erp
                     : soft.own_erp             ? btMin(soft.erp, Scalar(1))
                                                : m_info.m_erp;
  return {group, double(erp), double(soft.cfm), bound, 1 - double(setting.damping)};
}

void IslandBuilder::setEqualityLaw(const IslandJoint& of, const EqualitySettings& settings,
                                   const EqualityState& state, IslandRow& row) const {
  const auto& [group, erp, cfm, bound, left] = settings;
  const auto& [position, max_speed, rate] = state;
  double target = left != 0 ? left * velocityAlong(of, row.J, &IslandBody::v_free) : 0;
  target -= rate;
  if (bound < AxisLaw::unbounded) {
    target -= erp * position / m_island.dt;
    return row.law.add({target, cfm * row.K, -bound, bound, true, false, Axis::parts});
  }
  // Bullet's correction is a velocity, of which the next steps leave so much, too.
  row.open = closing(left > 0 ? std::fmin(1, erp / (1 - left)) : erp, position, max_speed);
  // In double precision that little is what the last solve has left. In single precision it is rounding, with which bodies would shake.
  constexpr bool is_exact = sizeof(Scalar) > 4;
  if (cfm > 0) {
    m_island.giveExtras(row).spring = {erp, row.open, 0};
  } else if (is_exact && std::abs(row.open) <= m_options.pose_tolerance) {
    target -= row.open / m_island.dt;
    row.open = 0;
  }
  // A row that others move is driven by them.
  row.law.add({target, cfm * row.K, -AxisLaw::unbounded, AxisLaw::unbounded, rate != 0});
}

void IslandBuilder::addGear(IslandJoint& to) {
  Joint& joint = *to.ours;
  const GearRow* const from = JointAccess::beginGear(joint, m_info.m_timeStep);
  if (from == nullptr) return;
  if (from->isPair()) return addOurs(to, double(from->rate));
  to.ours = nullptr;  // as a row of Bullet's
  IslandRow& row = newRow();
  row.has_position = false;
  row.index = 0;
  // Bullet's sign of an impulse is the other one.
  const auto of = [](const Vec3& v) -> Vector3d { return -v.cast<double>(); };
  row.J = {of(from->L_a), of(from->A_a), of(from->L_b), of(from->A_b)};
  row.K = m_island.inverseMass(to, row.J, row.J);
  setEqualityLaw(to, settingsOf(joint, 0),
                 {-double(from->position), double(from->max_speed), -double(from->rate)}, row);
  if (!keepRow(to, row)) return m_island.rows.pop_back();
  to.equalities = to.rows;
}

void IslandBuilder::setAxisLaw(const IslandJoint& of, const BodyPair& pair, IslandRow& row) const {
  AxisState& state = JointAccess::axis(*of.ours, *row.start);
  const Axis& axis = *state.axis;
  AxisMotion motion = JointAccess::motion(
      *of.ours, *row.start, state, pair, Scalar(velocityAlong(of, row.J, &IslandBody::v0)), m_info);
  state.acted = true;
  state.incoming = 0;
  RowExtras& extras = m_island.giveExtras(row);
  row.law = AxisLaw(extras.parts);
  extras.rebound_energy = double(state.taken);  // a rebound may give it back
  state.taken = 0;
  state.row.fill(-1);
  double K_beside = -1;
  const auto addPart = [&](const AxisPart& part, Axis::Part role, const Spring* spring) {
    if (!part.on) return;
    double softness = double(part.row.cfm);
    if (softness > 0) {
      if (K_beside < 0) K_beside = inverseMassBeside(of, row.J);
      softness *= role == Axis::limit ? JointAccess::keptK(state, K_beside) : K_beside;
    }
    const double of_spring = spring != nullptr && softness > 0
                                 ? double(softnessOf(*spring, m_info.m_timeStep, 1).beta)
                                 : 0;
    row.law.add({double(part.row.target), softness, bounded(part.row.lower),
                 bounded(part.row.upper), true, false, role, of_spring});
  };
  if (axis.spring.isSet() || axis.limit_spring.hasUnits() || axis.servo_spring.hasUnits()) {
    K_beside = inverseMassBeside(of, row.J);
    motion.K = Scalar(K_beside);
  }
  // Implicit at any stiffness, also where a step would resolve it.
  if (axis.spring.isSet()) addPart(ownSpringPart(axis, motion), Axis::spring_pull, nullptr);
  if (axis.max_friction > 0) addPart(frictionPart(axis, motion), Axis::friction, nullptr);
  if (axis.drive != Axis::Drive::off)
    addPart(motorPart(axis, motion), Axis::motor,
            axis.drive == Axis::Drive::servo ? &axis.servo_spring : nullptr);
  // What is asked of its velocity alone need not be a coordinate: friction about any axis of the world, and the like.
  row.has_position = row.start->limit || axis.drive == Axis::Drive::servo ||
                     axis.drive == Axis::Drive::approach || axis.drive == Axis::Drive::pose ||
                     axis.spring.isSet();
  if (!row.start->limit || !axis.limited()) return;
  if (axis.hasLimitSpring())
    addPart(limitPart(axis, motion, state.incoming), Axis::limit,
            axis.locked() ? &axis.limit_spring : nullptr);
  else
    addLimit(of, axis, motion, state, row);
}

// ERP of it, and what is left in the end at once: a part of that would be less than poses are corrected by.
double IslandBuilder::closing(double erp, double error, double max_speed) const {
  if (!(erp > 0)) return 0;
  const double size = std::abs(error),
               part = std::max(erp * size, std::min(size, 2 * m_options.pose_tolerance));
  return std::copysign(std::min(part, max_speed * m_island.dt), error);
}

// Beyond a limit no further, or as a spring gives (RowSpring), and back by moving poses; inside up to it.
void IslandBuilder::addLimit(const IslandJoint& of, const Axis& axis, const AxisMotion& motion,
                             AxisState& state, IslandRow& row) const {
  const double q = double(row.start->position), low = double(axis.low), high = double(axis.high);
  const double dt = m_island.dt;
  const NearLimit limit(axis, motion);
  const bool is_beyond = axis.locked() || limit.gap < 0;
  row.open = is_beyond ? closing(double(motion.limit_erp), q - (limit.at_low ? low : high),
                                 double(motion.max_speed))
                       : 0;
  const auto add = [&](double target, double lower, double upper, bool gives) {
    if (gives)
      row.extras->spring = {std::fmin(double(motion.limit_erp), 1), row.open, 0, row.law.parts()};
    const double softness = gives ? double(motion.limit_cfm) * inverseMassBeside(of, row.J) : 0;
    row.law.add({target, softness, lower, upper, false, gives && !axis.locked(), Axis::limit});
  };
  bool gives =
      motion.limit_cfm > 0 && (axis.locked() || double(limit.gap) <= m_options.pose_tolerance);
  if (axis.locked()) {
    add(0, -AxisLaw::unbounded, AxisLaw::unbounded, gives);
    return;
  }
  // It stops at the limit, and rebounds in the next step. What gives sends back what it was pressed by.
  double up = std::fmin((low - q) / dt, 0), down = std::fmax((high - q) / dt, 0);
  const double rebound =
      !gives || motion.incoming > 0 ? double(reboundSpeed(axis, motion, limit)) : 0;
  if (rebound > 0) {
    gives = false;
    (limit.at_low ? up : down) = double(limit.side) * rebound;
  } else if (limit.gap > 0) {
    state.incoming = btMax(Scalar(0), -limit.inward);
    row.extras->keeps_for_rebound = state.incoming > 0 && axis.bias * axis.relaxation > 0;
  }
  if (low > -double(infinity)) add(up, 0, AxisLaw::unbounded, gives && limit.at_low);
  if (high < double(infinity)) add(down, -AxisLaw::unbounded, 0, gives && !limit.at_low);
  // The angle about an axis bends no more than its bodies turn. That to a cone does, about its tip.
  row.has_stops_alone = !row.isSoft() && row.start->angular && of.equalities == 5 &&
                        axis.drive != Axis::Drive::servo && axis.drive != Axis::Drive::pose &&
                        !axis.spring.isSet();
}

/// Rows of a joint as Bullet has them. m_rhs is their target, without what closes them.
struct IslandBuilder::StockRows {
  int count = 0;
  btSolverConstraint rows[most_stock_rows];
  Scalar closing[most_stock_rows];  ///< m/s or rad/s: a velocity that is to move poses alone

  /// `max_speed`: rad/s, of rows that are angular.
  void limitClosing(Scalar max_speed) {
    for (int i = 0; i < count; ++i) {
      if (!rows[i].m_contactNormal2.isZero()) continue;
      const Scalar most = max_speed * rows[i].m_relpos2CrossNormal.length();
      btClamp(closing[i], -most, most);
    }
  }
};

void IslandBuilder::askStock(btTypedConstraint& joint, const btSolverBody& a, const btSolverBody& b,
                             StockRows& to) const {
  btTypedConstraint::btConstraintInfo1 size;
  joint.getInfo1(&size);
  const int count = size.m_numConstraintRows;  // all of which it writes
  if (count <= 0 || count > most_stock_rows) return;
  to.count = count;
  btSolverConstraint* const rows = to.rows;
  Scalar* const closing = to.closing;
  btSolverConstraint at_twice_the_rate[most_stock_rows];
  const Scalar fps = 1 / m_info.m_timeStep;
  const auto ask = [&](Scalar rate, btSolverConstraint* answer) {
    return askRows(
        joint, {rate, m_info.m_erp, m_info.m_globalCfm, m_info.m_damping, m_info.m_numIterations},
        answer, count);
  };
  ask(2 * fps, at_twice_the_rate);
  const Scalar damping = ask(fps, rows);
  // What grows with the rate of the steps closes what is open, with the ERP that the joint has for it. Not of a motor: where it
  // cannot do all, it does what it can. And of a stop that is not reached yet it is the way that is left to it.
  for (int i = 0; i < count; ++i) {
    const bool can_push = rows[i].m_upperLimit >= infinity,
               can_pull = rows[i].m_lowerLimit <= -infinity;
    const Scalar rhs = rows[i].m_rhs;
    closing[i] = at_twice_the_rate[i].m_rhs - rhs;
    if (can_push && can_pull) {
      rows[i].m_rhs -= closing[i];
      continue;
    }
    closing[i] = can_push   ? btMax(Scalar(0), btMin(closing[i], rhs))
                 : can_pull ? btMin(Scalar(0), btMax(closing[i], rhs))
                            : 0;
    rows[i].m_rhs -= closing[i];
  }
  completeTargets(rows, count, joint, damping, a, b);
}

void IslandBuilder::addStock(IslandJoint& to, const StockRows& rows, int first) {
  const int before = to.rows;
  const auto fps = double(1 / m_info.m_timeStep);
  for (int i = first; i < rows.count; ++i) {
    const btSolverConstraint& from = rows.rows[i];
    IslandRow& row = newRow();
    row.has_position = false;
    row.index = i;
    // Bullet's sign of an impulse is the other one.
    row.J = {-inDouble(from.m_contactNormal1), -inDouble(from.m_relpos1CrossNormal),
             -inDouble(from.m_contactNormal2), -inDouble(from.m_relpos2CrossNormal)};
    if (row.J.L_b.isZero(0)) row.shape.kind = RowShape::angle;
    const double lower = bounded(from.m_lowerLimit), upper = bounded(from.m_upperLimit);
    // Bounded both ways, or with a velocity of its own: a motor. What is bounded on one side is a stop.
    LawPart part{-double(from.m_rhs), double(from.m_cfm) * fps, -upper, -lower};
    if (part.isLowerStop() || part.isUpperStop()) part.role = Axis::limit;
    part.drives = !part.isLowerStop() && !part.isUpperStop() &&
                  (from.m_rhs != 0 || (lower > -AxisLaw::unbounded && upper < AxisLaw::unbounded));
    row.law.add(part);
    row.open = double(rows.closing[i]) * m_island.dt;
    // Bullet has a row for a stop while it is passed alone: one that closed all of it would fall in the next step.
    if (part.role == Axis::limit)
      row.open = std::copysign(std::max(std::abs(row.open) - m_options.loose_pose_tolerance, 0.),
                               row.open);
    if (from.m_cfm > 0 && row.law.isEquality())
      m_island.giveExtras(row).spring = {double(m_info.m_erp), row.open, 0};
  }
  // A point is found before rows that factors lock are left out. Rows of angles may come before it.
  IslandRow* const all = m_island.rows.data() + to.first_row;
  IslandRow *const begin = all + before, *const end = m_island.rows.data() + m_island.rows.size();
  for (IslandRow* row = begin; row + 3 <= end; ++row)
    if (findPoint(row)) break;
  for (IslandRow* row = begin; row < end; ++row) {
    row->K = m_island.inverseMass(to, row->J, row->J);
    if (!keepRow(to, *row)) continue;
    all[to.rows - 1] = *row;
    // Those that come first stay where stops come and go. (Of a joint of ours they are those of its base.)
    if (to.ours == nullptr && row->law.isEquality() && to.equalities == to.rows - 1)
      ++to.equalities;
  }
  m_island.rows.resize(size_t(to.first_row + to.rows));
}

// Rows that a client's type adds come after those of its base. Where it changes these, all are as Bullet has them.
void IslandBuilder::addClients(IslandJoint& to, const btSolverBody& a, const btSolverBody& b) {
  Joint& joint = *to.ours;
  const ClientRows its = findClientRows(joint, m_info);
  if (!its.changes_base && !its.adds_rows) return addOurs(to);
  StockRows rows;
  if (its.changes_base) {
    const JointAccess::PlainRows plain(joint);
    askStock(joint.constraint(), a, b, rows);
    rows.limitClosing(joint.getMaxCorrectionSpeed());
    to.ours = nullptr;
    return addStock(to, rows, 0);
  }
  {
    const JointAccess::PlainRows plain(joint);
    const JointAccess::KeptAxes kept(joint);
    askStock(joint.constraint(), a, b, rows);
  }
  addOurs(to);  // and then its memory holds the rows of its base
  addStock(to, rows, its.of_base);
}

void IslandBuilder::add(btTypedConstraint& joint, Joint* upgraded, const SolverBodies& bodies,
                        int solver_body_a, int solver_body_b) {
  if (&joint.getRigidBodyA() == &joint.getRigidBodyB()) return;  // it holds nothing
  IslandJoint& to = m_island.joints.emplace_back();
  to.constraint = &joint;
  to.body = {body(bodies, solver_body_a), body(bodies, solver_body_b)};
  to.first_row = int(m_island.rows.size());
  to.ours = upgraded != nullptr ? upgraded : JointAccess::ours(joint);
  const btSolverBody &a = bodies[solver_body_a], &b = bodies[solver_body_b];
  const bool is_clients =
      upgraded == nullptr && to.ours != nullptr && JointAccess::mayHaveOtherRows(joint);
  const bool is_gear = to.ours != nullptr && JointAccess::isGear(joint, *to.ours);
  if (is_gear && is_clients) to.ours = nullptr;
  if (to.ours == nullptr) {
    StockRows rows;
    askStock(joint, a, b, rows);
    addStock(to, rows, 0);
  } else if (is_gear) {
    addGear(to);
  } else if (is_clients) {
    addClients(to, a, b);
  } else {
    addOurs(to);
  }
  if (to.rows == 0) {
    m_island.joints.pop_back();
    return;
  }
  findShapes(to);
  to.finishShapes(&m_island.rows[size_t(to.first_row)]);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
