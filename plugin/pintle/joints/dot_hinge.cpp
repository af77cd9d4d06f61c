#include <pintle/joints/dot_hinge.h>

#include <pintle/equations/dot.h>
#include <pintle/equations/dot_hinge.h>
#include <pintle/equations/position.h>
#include <pintle/joints/hinge_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

inline void DotHinge::constrain(const Observation& seen, Rows& rows) const {
  const Vec3 &c_a = seen.c_a, &c_b = seen.c_b, x = cross(c_a, c_b);
  // Along the error the rows turn 1/cos(swing) times as fast as they say.
  const Scalar sine = std::sqrt(x.dot(x));
  const Scalar speed_per_error =
      sine > 0 ? getMaxCorrectionSpeed() * std::abs(c_a.dot(c_b)) / sine : Scalar(0);
  const Vec3 acceleration = rows.curvature([&](const BodyPair& v) {
    return Vec3(equations::dot_acceleration<Scalar>(c_a, v.w_a(), v.w_b()));
  });
  for (const Vec3& tangent : {seen.b.a(), seen.b.b()}) {
    const auto row = equations::dot_hinge_row(c_a, tangent);
    rows.addAngular(row.J_b, row.C, tangent.dot(acceleration)).max_speed =
        speed_per_error * std::abs(row.C);
    rows.shape(RowShape::dot, c_a, tangent);
  }
  addPivotRows(seen.anchors(), rows);
  if (!m_settings.axis.driven() && !m_settings.axis.limited()) return;
  const auto swing = equations::swing(c_a, c_b);
  addAxisRow(acting(seen, swing, rows), swing, rows);
}

template class ObservedJoint<DotHinge, HingeModel>;
template class HingeOf<DotHinge>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
