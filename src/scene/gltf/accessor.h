// SPDX-License-Identifier: Apache-2.0
// Buffer views and accessors: their bounds checks, and accessors as vectors of floats or indices with strides,
// component types, normalized integers and sparse data (glTF 2.0 sections 3.6.2 and 3.11). Elements are converted in
// bulk. Misaligned data is accepted.
#ifndef QUINTET_SCENE_GLTF_ACCESSOR_H
#define QUINTET_SCENE_GLTF_ACCESSOR_H

#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/gltf/document.h"

namespace quintet::scene {

// Fills Document::bufferViews, used or not: ranges of buffers, decompressed where KHR_meshopt_compression or
// EXT_meshopt_compression applies.
// Throws FileError.
void resolveBufferViews(Document&);

// Checks every accessor, used or not: it is inside its view, its stride is at least its element size, and its sparse
// data is inside its views. Throws FileError.
void checkAccessors(const Document&);

// Conversion of integers. asStated: as in a vertex attribute, normalized to [0,1] or [-1,1] only if the accessor says
// so. unit: always normalized, even where the file forgets to say so.
enum class Integers { asStated, unit };

// `location` is that of the reference to the accessor. All throw FileError for a wrong type or invalid sparse indices.
std::vector<float> readFloats(const Document&, int accessor, std::string_view location, Integers = Integers::asStated);
std::vector<vec2> readVec2(const Document&, int accessor, std::string_view location, Integers = Integers::asStated);
std::vector<vec3> readVec3(const Document&, int accessor, std::string_view location, Integers = Integers::asStated);
std::vector<vec4> readVec4(const Document&, int accessor, std::string_view location, Integers = Integers::asStated);
// VEC3 (alpha becomes 1) or VEC4.
std::vector<vec4> readColors(const Document&, int accessor, std::string_view location);
std::vector<mat4> readMat4(const Document&, int accessor, std::string_view location);
std::vector<glm::u16vec4> readJoints(const Document&, int accessor, std::string_view location);

// Accepts unsigned integers only.
std::vector<std::uint32_t> readIndices(const Document&, int accessor, std::string_view location);
// Indices in the file's own memory as whole triangles; empty if their type, stride or alignment requires a conversion.
// Indices after the last whole triangle are not included.
std::span<const uvec3> directTriangles(const Document&, int accessor);

}  // namespace quintet::scene
#endif
