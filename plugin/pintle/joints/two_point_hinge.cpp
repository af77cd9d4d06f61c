#include <pintle/joints/two_point_hinge.h>

#include <pintle/equations/two_point_hinge.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/hinge_rows.h>
#include <pintle/rows/position_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

// The axis of each body, and the unit vector half-way between both.
struct TwoPointHinge::Lines {
  equations::Anchors<Scalar> anchor;
  Vec3 c_a, c_b, h;
};

void TwoPointHinge::setPlacement(Placement placement, btScalar separation) {
  m_separation = positive("separation", separation);
  m_placement = placement;
}

inline equations::TwoPoints<Scalar> TwoPointHinge::points(const Lines& at) const {
  switch (m_placement) {
    case Placement::about_anchor: return equations::points_about_anchor(m_separation);
    case Placement::from_nearest_a:
      return equations::points_from_nearest(at.anchor.r_a, at.c_a, m_separation);
    case Placement::from_nearest_b: break;
  }
  return equations::points_from_nearest(at.anchor.r_b, at.c_b, m_separation);
}

void TwoPointHinge::drawJoint(btIDebugDraw& drawer) const {
  HingeModel::drawJoint(drawer);
  if (!drawsFrames(drawer)) return;
  const btMatrix3x3 &A = m_settings.frame_a.getBasis(), &B = m_settings.frame_b.getBasis();
  const auto column = [](const btMatrix3x3& m) -> Vec3 { return view(m.getColumn(2)); };
  const Vec3 none = Vec3::Zero();
  const auto to =
      points({{view(m_settings.frame_a.getOrigin()), view(m_settings.frame_b.getOrigin()), none},
              column(A),
              column(B),
              none});
  const auto draw = [&](const btRigidBody& body, const btTransform& frame, Scalar s) {
    const btTransform point(frame.getBasis(), frame(btVector3(0, 0, s)));
    drawer.drawTransform(body.getCenterOfMassTransform() * point, m_dbgDrawSize / 2);
  };
  for (const Scalar s : {to.s_1, to.s_2}) {
    draw(m_rbA, m_settings.frame_a, s);
    draw(m_rbB, m_settings.frame_b, s);
  }
}

inline void TwoPointHinge::constrain(const Observation& seen, Rows& rows) const {
  const auto swing = equations::swing(seen.c_a, seen.c_b);
  const Lines lines{seen.anchors(), seen.c_a, seen.c_b, swing.h};

  const int before = rows.size();
  if (m_settings.angular_only)
    addDirectionRows(lines, rows);
  else
    addPointRows(lines, rows);
  // c_b - c_a is 2 sin(swing/2) long: taken away at the rate k, the axes turn by 2 k tan(swing/2).
  const Vec3 apart = seen.c_b - seen.c_a;
  const Scalar tangent2 = apart.dot(apart) * swing.h_scale;
  if (tangent2 > 0) {
    const Scalar speed_per_error = getMaxCorrectionSpeed() / std::sqrt(tangent2);
    for (int i = before; i < rows.size(); ++i)
      rows[i].max_speed = speed_per_error * std::abs(rows[i].position);
  }
  addAxisRow(acting(seen, swing, rows), swing, rows);
}

inline void TwoPointHinge::addPointRows(const Lines& lines, Rows& rows) const {
  const auto to = points(lines);
  const equations::Anchors<Scalar>& anchor = lines.anchor;
  const auto point_1 = equations::point_on_axis(anchor, lines.c_a, lines.c_b, to.s_1);
  const auto point_2 = equations::point_on_axis(anchor, lines.c_a, lines.c_b, to.s_2);
  const bool document = getFormulation() == Formulation::document;
  if (m_six_rows) {
    for (const equations::Anchors<Scalar>& at : {point_1, point_2}) {
      if (document)
        addDocumentPositionRows(at, rows);
      else  // all of the gap: what the points say twice is not to contradict itself
        addConservingPositionRows(at, 1, rows);
    }
    return;
  }
  const auto add = [&](const equations::Anchors<Scalar>& at, std::initializer_list<Vec3> along) {
    const Vec3 curvature = document ? Vec3(Vec3::Zero()) : rows.curvature([&](const BodyPair& v) {
      return equations::position_curvature<Scalar>(v.w_a(), at.r_a + at.d, v.w_b(), at.r_b);
    });
    for (const Vec3& u : along) {
      const auto row =
          document ? equations::contact_row_world(u, at) : equations::contact_row(u, at);
      rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C, u.dot(curvature));
    }
  };
  const Vec3 &h = lines.h, p = any_tangent(h), q = cross(h, p);
  add(point_1, {p, q});
  add(anchor, {h});
  add(point_2, {p, q});
}

// Of two points only their difference, which has no linear part: that of the points' levers alone.
inline void TwoPointHinge::addDirectionRows(const Lines& lines, Rows& rows) const {
  const Vec3 &c_a = lines.c_a, &c_b = lines.c_b, &h = lines.h;
  const Vec3 curvature = rows.curvature([&](const BodyPair& v) {
    return equations::position_curvature<Scalar>(v.w_a(), c_b, v.w_b(), c_b);
  });
  const Vec3 p = any_tangent(h);
  for (const Vec3& u : {p, cross(h, p)}) {
    const auto row = equations::contact_row<Scalar>(u, {c_a, c_b, c_b - c_a});
    rows.addAngular(row.J.A_b, row.C, u.dot(curvature));
  }
}

template class ObservedJoint<TwoPointHinge, HingeModel>;
template class HingeOf<TwoPointHinge>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle
