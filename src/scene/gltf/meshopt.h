// SPDX-License-Identifier: Apache-2.0
// What KHR_meshopt_compression adds to EXT_meshopt_compression: version 1 of the vertex codec and the filter COLOR. Debian's
// meshoptimizer (0.18) has neither.
#ifndef QUINTET_SCENE_GLTF_MESHOPT_H
#define QUINTET_SCENE_GLTF_MESHOPT_H

#include <cstddef>
#include <span>

namespace quintet::scene {

// Whether the stream has version 1 of the vertex codec.
bool isMeshoptVersion1(std::span<const std::byte> stream);

// Decodes elements of `stride` bytes, a multiple of 4 of at most 256. Returns false if the stream is not valid.
bool decodeMeshoptVersion1(std::span<std::byte> elements, std::size_t stride, std::span<const std::byte> stream);

// Converts colors in YCoCg to RGBA: four components of 1 (stride 4) or 2 bytes (stride 8).
void decodeMeshoptColors(std::span<std::byte> elements, std::size_t stride);

}  // namespace quintet::scene
#endif
