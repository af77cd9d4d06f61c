#include <pintle/joints/joint.h>
#include <pintle/rows/row.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void Joint::writeRowsAt(Info2& info, const btTransform& pose_a, const btTransform& pose_b) {
  const int announced = m_solver_row_count;
  if (pose_a == bodyA().getCenterOfMassTransform() && pose_b == bodyB().getCenterOfMassTransform())
    return writeRows(info);
  m_rows.clear();
  const BodyPair pair(bodyA(), pose_a, bodyB(), pose_b);
  const StepMotion now = motion(pair);
  Rows rows(m_rows, now);
  if (pair.finite()) addRows(pair, rows);
  m_rows = rows;
  // Bullet has no room for more.
  m_rows.truncate(announced);
  placeRows(announced);
  writeRows(info);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
