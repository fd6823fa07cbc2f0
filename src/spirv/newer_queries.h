// SPDX-License-Identifier: Apache-2.0
// Queries of extensions that SPIRV-Tools 2023.1 does not know (position fetch of ray queries, clusters, spheres, linear swept
// spheres), as instructions that it knows. The analyses need their types and what they depend on, not their values.
#ifndef QUINTET_SPIRV_NEWER_QUERIES_H
#define QUINTET_SPIRV_NEWER_QUERIES_H

#include <cstdint>
#include <span>
#include <vector>

namespace quintet::spirv {

// Returns a copy in which such a query is replaced by a known one of the same hit and type. Hit objects must be those of the NV
// extension (reorder_code.h). Words that cannot be read as instructions are copied.
std::vector<std::uint32_t> withKnownQueries(std::span<const std::uint32_t> words);

}  // namespace quintet::spirv
#endif
