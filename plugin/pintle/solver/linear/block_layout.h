// Purpose: how the 3 x 3 blocks of a matrix and of a vector lie in memory: column by column, a lane for each row and one of zeros.
#pragma once

#include <pintle/solver/linear/four_lanes.h>

#include <cstddef>

namespace pintle {
inline namespace PINTLE_PRECISION {

constexpr int block_size = 3;
/// From one block of a vector to the next, and from one column of a block to the next: what is left between is 0.
constexpr int block_stride = FourLanes::count;
static_assert(block_stride == block_size + 1, "row");
constexpr int block_area = block_size * block_stride;  ///< of a block: numbers

/// Of row `row` and column `column` of a block: where it is among its numbers. Blocks of the diagonal have both halves.
constexpr std::size_t inBlock(int row, int column) {
  return std::size_t(block_stride * column + row);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
