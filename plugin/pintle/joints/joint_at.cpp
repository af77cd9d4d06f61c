#include <pintle/joints/joint.h>
#include <pintle/rows/row.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

void Joint::getInfo2At(btConstraintInfo2* info, const btTransform& pose_a,
                       const btTransform& pose_b) {
  const int announced = m_solver_row_count;
  if (pose_a == m_rbA.getCenterOfMassTransform() && pose_b == m_rbB.getCenterOfMassTransform())
    return Joint::getInfo2(info);
  m_rows.clear();
  const BodyPair pair(m_rbA, pose_a, m_rbB, pose_b);
  const StepMotion now = motion(pair);
  Rows rows(m_rows, now);
  if (pair.finite()) addRows(pair, rows);
  m_rows = rows;
  // Bullet has no room for more.
  m_rows.truncate(announced);
  placeRows(announced);
  Joint::getInfo2(info);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
