// SPDX-License-Identifier: Apache-2.0
// Balances launches on drivers that give each of their threads one contiguous part of a launch (lavapipe;
// docs/design/quirks.md): permutes the rows, so that each part has rows from the whole image.
#ifndef QUINTET_SPIRV_INTERLEAVE_ROWS_H
#define QUINTET_SPIRV_INTERLEAVE_ROWS_H

#include <cstdint>
#include <span>
#include <vector>

namespace quintet::spirv {

// True if the module uses LaunchId only in loads of the whole or of a component, which interleaveRows can rewrite, or not at all.
bool canInterleaveRows(std::span<const std::uint32_t> words);

// Returns the module with a permuted LaunchId: of H rows, row y of the driver becomes row (y mod q) * parts + y / q with
// q = H / parts (rounded down), and the last H mod parts rows keep their places. Columns and slices are unchanged. All modules of
// a pipeline must have the same `parts` (at least 1). Returns the words unchanged if canInterleaveRows is false, or if the module
// does not load LaunchId.
std::vector<std::uint32_t> interleaveRows(std::vector<std::uint32_t> words, std::uint32_t parts);

}  // namespace quintet::spirv
#endif
