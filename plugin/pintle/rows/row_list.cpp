#include <pintle/rows/row.h>

#include <memory>
#include <new>
#include <type_traits>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Axes come first, and nothing is to be destroyed but the memory.
static_assert(std::is_trivially_destructible<AxisState>::value);
static_assert(std::is_trivially_destructible<Row>::value);
static_assert(std::is_trivially_destructible<RowHistory>::value);
static_assert(alignof(RowHistory) <= alignof(Row));

RowList makeRows(RowCount room) {
  constexpr size_t step = alignof(Row);
  const size_t axes_size = (size_t(room.axes) * sizeof(AxisState) + step - 1) / step * step,
               rows_size = size_t(room.rows) * sizeof(Row),
               history_size = size_t(room.rows) * sizeof(RowHistory);
  char* memory = static_cast<char*>(::operator new(axes_size + rows_size + history_size));
  auto* axes = reinterpret_cast<AxisState*>(memory);
  auto* rows = reinterpret_cast<Row*>(memory + axes_size);
  auto* history = reinterpret_cast<RowHistory*>(memory + axes_size + rows_size);
  std::uninitialized_default_construct_n(axes, room.axes);
  std::uninitialized_default_construct_n(rows, room.rows);
  std::uninitialized_default_construct_n(history, room.rows);
  return {rows, axes, history, room};
}

void deleteRows(const RowList& rows) { ::operator delete(rows.m_axes); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
