#include <pintle/joints/pose_drive_rows.h>

#include <pintle/equations/swing_twist.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/axis_part.h>
#include <pintle/rows/block.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// K of torques about the axes of the world: what a unit impulse about axis j adds to the angular velocity about axis i, b against a, while
// the equalities hold.
Mat3 inverseInertia(const BodyPair& pair, const Rows& rows, Scalar& unheld) {
  Block block(pair);
  for (int i = 0; i < rows.equalities(); ++i) block.add(rows[i]);
  BlockRow axes[3];
  unheld = 0;
  for (int i = 0; i < 3; ++i) {
    Row row;
    row.L = Vec3::Zero();
    row.A_a = row.A_b = Vec3::Unit(i);
    row.position = row.target = row.curvature = row.max_speed = 0;
    row.angular = true;
    Block::take(axes[i], row);
    block.weigh(axes[i]);
    unheld = btMax(unheld, axes[i].K);
    block.eliminate(axes[i], row);
    axes[i].angular = false;  // the rows that it was made orthogonal to need not be
    block.weigh(axes[i]);
  }
  Mat3 K;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Lanes products =
          axes[i].L * axes[j].WL + axes[i].A_a * axes[j].WA_a + axes[i].A_b * axes[j].WA_b;
      K(i, j) = products[0] + products[1] + products[2];
    }
  return (K + K.transpose()) / 2;
}

// Makes K diagonal by Jacobi's rotations (1846) of the axes u, from where these are: the axes of one step are near those of the last.
void diagonalize(Mat3& K, Mat3& u) {
  constexpr int sweeps = 6;  // their errors are squared in each
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const Scalar rounding = SIMD_EPSILON * (K(i, i) + K(j, j));
      if (!(btFabs(K(i, j)) > rounding)) continue;
      const Scalar cot = (K(j, j) - K(i, i)) / (2 * K(i, j));
      const Scalar t = (cot < 0 ? Scalar(-1) : Scalar(1)) / (btFabs(cot) + btSqrt(cot * cot + 1));
      const Scalar c = 1 / btSqrt(t * t + 1), s = t * c;
      Mat3 R = Mat3::Identity();
      R(i, i) = R(j, j) = c;
      R(i, j) = s;
      R(j, i) = -s;
      K = R.transpose() * K * R;
      u *= R;
    }
  }
}

}  // namespace

void PoseDriveRows::set(const btQuaternion& target, const PoseDrive& settings) {
  m_target = target;
  m_settings = settings;
  m_R.setRotation(target);
  m_step_begins = true;
  for (Axis& axis : m_axis) {
    axis.spring = settings.spring;
    axis.spring_drives = true;
  }
  m_is_on = true;
}

// At other poses in a step: that of its start, and what b has turned by against a since, as a carries it. So its mean velocity is that of
// the bodies, also where the shorter way to the target becomes the other one.
Vec3 PoseDriveRows::error(const Frame& a, const Frame& b) const {
  if (m_step_begins) return turnBetween(a.turned(m_R), b);
  const Mat3 A = a.axes(), unturned = A * m_start;
  const Vec3 turn = equations::orientation_error(unturned, b.axes());
  return m_start_error + m_start_a * (A.transpose() * turn);
}

Scalar PoseDriveRows::add(const Frame& a, const Frame& b, int first_axis, const BodyPair& pair,
                          Scalar dt, Scalar friction, Rows& rows) {
  const Vec3 phi = error(a, b);
  const btVector3& w = m_settings.target_velocity;
  const Vec3 target_velocity = a.axes() * Vec3(w.x(), w.y(), w.z());
  if (m_step_begins) {
    choose(phi, target_velocity, b, first_axis, pair, dt, rows);
    m_start_a = a.axes();
    m_start = m_start_a.transpose() * b.axes();
    m_start_error = phi;
    m_step_begins = false;
  }
  for (int i = 0; i < count; ++i) {
    if (!m_acts[i]) continue;
    m_axis[i].max_friction = friction;
    const Vec3 u = m_u.col(i);
    rows.addAngularAxis(first_axis + i, u, phi.dot(u), m_axis[i], false);
  }
  // A spring moves no further than to its rest.
  return phi.norm() + dt * target_velocity.norm();
}

void PoseDriveRows::choose(const Vec3& phi, const Vec3& target_velocity, const Frame& b,
                           int first_axis, const BodyPair& pair, Scalar dt, Rows& rows) {
  // About the axes of the last step.
  Vec3 last = Vec3::Zero(), disturbance = last, foreseen = last;
  for (int i = 0; i < count; ++i) {
    const AxisState& state = rows.axis(first_axis + i);
    const Vec3 u = m_u.col(i);
    last += (state.impulse[Axis::spring_pull] + state.impulse[Axis::spring_yield]) * u;
    disturbance += state.disturbance * u;
    foreseen += state.foreseen_disturbance * u;
  }

  Scalar unheld;
  Mat3 K = inverseInertia(pair, rows, unheld);
  const Mat3 frame = b.axes();
  m_u = frame * m_principal;
  K = Mat3(m_u.transpose() * K * m_u);
  diagonalize(K, m_u);
  if (!m_u.allFinite()) m_u = frame;
  m_u.col(0).normalize();
  m_u.col(1) = cross(Vec3(m_u.col(2)), Vec3(m_u.col(0))).normalized();
  m_u.col(2) = cross(Vec3(m_u.col(0)), Vec3(m_u.col(1)));
  m_principal = frame.transpose() * m_u;

  const Vec3 w = pair.w_b() - pair.w_a();
  Vec3 expected = Vec3::Zero();
  int free = 0;
  for (int i = 0; i < count; ++i) {
    Axis& axis = m_axis[i];
    const Vec3 u = m_u.col(i);
    m_acts[i] = K(i, i) > rounding_of_K * unheld;
    axis.max_servo_force = m_settings.max_torque;
    axis.motor_velocity = target_velocity.dot(u);
    if (!m_acts[i]) continue;
    ++free;
    AxisMotion motion;
    motion.position = phi.dot(u);
    motion.fps = 1 / dt;
    motion.K = K(i, i);
    const AxisRow row = ownSpringPart(axis, motion).row;
    // If what acts beside takes what it took of the last step's impulse.
    const Scalar free_velocity = w.dot(u) - K(i, i) * last.dot(u);
    expected += (row.target - free_velocity) / ((1 + row.cfm) * K(i, i)) * u;
  }
  if (m_settings.max_torque < infinity && free > 0) boundLength(expected, free, dt);
  for (int i = 0; i < count; ++i) {
    const Vec3 u = m_u.col(i);
    AxisState& state = rows.axis(first_axis + i);
    m_axis[i].motor_velocity = target_velocity.dot(u);
    state.disturbance = disturbance.dot(u);
    state.foreseen_disturbance = foreseen.dot(u);
  }
}

void PoseDriveRows::boundLength(const Vec3& expected, int free, Scalar dt) {
  const Scalar T = m_settings.max_torque;
  const Scalar cube = 1 / btSqrt(Scalar(free)), size = expected.norm();
  const Scalar part = size < T * dt ? size / (T * dt) : Scalar(1);  // also NaN, and T = 0
  const Scalar along = free > 1 ? btMax(cube, btMin((1 + part) / 2, max_part_along)) : Scalar(1);
  const Scalar across =
      free > 1 ? btSqrt(btMax(Scalar(0), 1 - along * along) / Scalar(free - 1)) : Scalar(0);
  int longest = -1;
  for (int i = 0; i < count; ++i)
    if (m_acts[i] &&
        (longest < 0 || btFabs(expected.dot(m_u.col(i))) > btFabs(expected.dot(m_u.col(longest)))))
      longest = i;
  if (along > cube && size > 0 && size < infinity) {
    // The shortest rotation of all axes that takes the nearest of them there.
    const Vec3 from = m_u.col(longest);
    const Vec3 to = expected / (from.dot(expected) < 0 ? -size : size);
    const auto q = equations::shortest_rotation(from, to);
    for (int i = 0; i < count; ++i)
      if (i != longest) m_u.col(i) = equations::rotate(q, Vec3(m_u.col(i)));
    m_u.col(longest) = to;
  }
  for (int i = 0; i < count; ++i) m_axis[i].max_servo_force = T * (i == longest ? along : across);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
