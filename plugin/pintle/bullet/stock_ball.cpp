#include <pintle/bullet/stock_ball.h>

#include <pintle/bullet/private_member.h>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

namespace pintle {
namespace {

PINTLE_PRIVATE_MEMBER(BallFlags, int, btPoint2PointConstraint, m_flags);
PINTLE_PRIVATE_MEMBER(BallErp, btScalar, btPoint2PointConstraint, m_erp);
PINTLE_PRIVATE_MEMBER(BallCfm, btScalar, btPoint2PointConstraint, m_cfm);

}  // namespace

inline namespace PINTLE_PRECISION {

StockBall::StockBall(const btPoint2PointConstraint& ball) {
  const int flags = ball.*pointer(BallFlags());
  if (flags & BT_P2P_FLAGS_ERP) erp = {true, ball.*pointer(BallErp())};
  if (flags & BT_P2P_FLAGS_CFM) cfm = {true, ball.*pointer(BallCfm())};
}

void clearParameters(btPoint2PointConstraint& ball) {
  ball.*pointer(BallErp()) = ball.*pointer(BallCfm()) = 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
