// Rows of a joint whose end of the step is known without asking it.
#include <pintle/solver/island_builder.h>

#include <pintle/solver/row_shapes.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

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
