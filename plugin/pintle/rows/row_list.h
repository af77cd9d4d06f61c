// Purpose: the rows of a joint as its base keeps them, which says nothing of what a row is: row.h does.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct AxisState;
struct Row;
struct RowHistory;

/// How many rows a joint may have, and how many of its axes: its free coordinates along which something can act.
struct RowCount {
  int rows, axes = 0;
};

/// The rows of one joint in this step, and what it remembers of its axes. Equalities come first.
class RowList {
 public:
  RowList(Row* rows, AxisState* axes, RowHistory* history, RowCount room)
      : m_rows(rows),
        m_axes(axes),
        m_history(history),
        m_capacity(static_cast<signed char>(room.rows)),
        m_axis_count(static_cast<signed char>(room.axes)) {}

  int size() const { return m_size; }
  int equalities() const { return m_size - m_axis_rows; }
  Row& operator[](int i);
  const Row& operator[](int i) const;
  int axisCount() const { return m_axis_count; }
  AxisState& axis(int i);
  const AxisState& axis(int i) const;
  RowHistory& history(int i);
  const RowHistory& history(int i) const;
  void clear() { m_size = m_axis_rows = 0; }
  /// Leaves out what comes after the first n.
  void truncate(int n) {
    if (m_size <= n) return;
    const int left = equalities() < n ? equalities() : n;
    m_size = n;
    m_axis_rows = static_cast<signed char>(n - left);
  }

 protected:
  friend void deleteRows(const RowList& rows);

  Row* m_rows;
  AxisState* m_axes;
  RowHistory* m_history;  ///< null: rows of a pose, which no solver sees
  int m_size = 0;
  signed char m_axis_rows = 0;
  [[maybe_unused]] signed char m_capacity;  ///< only assertions look at it
  signed char m_axis_count;
};

/// Memory for so many, in one piece.
RowList makeRows(RowCount room);
void deleteRows(const RowList& rows);

}  // namespace PINTLE_PRECISION
}  // namespace pintle
