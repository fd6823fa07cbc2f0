// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/shapes.h"

#include <algorithm>
#include <array>

namespace quintet::scene {
namespace {

// Adds a parallelogram of segments.x × segments.y quads; `right` and `down` are its sides. Positions on an edge do not
// depend on the direction of the edge (bit for bit), so that adjacent patches meet without cracks.
void addPatch(Geometry& geometry, const vec3& center, const vec3& right, const vec3& down, const uvec2& segments) {
  const auto first = static_cast<std::uint32_t>(geometry.positions.size());
  const vec3 normal = glm::normalize(glm::cross(down, right));
  for (std::uint32_t y = 0; y <= segments.y; ++y) {
    for (std::uint32_t x = 0; x <= segments.x; ++x) {
      const vec2 uv = vec2(static_cast<float>(x), static_cast<float>(y)) / vec2(segments);
      const vec2 fromCenter =
          (2.0f * vec2(static_cast<float>(x), static_cast<float>(y)) - vec2(segments)) / (2.0f * vec2(segments));
      geometry.positions.push_back(center + fromCenter.x * right + fromCenter.y * down);
      geometry.normals.push_back(normal);
      geometry.uvs[0].push_back(uv);
    }
  }
  const std::uint32_t row = segments.x + 1;
  for (std::uint32_t y = 0; y < segments.y; ++y) {
    for (std::uint32_t x = 0; x < segments.x; ++x) {
      const std::uint32_t a = first + y * row + x;
      geometry.triangles.push_back({a, a + row, a + row + 1});
      geometry.triangles.push_back({a, a + row + 1, a + 1});
    }
  }
}

}  // namespace

Geometry makeQuad(const vec2& size, const uvec2& segments) {
  Geometry geometry;
  addPatch(geometry, vec3(0.0f), {size.x, 0, 0}, {0, -size.y, 0}, segments);
  return geometry;
}

Geometry makePlane(const vec2& size, const uvec2& segments) {
  Geometry geometry;
  addPatch(geometry, vec3(0.0f), {size.x, 0, 0}, {0, 0, size.y}, segments);
  return geometry;
}

Geometry makeCube(const vec3& size, std::uint32_t segments) {
  // The right and the down direction of each face, seen from outside.
  constexpr std::array<std::array<vec3, 2>, 6> kFaces{{{vec3(1, 0, 0), vec3(0, -1, 0)},    // +z
                                                       {vec3(-1, 0, 0), vec3(0, -1, 0)},   // -z
                                                       {vec3(0, 0, -1), vec3(0, -1, 0)},   // +x
                                                       {vec3(0, 0, 1), vec3(0, -1, 0)},    // -x
                                                       {vec3(1, 0, 0), vec3(0, 0, 1)},     // +y
                                                       {vec3(1, 0, 0), vec3(0, 0, -1)}}};  // -y
  Geometry geometry;
  for (const auto& [right, down] : kFaces) {
    const vec3 outwards = glm::cross(down, right);
    addPatch(geometry, 0.5f * size * outwards, size * right, size * down, uvec2(segments));
  }
  return geometry;
}

Geometry makeUvSphere(float radius, std::uint32_t columns, std::uint32_t rows) {
  Geometry geometry;
  for (std::uint32_t y = 0; y <= rows; ++y) {
    for (std::uint32_t x = 0; x <= columns; ++x) {
      const bool pole = y == 0 || y == rows;
      if (pole && x == columns) continue;
      const double theta = glm::pi<double>() * y / rows;
      // The last column repeats the first one bit for bit, so that the seam is closed.
      const double phi = 2.0 * glm::pi<double>() * (x % columns) / columns;
      const double sine = pole ? 0.0 : std::sin(theta);
      const glm::dvec3 n(-sine * std::cos(phi),
                         y == 0      ? 1.0
                         : y == rows ? -1.0
                                     : std::cos(theta),
                         sine * std::sin(phi));
      geometry.positions.push_back(radius * vec3(n));
      geometry.normals.push_back(vec3(n));
      geometry.uvs[0].push_back({(static_cast<float>(x) + (pole ? 0.5f : 0.0f)) / static_cast<float>(columns),
                                 static_cast<float>(y) / static_cast<float>(rows)});
    }
  }
  // Index of vertex (x, y). The rows of the poles have one vertex less.
  const auto index = [&](std::uint32_t x, std::uint32_t y) {
    return y == 0 ? x : columns + (y - 1) * (columns + 1) + x;
  };
  for (std::uint32_t y = 0; y < rows; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      if (y > 0)
        geometry.triangles.push_back({index(x, y), index(x + (y + 1 == rows ? 0 : 1), y + 1), index(x + 1, y)});
      if (y + 1 < rows) geometry.triangles.push_back({index(x, y), index(x, y + 1), index(x + 1, y + 1)});
    }
  }
  return geometry;
}

Geometry makeTetrahedron(float radius) {
  const float h = 1.0f / 3.0f, r = std::sqrt(8.0f) / 3.0f, s = std::sqrt(3.0f) / 2.0f;
  const std::array<vec3, 4> corners{vec3(0, 1, 0), vec3(0, -h, r), vec3(r * s, -h, -0.5f * r),
                                    vec3(-r * s, -h, -0.5f * r)};
  constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{1, 2, 0}, {2, 3, 0}, {3, 1, 0}, {1, 3, 2}}};
  Geometry geometry;
  for (const auto& face : kFaces) {
    const auto first = static_cast<std::uint32_t>(geometry.positions.size());
    const vec3 normal =
        glm::normalize(glm::cross(corners[face[1]] - corners[face[0]], corners[face[2]] - corners[face[0]]));
    for (std::size_t i = 0; i < 3; ++i) {
      geometry.positions.push_back(radius * corners[face[i]]);
      geometry.normals.push_back(normal);
      geometry.uvs[0].push_back(std::array<vec2, 3>{vec2(0, 1), vec2(1, 1), vec2(0, 0)}[i]);
    }
    geometry.triangles.push_back({first, first + 1, first + 2});
  }
  return geometry;
}

}  // namespace quintet::scene
