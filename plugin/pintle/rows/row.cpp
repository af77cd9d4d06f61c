#include <pintle/rows/row.h>

#include <algorithm>
#include <memory>
#include <new>
#include <type_traits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Nothing to destroy but the memory.
template <class T>
constexpr bool is_plain = std::is_trivially_destructible<T>::value;
static_assert(is_plain<Rows> && is_plain<Row> && is_plain<AxisState>);

// Where what follows so many objects may begin.
template <class T>
constexpr size_t room(int count) {
  constexpr size_t alignment = std::max({alignof(Rows), alignof(Row), alignof(AxisState)});
  return (size_t(count) * sizeof(T) + alignment - 1) / alignment * alignment;
}

}  // namespace

Rows& makeRows(int rows, int axes) {
  char* memory = static_cast<char*>(
      ::operator new(room<Rows>(1) + room<AxisState>(axes) + room<Row>(rows)));
  auto* first_axis = reinterpret_cast<AxisState*>(memory + room<Rows>(1));
  auto* first_row = reinterpret_cast<Row*>(memory + room<Rows>(1) + room<AxisState>(axes));
  std::uninitialized_default_construct_n(first_axis, axes);
  std::uninitialized_default_construct_n(first_row, rows);
  return *new (memory) Rows(first_row, rows, first_axis, axes);
}

void deleteRows(Rows& rows) { ::operator delete(&rows); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
