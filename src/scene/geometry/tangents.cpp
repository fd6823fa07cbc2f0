// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/tangents.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "scene/geometry/repair.h"

namespace quintet::scene {
namespace {

template <class T>
void appendCopy(std::vector<T>& values, std::size_t index) {
  if (!values.empty()) values.push_back(T(values[index]));
}

std::uint32_t duplicateVertex(Geometry& geometry, std::uint32_t index) {
  const auto copy = static_cast<std::uint32_t>(geometry.positions.size());
  appendCopy(geometry.positions, index);
  appendCopy(geometry.normals, index);
  appendCopy(geometry.colors, index);
  appendCopy(geometry.fileVertices, index);
  for (auto& set : geometry.uvs) appendCopy(set, index);
  return copy;
}

struct TriangleFrame {
  vec3 tangent{0.0f};  // dP/du, unit
  int handedness = 0;  // of (dP/du, dP/dv, normal): +1 or -1; 0 for a degenerate mapping
};

TriangleFrame triangleFrame(const Geometry& geometry, const std::vector<vec2>& uvs, const uvec3& t) {
  const vec3 e1 = geometry.positions[t.y] - geometry.positions[t.x];
  const vec3 e2 = geometry.positions[t.z] - geometry.positions[t.x];
  const vec2 d1 = uvs[t.y] - uvs[t.x];
  const vec2 d2 = uvs[t.z] - uvs[t.x];
  const float area = d1.x * d2.y - d2.x * d1.y;  // twice the signed area in uv; the tangent needs its sign
  const float sign = area < 0.0f ? -1.0f : 1.0f;
  const vec3 tangent = sign * (e1 * d2.y - e2 * d1.y);
  const float length = glm::length(tangent);
  if (area == 0.0f || !std::isfinite(length) || length == 0.0f) return {};
  return {tangent / length, area < 0.0f ? -1 : 1};
}

float cornerAngle(const Geometry& geometry, const uvec3& t, std::size_t corner) {
  const vec3& p = geometry.positions[t[corner]];
  const vec3 a = geometry.positions[t[(corner + 1) % 3]] - p;
  const vec3 b = geometry.positions[t[(corner + 2) % 3]] - p;
  const float lengths = glm::length(a) * glm::length(b);
  return lengths > 0.0f ? std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0f, 1.0f)) : 0.0f;
}

// Gives each vertex one handedness, that of its first triangle (0 without a triangle). Triangles of the other
// handedness use a copy of the vertex.
std::vector<int> separateHandedness(Geometry& geometry, std::vector<vec2>& uvs,
                                    const std::vector<TriangleFrame>& frames) {
  std::vector<int> handedness(geometry.positions.size(), 0);
  std::vector<std::uint32_t> mirror(geometry.positions.size(), 0);  // index of the copy, or 0 (never a copy)
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].handedness == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& vertex = geometry.triangles[i][c];
      if (handedness[vertex] == 0) handedness[vertex] = frames[i].handedness;
      if (handedness[vertex] == frames[i].handedness) continue;
      if (mirror[vertex] == 0) {
        mirror[vertex] = duplicateVertex(geometry, vertex);
        uvs.push_back(vec2(uvs[vertex]));
        handedness.push_back(frames[i].handedness);
      }
      vertex = mirror[vertex];
    }
  }
  return handedness;
}

// Per vertex, the sum of the tangents of its triangles, projected into the plane of the normal and weighted by the
// corner angle. The terms are computed on all cores, one block of triangles at a time, and added in the order of the
// triangles.
std::vector<vec3> sumOverCorners(const Geometry& geometry, const std::vector<TriangleFrame>& frames) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::vector<vec3> sums(geometry.positions.size(), vec3(0.0f));
  std::vector<std::array<vec3, 3>> terms(std::min(kBlock, frames.size()));
  for (std::size_t begin = 0; begin < frames.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, frames.size() - begin);
    parallelRanges(count, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        terms[i].fill(vec3(0.0f));
        const TriangleFrame& frame = frames[begin + i];
        if (frame.handedness == 0) continue;
        const uvec3& t = geometry.triangles[begin + i];
        for (std::size_t c = 0; c < 3; ++c) {
          const vec3& n = geometry.normals[t[c]];
          const vec3 inPlane = frame.tangent - n * glm::dot(n, frame.tangent);
          const float length = glm::length(inPlane);
          if (length > 0.0f) terms[i][c] = cornerAngle(geometry, t, c) / length * inPlane;
        }
      }
    });
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < 3; ++c) sums[geometry.triangles[begin + i][c]] += terms[i][c];
  }
  return sums;
}

}  // namespace

void splitIntoFlatTriangles(Geometry& geometry) {
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> split;
    split.reserve(3 * geometry.triangles.size());
    for (const uvec3& t : geometry.triangles)
      for (std::size_t c = 0; c < 3; ++c) split.push_back(values[t[c]]);
    values = std::move(split);
  };
  gather(geometry.positions);
  gather(geometry.colors);
  gather(geometry.fileVertices);
  for (auto& set : geometry.uvs) gather(set);
  geometry.normals.assign(geometry.positions.size(), vec3(0.0f));
  geometry.tangents.clear();
  for (std::uint32_t i = 0; i < geometry.triangles.size(); ++i)
    geometry.triangles[i] = uvec3(3 * i, 3 * i + 1, 3 * i + 2);
  repairNormals(geometry);  // replaces each zero by its only face normal
}

vec2 transformUv(const TextureUse& use, const vec2& uv) {
  const float c = std::cos(use.rotation), s = std::sin(use.rotation);
  const vec2 scaled = use.scale * uv;
  return use.offset + vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
}

void generateTangents(Geometry& geometry, const TextureUse& use) {
  const auto& source = geometry.uvs[static_cast<std::size_t>(use.uvSet)];
  if (geometry.normals.empty() || source.empty()) return;
  std::vector<vec2> uvs(source.size());
  std::vector<TriangleFrame> frames(geometry.triangles.size());
  parallelRanges(uvs.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) uvs[i] = transformUv(use, source[i]);
  });
  parallelRanges(frames.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) frames[i] = triangleFrame(geometry, uvs, geometry.triangles[i]);
  });
  const std::vector<int> handedness = separateHandedness(geometry, uvs, frames);
  const std::vector<vec3> sums = sumOverCorners(geometry, frames);

  geometry.tangents.resize(sums.size());
  parallelRanges(sums.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const vec3& n = geometry.normals[i];
      const vec3 inPlane = sums[i] - n * glm::dot(n, sums[i]);
      const float length = glm::length(inPlane);
      const vec3 tangent = length > 1e-6f ? inPlane / length : anyPerpendicular(n);
      // In glTF, v points down in the image and "up" in a normal map is -v: the bitangent w · cross(n, t) is -dP/dv.
      geometry.tangents[i] = vec4(tangent, handedness[i] > 0 ? -1.0f : 1.0f);
    }
  });
}

bool addTangents(Geometry& geometry, const Material& material) {
  const bool needed =
      material.normalTexture.used() || material.clearcoatNormalTexture.used() || material.anisotropy > 0.0f;
  if (!needed || !geometry.tangents.empty()) return false;
  const TextureUse& use = material.normalTexture.used()            ? material.normalTexture
                          : material.clearcoatNormalTexture.used() ? material.clearcoatNormalTexture
                                                                   : material.anisotropyTexture;
  if (geometry.uvs[static_cast<std::size_t>(use.uvSet)].empty()) return false;
  if (geometry.normals.empty()) splitIntoFlatTriangles(geometry);
  generateTangents(geometry, use);
  return true;
}

bool addTangents(Scene& scene, std::size_t material) {
  bool changed = false;
  for (Mesh& mesh : scene.meshes)
    for (Geometry& geometry : mesh.geometries)
      if (geometry.material == static_cast<int>(material) && !mesh.deformation)
        changed = addTangents(geometry, scene.materials[material]) || changed;
  return changed;
}

}  // namespace quintet::scene
