// From a primitive's vertex order to a triangle list: glTF 2.0 section 3.7.2.1 (winding included).
#ifndef QUINTET_SCENE_TRIANGLES_H
#define QUINTET_SCENE_TRIANGLES_H

#include <cstdint>
#include <vector>

#include "base/math.h"

namespace quintet::scene {

enum class TriangleMode { list, strip, fan };

// `indices` empty: vertices 0 … vertexCount-1 in their order. Vertices beyond the last whole triangle are dropped.
std::vector<uvec3> makeTriangles(TriangleMode mode, const std::vector<std::uint32_t>& indices,
                                 std::uint32_t vertexCount);

}  // namespace quintet::scene
#endif
