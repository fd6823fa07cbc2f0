// SPDX-License-Identifier: Apache-2.0
// Decides which meshes of one coordinate system should share one acceleration structure, for drivers that traverse in software
// (Quirks::slowInstances). A ray enters the trees of all meshes whose boxes it crosses, so meshes that fill the same space
// (leaves and stems) are faster as one tree. A few large triangles among many small ones are slower in a tree of halves,
// because all leaves have the same depth there.
#ifndef QUINTET_RT_MERGE_CLUSTERS_H
#define QUINTET_RT_MERGE_CLUSTERS_H

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "rt/build_cost.h"

namespace quintet::rt {

// `meshes`: the bounds of the primitives of each mesh, finite; a mesh without any is never merged. To save time, the caller
// can pass every k-th primitive, with the same k for all meshes. Returns disjoint clusters of two or more meshes, each with
// ascending indices, whose expected cost of traversal as one tree is at least a tenth below that of separate trees.
std::vector<std::vector<std::uint32_t>> mergeClusters(std::span<const std::vector<Bounds3>> meshes,
                                                      TreeBuilder builder);

}  // namespace quintet::rt
#endif
