// SPDX-License-Identifier: Apache-2.0
#include "demo/mesh.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace quintet::demo {
namespace {

// For each vertex the smallest index of a vertex at the same position.
std::vector<std::uint32_t> weld(const std::vector<vec3>& positions) {
  std::map<std::tuple<float, float, float>, std::uint32_t> first;
  std::vector<std::uint32_t> result;
  result.reserve(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const vec3 p = positions[i] + 0.0f;  // -0 becomes 0
    result.push_back(first.try_emplace({p.x, p.y, p.z}, i).first->second);
  }
  return result;
}

float cornerAngle(const vec3& at, const vec3& b, const vec3& c) {
  const vec3 u = b - at, v = c - at;
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

struct Corner {
  std::uint32_t triangle;
  float angle;
};

}  // namespace

void TriangleMesh::transform(const mat4& m) {
  const mat3 linear(m);
  const bool mirrors = glm::determinant(linear) < 0.0f;
  const mat3 normalMatrix = glm::transpose(glm::inverse(linear));
  for (vec3& p : positions) p = vec3(m * vec4(p, 1.0f));
  for (vec3& n : normals) n = glm::normalize(normalMatrix * n);
  for (vec4& t : tangents) t = vec4(glm::normalize(linear * vec3(t)), mirrors ? -t.w : t.w);
  if (mirrors) {
    for (uvec3& t : triangles) std::swap(t.y, t.z);
  }
}

void TriangleMesh::append(const TriangleMesh& other) {
  assert(positions.empty() || (normals.empty() == other.normals.empty() && uvs.empty() == other.uvs.empty() &&
                               tangents.empty() == other.tangents.empty()));
  const auto base = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), other.positions.begin(), other.positions.end());
  normals.insert(normals.end(), other.normals.begin(), other.normals.end());
  tangents.insert(tangents.end(), other.tangents.begin(), other.tangents.end());
  uvs.insert(uvs.end(), other.uvs.begin(), other.uvs.end());
  for (const uvec3& t : other.triangles) triangles.push_back(t + base);
}

void computeNormals(TriangleMesh& mesh, float creaseDegrees) {
  const std::vector<std::uint32_t> welded = weld(mesh.positions);
  std::vector<vec3> faceNormals;
  std::vector<std::vector<Corner>> cornersAt(mesh.positions.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const uvec3 v = mesh.triangles[t];
    const vec3 p[3] = {mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]};
    faceNormals.push_back(glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])));
    for (unsigned k = 0; k < 3; ++k) {
      cornersAt[welded[v[k]]].push_back({t, cornerAngle(p[k], p[(k + 1) % 3], p[(k + 2) % 3])});
    }
  }

  const float minCosine = std::cos(glm::radians(creaseDegrees)) - 1e-5f;
  TriangleMesh result;
  std::vector<std::vector<std::uint32_t>> copies(mesh.positions.size());  // of each old vertex
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    uvec3 triangle{};
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t old = mesh.triangles[t][k];
      vec3 sum{0.0f};
      for (const Corner& c : cornersAt[welded[old]]) {
        if (glm::dot(faceNormals[c.triangle], faceNormals[t]) >= minCosine) sum += c.angle * faceNormals[c.triangle];
      }
      const vec3 normal = glm::normalize(sum);
      const auto same = std::find_if(copies[old].begin(), copies[old].end(),
                                     [&](std::uint32_t i) { return glm::dot(result.normals[i], normal) > 0.999999f; });
      if (same != copies[old].end()) {
        triangle[k] = *same;
        continue;
      }
      triangle[k] = static_cast<std::uint32_t>(result.positions.size());
      copies[old].push_back(triangle[k]);
      result.positions.push_back(mesh.positions[old]);
      result.normals.push_back(normal);
      if (!mesh.uvs.empty()) result.uvs.push_back(mesh.uvs[old]);
    }
    result.triangles.push_back(triangle);
  }
  mesh = std::move(result);
}

void computeTangents(TriangleMesh& mesh) {
  assert(!mesh.normals.empty() && !mesh.uvs.empty());
  std::vector<vec3> alongU(mesh.positions.size(), vec3(0.0f)), alongV(mesh.positions.size(), vec3(0.0f));
  for (const uvec3& t : mesh.triangles) {
    const vec3 e1 = mesh.positions[t.y] - mesh.positions[t.x], e2 = mesh.positions[t.z] - mesh.positions[t.x];
    const vec2 d1 = mesh.uvs[t.y] - mesh.uvs[t.x], d2 = mesh.uvs[t.z] - mesh.uvs[t.x];
    const float sign = d1.x * d2.y - d2.x * d1.y < 0.0f ? -1.0f : 1.0f;  // its length is a weight of the triangle
    for (unsigned k = 0; k < 3; ++k) {
      alongU[t[k]] += sign * (e1 * d2.y - e2 * d1.y);
      alongV[t[k]] += sign * (e2 * d1.x - e1 * d2.x);
    }
  }
  mesh.tangents.clear();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3 n = mesh.normals[i];
    vec3 t = alongU[i] - n * glm::dot(n, alongU[i]);
    if (glm::dot(t, t) < 1e-20f) t = glm::cross(n, std::abs(n.x) < 0.9f ? vec3(1, 0, 0) : vec3(0, 1, 0));
    t = glm::normalize(t);
    mesh.tangents.emplace_back(t, glm::dot(glm::cross(n, t), -alongV[i]) < 0.0f ? -1.0f : 1.0f);
  }
}

bool isClosed(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> welded = weld(mesh.positions);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // +1 from the smaller index to the larger one, -1 back
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const uvec3& t : mesh.triangles) {
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[t[k]], b = welded[t[(k + 1) % 3]];
      if (a == b) return false;
      const auto key = std::minmax(a, b);
      edges[key] += a < b ? 1 : -1;
      ++uses[key];
    }
  }
  return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; }) &&
         std::all_of(uses.begin(), uses.end(), [](const auto& e) { return e.second == 2; });
}

double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    sum += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return sum;
}

Bounds3 bounds(const TriangleMesh& mesh) {
  Bounds3 box;
  for (const vec3& p : mesh.positions) box.extend(p);
  return box;
}

}  // namespace quintet::demo
