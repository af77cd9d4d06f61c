#include <pintle/solver/bullet/row_shapes.h>

#include <pintle/solver/bullet/island_builder.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Half of the digits: what a body has turned for a while rounds some of them.
const double rounding_of_scalar = std::sqrt(double(std::numeric_limits<Scalar>::epsilon()));

// The lever r of a body, of which rows 0 and 1 of three along n have the moment A = r x n. Returns whether they do.
bool findLever(const Vector3d (&n)[3], const Vector3d (&A)[3], Vector3d& r) {
  const Vector3d across_0 = cross(n[0], A[0]),
                 across_1 = cross(n[1], A[1]);  // r without its part along n
  r = n[0].dot(across_1) * n[0] + n[1].dot(across_0) * n[1] +
      n[2].dot(across_0 + across_1) / 2 * n[2];
  const double size = A[0].norm() + A[1].norm();
  return (A[0] - cross(r, n[0])).norm() <= rounding_of_scalar * size &&
         (A[1] - cross(r, n[1])).norm() <= rounding_of_scalar * size;
}

// Laws of three rows at right angles become those of rows along the axes of the world: there factors hold bodies, and what they bear in one
// step is of the same directions in the next. Returns false, and changes nothing, where the three are not as soft and as driven.
bool turnToWorld(IslandRow* rows) {
  const double softness = rows[0].law.part(0).softness;
  Vector3d target(0, 0, 0), open(0, 0, 0);
  const bool drives = rows[0].law.part(0).drives;
  for (int i = 0; i < 3; ++i) {
    const LawPart& part = rows[i].law.part(0);
    if (part.softness != softness || part.drives != drives) return false;
    target += part.target * rows[i].J.L_b;
    open += rows[i].open * rows[i].J.L_b;
  }
  for (int i = 0; i < 3; ++i) {
    IslandRow& row = rows[i];
    row.law = AxisLaw();
    row.law.add({target[i], softness, -AxisLaw::unbounded, AxisLaw::unbounded, drives});
    row.open = open[i];
    if (row.isSoft()) row.extras->spring.open = open[i];
  }
  return true;
}

// C is a.b, of axes that turn with bodies a and b.
void setDot(IslandRow& row, const Vector3d& a, const Vector3d& b) {
  row.has_position = true;
  row.shape.kind = RowShape::dot;
  row.shape.a = a.cast<Scalar>();
  row.shape.b = b.cast<Scalar>();
}

}  // namespace

bool findPoint(IslandRow* rows) {
  for (int i = 0; i < 3; ++i) {
    const RowJacobian& J = rows[i].J;
    if (!rows[i].law.isEquality() || !(std::abs(J.L_b.squaredNorm() - 1) < rounding_of_scalar) ||
        !((J.L_a + J.L_b).norm() < rounding_of_scalar) ||
        !(std::abs(J.L_b.dot(rows[(i + 1) % 3].J.L_b)) < rounding_of_scalar))
      return false;
  }
  Vector3d r[2];
  bool found = false;
  for (int last = 2; last >= 0 && !found; --last) {
    Vector3d n[3], A_a[3], A_b[3];
    for (int k = 0; k < 3; ++k) {
      const RowJacobian& J = rows[(last + 1 + k) % 3].J;
      n[k] = J.L_b;
      A_a[k] = -J.A_a;
      A_b[k] = J.A_b;
    }
    found = findLever(n, A_a, r[0]) && findLever(n, A_b, r[1]);
  }
  if (!found) return false;
  const bool turns = turnToWorld(rows);
  for (int i = 0; i < 3; ++i) {
    IslandRow& row = rows[i];
    const Vector3d n = turns ? Vector3d(Vector3d::Unit(i)) : row.J.L_b;
    row.J = {-n, -cross(r[0], n), n, cross(r[1], n)};
    row.has_position = true;
    row.shape.kind = RowShape::point;
    row.shape.a = r[0].cast<Scalar>();
    row.shape.b = r[1].cast<Scalar>();
  }
  return true;
}

// Of axes p, q and h = p x q a turn by phi of b against a changes h_b . q_a by -p . phi, h_b . p_a by q . phi, h_a . q_b by p . phi,
// h_a . p_b by -q . phi, and p_b . q_a by h . phi. About h they may turn: so p and q are of the body that turns less.
bool findTurn(IslandRow* const* rows, int count, const Vector3d& w_a, const Vector3d& w_b) {
  Vector3d n[3];
  double size[3];
  for (int i = 0; i < count; ++i) {
    const RowJacobian& J = rows[i]->J;
    size[i] = J.A_b.norm();
    if (!(size[i] > 0) || !((J.A_a + J.A_b).norm() <= rounding_of_scalar * size[i])) return false;
    n[i] = J.A_b / size[i];
    for (int k = 0; k < i; ++k)
      if (!(std::abs(n[i].dot(n[k])) <= rounding_of_scalar)) return false;
  }
  const Vector3d h = cross(n[0], n[1]);
  const Vector3d p = size[0] * n[1], q = -size[1] * n[0];
  if (std::abs(w_a.dot(h)) <= std::abs(w_b.dot(h))) {
    setDot(*rows[0], -p, h);
    setDot(*rows[1], -q, h);
  } else {
    setDot(*rows[0], h, p);
    setDot(*rows[1], h, q);
  }
  if (count == 3) setDot(*rows[2], std::copysign(size[2], h.dot(n[2])) * n[1], n[0]);
  return true;
}

void setTurn(IslandRow& row) {
  const Vector3d n = row.J.A_b.unitOrthogonal();
  row.shape.kind = RowShape::turn;
  row.shape.a = row.shape.b = n.cast<Scalar>();
}

// Rows of a joint whose end of the step is known without asking it.

void IslandBuilder::findShapes(const IslandJoint& joint) {
  findAngles(joint);
  findTurns(joint);
}

// Of one that is open, what the joint says of its error is more than shapes do.
bool IslandBuilder::isClosed(const IslandRow& row) const {
  return row.start == nullptr ||
         std::abs(double(row.start->position)) <= m_options.contact_tolerance;
}

// The angle of a hinge, say, while two other rows hold its axis. (Where the axes are apart it is another one than two arms tell.)
void IslandBuilder::findAngles(const IslandJoint& joint) {
  IslandRow* const rows = m_island.rows.data() + joint.first_row;
  const auto holdsAxis = [&](const IslandRow& row) {
    return row.start != nullptr && !row.isOfAxis() && row.start->angular && row.law.isEquality() &&
           !(row.law.part(0).softness > 0) && isClosed(row);
  };
  for (IslandRow* row = rows; row < rows + joint.rows; ++row) {
    if (row->shape.kind != RowShape::turn) continue;
    if (std::count_if(rows, rows + joint.rows, holdsAxis) == 2)
      setTurn(*row);
    else
      row->shape.kind = RowShape::angle;
  }
}

void IslandBuilder::findTurns(const IslandJoint& joint) {
  IslandRow* const rows = m_island.rows.data() + joint.first_row;
  IslandRow* turns[3];
  int count = 0;
  for (IslandRow* row = rows; row < rows + joint.rows; ++row) {
    // Rows that a client adds to those of a joint of ours are no part of its turn.
    const bool is_added = joint.ours != nullptr && row->start == nullptr;
    if (row->shape.kind != RowShape::angle || !row->law.isEquality() || row->isOfAxis() || is_added)
      continue;
    if (count == 3 || !isClosed(*row)) return;
    turns[count++] = row;
  }
  if (count < 2) return;
  const auto turnOf = [&](int body) -> Vector3d {
    return m_island.velocity(body, &IslandBody::v_free).tail<3>();
  };
  findTurn(turns, count, turnOf(joint.body[0]), turnOf(joint.body[1]));
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
