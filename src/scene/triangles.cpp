#include "scene/triangles.h"

#include <cstring>

namespace quintet::scene {
namespace {

template <class Vertex>
std::vector<uvec3> assemble(TriangleMode mode, std::size_t count, Vertex vertex) {
  std::vector<uvec3> triangles;
  if (count < 3) return triangles;
  triangles.resize(mode == TriangleMode::list ? count / 3 : count - 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    switch (mode) {
      case TriangleMode::list: triangles[i] = {vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)}; break;
      case TriangleMode::strip: triangles[i] = {vertex(i), vertex(i + 1 + i % 2), vertex(i + 2 - i % 2)}; break;
      case TriangleMode::fan: triangles[i] = {vertex(i + 1), vertex(i + 2), vertex(0)}; break;
    }
  }
  return triangles;
}

}  // namespace

std::vector<uvec3> makeTriangles(TriangleMode mode, const std::vector<std::uint32_t>& indices,
                                 std::uint32_t vertexCount) {
  if (indices.empty()) return assemble(mode, vertexCount, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  if (mode == TriangleMode::list) {  // the usual and the large case: a copy
    std::vector<uvec3> triangles(indices.size() / 3);
    static_assert(sizeof(uvec3) == 3 * sizeof(std::uint32_t));
    if (!triangles.empty()) std::memcpy(triangles.data(), indices.data(), triangles.size() * sizeof(uvec3));
    return triangles;
  }
  return assemble(mode, indices.size(), [&](std::size_t i) { return indices[i]; });
}

}  // namespace quintet::scene
