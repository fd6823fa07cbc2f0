// Accessors as vectors of floats or indices: strides, component types, normalised integers and sparse
// parts (glTF 2.0 sections 3.6.2 and 3.11). Elements are converted in bulk; misaligned data is legal here.
#ifndef QUINTET_SCENE_GLTF_ACCESSOR_H
#define QUINTET_SCENE_GLTF_ACCESSOR_H

#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/gltf_document.h"

namespace quintet::scene {

// Integers become what a vertex attribute would be in a shader: normalised ones [0,1] or [-1,1], others
// their value. `unit`: integers are normalised even where the file forgets to say so.
enum class Integers { asStated, unit };

// `place` is the use of the accessor, for errors: the wrong type, broken sparse indices.
std::vector<float> readFloats(const Document&, int accessor, std::string_view place, Integers = Integers::asStated);
std::vector<vec2> readVec2(const Document&, int accessor, std::string_view place, Integers = Integers::asStated);
std::vector<vec3> readVec3(const Document&, int accessor, std::string_view place, Integers = Integers::asStated);
std::vector<vec4> readVec4(const Document&, int accessor, std::string_view place, Integers = Integers::asStated);
// VEC3 (alpha becomes 1) or VEC4.
std::vector<vec4> readColors(const Document&, int accessor, std::string_view place);
std::vector<mat4> readMat4(const Document&, int accessor, std::string_view place);

// Unsigned integers only.
std::vector<std::uint32_t> readIndices(const Document&, int accessor, std::string_view place);
// Of a list of triangles; every index is below vertexCount.
std::vector<uvec3> readTriangleList(const Document&, int accessor, std::size_t vertexCount, std::string_view place);
// Throws FileError for the first index that is too large.
void checkIndices(const Document&, std::span<const std::uint32_t> indices, std::size_t vertexCount,
                  std::string_view place);
std::vector<glm::u16vec4> readJoints(const Document&, int accessor, std::string_view place);

}  // namespace quintet::scene
#endif
