// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

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

// The mapping of a triangle.
struct TriangleFrame {
  vec3 tangent{0.0f};           // dP/du, unit; 0 if it does not exist
  std::int8_t orientation = 0;  // of (dP/du, dP/dv, normal): +1 or -1; 0 if the texture coordinates have no area
  bool point = false;           // two of its positions are equal
};

TriangleFrame triangleFrame(const Geometry& geometry, const std::vector<vec2>& uvs, const uvec3& t) {
  const std::array p{glm::dvec3(geometry.positions[t.x]), glm::dvec3(geometry.positions[t.y]),
                     glm::dvec3(geometry.positions[t.z])};
  TriangleFrame frame;
  frame.point = p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
  const glm::dvec2 d1 = glm::dvec2(uvs[t.y]) - glm::dvec2(uvs[t.x]);
  const glm::dvec2 d2 = glm::dvec2(uvs[t.z]) - glm::dvec2(uvs[t.x]);
  const double area = d1.x * d2.y - d2.x * d1.y;  // twice the signed area; the tangent needs its sign
  const glm::dvec3 tangent = (area < 0.0 ? -1.0 : 1.0) * ((p[1] - p[0]) * d2.y - (p[2] - p[0]) * d1.y);
  const double length = glm::length(tangent);
  if (area == 0.0 || !std::isfinite(length) || length == 0.0) return frame;
  frame.tangent = vec3(tangent / length);
  frame.orientation = area < 0.0 ? -1 : 1;
  return frame;
}

vec3 ontoPlane(const vec3& v, const vec3& normal) {
  const vec3 inPlane = v - normal * glm::dot(normal, v);
  const float length = glm::length(inPlane);
  return length > 0.0f ? inPlane / length : vec3(0.0f);
}

// Returns for each vertex the first one with the same position, normal and texture coordinate.
std::vector<std::uint32_t> weld(const Geometry& geometry, const std::vector<vec2>& uvs) {
  const std::size_t count = geometry.positions.size();
  const auto keyOf = [&](std::size_t i) {
    const vec3 &p = geometry.positions[i], &n = geometry.normals[i];
    std::array<std::uint32_t, 8> key;
    const std::array values{p.x, p.y, p.z, n.x, n.y, n.z, uvs[i].x, uvs[i].y};
    for (std::size_t k = 0; k < key.size(); ++k) key[k] = std::bit_cast<std::uint32_t>(values[k] + 0.0f);  // -0 is 0
    return key;
  };
  const std::size_t mask = std::bit_ceil(2 * count + 1) - 1;
  constexpr std::uint32_t kFree = ~0u;
  std::vector<std::uint32_t> table(mask + 1, kFree), first(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto key = keyOf(i);
    std::uint64_t hash = 0;
    for (const std::uint32_t word : key) {
      hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    std::size_t slot = hash & mask;
    while (table[slot] != kFree && keyOf(table[slot]) != key) slot = (slot + 1) & mask;
    if (table[slot] == kFree) table[slot] = static_cast<std::uint32_t>(i);
    first[i] = table[slot];
  }
  return first;
}

// The corners around each vertex after welding. Corner c of triangle i has the index 3 i + c.
struct VertexCorners {
  std::vector<std::uint32_t> begin;    // per vertex, and the end of the last one
  std::vector<std::uint32_t> corners;  // ascending for each vertex
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return std::span(corners).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
  }
};

VertexCorners cornersOf(const Geometry& geometry, const std::vector<std::uint32_t>& welded) {
  VertexCorners result;
  result.begin.assign(welded.size() + 1, 0);
  for (const uvec3& t : geometry.triangles)
    for (std::size_t c = 0; c < 3; ++c) ++result.begin[welded[t[c]] + 1];
  for (std::size_t v = 0; v < welded.size(); ++v) result.begin[v + 1] += result.begin[v];
  result.corners.resize(3 * geometry.triangles.size());
  std::vector<std::uint32_t> next(result.begin.begin(), result.begin.end() - 1);
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      result.corners[next[welded[geometry.triangles[i][c]]]++] = static_cast<std::uint32_t>(3 * i + c);
  return result;
}

// Groups the corners around one vertex that share a tangent: those of triangles that are connected by edges and have the
// same orientation.
class CornerGroups {
 public:
  CornerGroups(const Geometry& geometry, const std::vector<TriangleFrame>& frames,
               const std::vector<std::uint32_t>& welded)
      : geometry_(geometry), frames_(frames), welded_(welded) {}

  // Sets the group of each corner, counted from 0, and returns the number of groups.
  std::uint32_t group(std::span<const std::uint32_t> corners, std::span<std::uint32_t> groups) {
    const std::size_t count = corners.size();
    parent_.resize(count);
    orientation_.resize(count);
    edges_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
      parent_[i] = i;
      const TriangleFrame& frame = frames_[corners[i] / 3];
      orientation_[i] = frame.orientation;
      if (frame.point) continue;
      const uvec3& t = geometry_.triangles[corners[i] / 3];
      edges_.push_back({welded_[t[(corners[i] + 1) % 3]], false, i});
      edges_.push_back({welded_[t[(corners[i] + 2) % 3]], true, i});
    }
    std::ranges::sort(edges_);
    connect(+1);
    connect(-1);
    return number(corners, groups);
  }

 private:
  // An edge at the vertex, by its other end.
  struct Edge {
    std::uint32_t end;
    bool arrives;  // the triangle passes it towards the vertex
    std::uint32_t corner;
    auto operator<=>(const Edge&) const = default;
  };

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Connects the corners of this orientation across edges that two triangles pass in opposite directions. Triangles without
  // area in the texture join both orientations, preferably +1; `orientation_` becomes that of their group.
  void connect(std::int8_t orientation) {
    for (std::size_t first = 0, last = 0; first < edges_.size(); first = last) {
      for (last = first; last < edges_.size() && edges_[last].end == edges_[first].end;) ++last;
      const auto joins = [&](const Edge& e) {
        return orientation_[e.corner] == orientation || orientation_[e.corner] == 0;
      };
      const std::span run = std::span(edges_).subspan(first, last - first);
      const auto leaving = std::ranges::find_if(run, [&](const Edge& e) { return !e.arrives && joins(e); });
      if (leaving == run.end() || std::ranges::none_of(run, [&](const Edge& e) { return e.arrives && joins(e); }))
        continue;
      for (const Edge& e : run)
        if (joins(e)) unite(leaving->corner, e.corner);
    }
    has_.assign(parent_.size(), false);
    for (std::uint32_t i = 0; i < parent_.size(); ++i)
      if (orientation_[i] == orientation) has_[root(i)] = true;
    for (std::uint32_t i = 0; i < parent_.size(); ++i)
      if (has_[root(i)]) orientation_[i] = orientation;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);  // roots come first
  }

  // Triangles without area in space join the first group.
  std::uint32_t number(std::span<const std::uint32_t> corners, std::span<std::uint32_t> groups) {
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      if (!frames_[corners[i] / 3].point) groups[i] = root(i) == i ? next++ : groups[root(i)];
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      if (frames_[corners[i] / 3].point) groups[i] = 0;
    return corners.empty() ? 0 : std::max(next, 1u);
  }

  const Geometry& geometry_;
  const std::vector<TriangleFrame>& frames_;
  const std::vector<std::uint32_t>& welded_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::int8_t> orientation_;
  std::vector<bool> has_;
  std::vector<Edge> edges_;
};

// A term of the tangent at a vertex with normal n: the tangent of the triangle in the plane of the normal, weighted by the
// angle between its edges in this plane.
vec3 cornerTerm(const Geometry& geometry, const TriangleFrame& frame, std::uint32_t corner, const vec3& n) {
  const uvec3& t = geometry.triangles[corner / 3];
  const vec3& p = geometry.positions[t[corner % 3]];
  const vec3 a = ontoPlane(geometry.positions[t[(corner + 1) % 3]] - p, n);
  const vec3 b = ontoPlane(geometry.positions[t[(corner + 2) % 3]] - p, n);
  return std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f)) * ontoPlane(frame.tangent, n);
}

// Returns the tangent of a group. The terms are added in the order of their values, so the result does not depend on the order
// of the triangles.
vec4 groupTangent(std::vector<vec3>& terms, int orientation, const vec3& n) {
  std::ranges::sort(terms,
                    [](const vec3& a, const vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  vec3 sum(0.0f);
  for (const vec3& term : terms) sum += term;
  const vec3 inPlane = sum - n * glm::dot(n, sum);
  const float length = glm::length(inPlane);
  // In glTF, v points down in the image and "up" in a normal map is -v: the bitangent w · cross(n, t) is -dP/dv.
  return vec4(length > 1e-6f ? inPlane / length : anyPerpendicular(n), orientation > 0 ? -1.0f : 1.0f);
}

// The tangents of all groups, and the group of each corner.
struct TangentGroups {
  std::vector<std::uint32_t> groupOfCorner;
  std::vector<vec4> tangents;
};

TangentGroups makeGroups(const Geometry& geometry, const std::vector<vec2>& uvs) {
  constexpr std::size_t kGrain = 8192;
  std::vector<TriangleFrame> frames(geometry.triangles.size());
  parallelRanges(frames.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) frames[i] = triangleFrame(geometry, uvs, geometry.triangles[i]);
  });
  const std::vector<std::uint32_t> welded = weld(geometry, uvs);
  const VertexCorners corners = cornersOf(geometry, welded);

  // The groups of each vertex are counted from 0 at first.
  std::vector<std::uint32_t> groups(corners.corners.size()), firstGroup(welded.size() + 1, 0);
  const auto makeRange = [&](std::size_t first, std::size_t last) {
    CornerGroups grouping(geometry, frames, welded);
    for (std::size_t v = first; v < last; ++v)
      firstGroup[v + 1] =
          grouping.group(corners.of(v), std::span(groups).subspan(corners.begin[v], corners.of(v).size()));
  };
  parallelRanges(welded.size(), makeRange, kGrain);
  for (std::size_t v = 0; v < welded.size(); ++v) firstGroup[v + 1] += firstGroup[v];

  TangentGroups result;
  result.groupOfCorner.resize(groups.size());
  result.tangents.resize(firstGroup.back());
  const auto sumRange = [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> order;  // of the corners around the vertex, by their group
    std::vector<vec3> terms;
    for (std::size_t v = first; v < last; ++v) {
      const std::span<const std::uint32_t> around = corners.of(v);
      const std::span<const std::uint32_t> local = std::span(groups).subspan(corners.begin[v], around.size());
      order.resize(around.size());
      std::iota(order.begin(), order.end(), 0u);
      std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return local[i]; });
      for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        terms.clear();
        int orientation = 0;
        const std::uint32_t group = firstGroup[v] + local[order[begin]];
        for (; end < order.size() && local[order[end]] == local[order[begin]]; ++end) {
          const std::uint32_t corner = around[order[end]];
          result.groupOfCorner[corner] = group;
          const TriangleFrame& frame = frames[corner / 3];
          if (frame.orientation == 0 || frame.point) continue;
          orientation = frame.orientation;
          terms.push_back(cornerTerm(geometry, frame, corner, geometry.normals[v]));
        }
        result.tangents[group] = groupTangent(terms, orientation, geometry.normals[v]);
      }
    }
  };
  parallelRanges(welded.size(), sumRange, kGrain);
  return result;
}

// Gives each vertex the tangent of its corners. Corners of other groups use copies of the vertex.
void splitByGroup(Geometry& geometry, const TangentGroups& groups) {
  constexpr std::uint32_t kNoGroup = ~0u;
  std::vector<std::uint32_t> groupOfVertex(geometry.positions.size(), kNoGroup);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;
  for (std::size_t i = 0; i < groups.groupOfCorner.size(); ++i) {
    std::uint32_t& vertex = geometry.triangles[i / 3][static_cast<glm::length_t>(i % 3)];
    const std::uint32_t group = groups.groupOfCorner[i];
    if (groupOfVertex[vertex] == kNoGroup) groupOfVertex[vertex] = group;
    if (groupOfVertex[vertex] == group) continue;
    const auto [copy, isNew] = copies.try_emplace({vertex, group}, 0);
    if (isNew) {
      copy->second = duplicateVertex(geometry, vertex);
      groupOfVertex.push_back(group);
    }
    vertex = copy->second;
  }
  geometry.tangents.resize(groupOfVertex.size());
  for (std::size_t v = 0; v < groupOfVertex.size(); ++v)
    geometry.tangents[v] = groupOfVertex[v] != kNoGroup ? groups.tangents[groupOfVertex[v]]
                                                        : vec4(anyPerpendicular(geometry.normals[v]), 1.0f);
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
  parallelRanges(uvs.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) uvs[i] = transformUv(use, source[i]);
  });
  splitByGroup(geometry, makeGroups(geometry, uvs));
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
