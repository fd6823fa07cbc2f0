// SPDX-License-Identifier: Apache-2.0
#include "demo/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <map>
#include <utility>

namespace quintet::demo {
namespace {

float at(int i, int count) { return static_cast<float>(i) / static_cast<float>(count); }

float pathLength(std::span<const vec2> path) {
  float sum = 0.0f;
  for (std::size_t i = 1; i < path.size(); ++i) sum += glm::distance(path[i - 1], path[i]);
  return sum;
}

// Splits each triangle into four. New points are on the unit sphere.
void subdivide(TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, isNew] = middles.try_emplace(std::minmax(a, b), mesh.positions.size());
    if (isNew) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
    return entry->second;
  };
  std::vector<uvec3> triangles;
  for (const uvec3& t : mesh.triangles) {
    const uvec3 m{middle(t.x, t.y), middle(t.y, t.z), middle(t.z, t.x)};
    triangles.insert(triangles.end(), {{t.x, m.x, m.z}, {m.x, t.y, m.y}, {m.z, m.y, t.z}, m});
  }
  mesh.triangles = std::move(triangles);
}

// Point of the outline of a regular polygon with rounded corners, moved inwards by `inset`.
vec2 polygonPoint(const PrismShape& shape, int index, float inset) {
  const float half = kPi / static_cast<float>(shape.sides);
  const int corner = index / shape.perSide, step = index % shape.perSide;
  const int arcSteps = shape.perSide / 2;
  const auto arcPoint = [&](int k, float t) {  // t is -1 … 1 along the rounded corner
    const float axis = 2.0f * half * static_cast<float>(k % shape.sides);
    const float angle = axis + half * t;
    const float center = shape.radius - shape.rounding / std::cos(half);
    return center * vec2(std::cos(axis), std::sin(axis)) +
           (shape.rounding - inset) * vec2(std::cos(angle), std::sin(angle));
  };
  if (step <= arcSteps) return arcPoint(corner, 2.0f * at(step, arcSteps) - 1.0f);
  const float t = at(step - arcSteps, shape.perSide - arcSteps);
  return glm::mix(arcPoint(corner, 1.0f), arcPoint(corner + 1, -1.0f), t);
}

}  // namespace

TriangleMesh parametric(int uCount, int vCount, bool wrapU, bool wrapV,
                        const std::function<vec3(float, float)>& point) {
  TriangleMesh mesh;
  for (int j = 0; j <= vCount; ++j) {
    for (int i = 0; i <= uCount; ++i) {
      mesh.positions.push_back(point(at(wrapU ? i % uCount : i, uCount), at(wrapV ? j % vCount : j, vCount)));
      mesh.uvs.emplace_back(at(i, uCount), at(j, vCount));
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
    if (p != q && q != r && r != p) mesh.triangles.emplace_back(a, b, c);
  };
  const auto row = static_cast<std::uint32_t>(uCount + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(vCount); ++j) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(uCount); ++i) {
      const std::uint32_t a = j * row + i, b = a + 1, c = b + row, d = a + row;
      add(a, b, c);
      add(a, c, d);
    }
  }
  return mesh;
}

TriangleMesh icosphere(float radius, int level, bool facets) {
  const float g = (1.0f + std::sqrt(5.0f)) / 2.0f;
  TriangleMesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (vec3& p : mesh.positions) p = glm::normalize(p);
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < level; ++i) subdivide(mesh);
  mesh.normals = mesh.positions;
  for (vec3& p : mesh.positions) p *= radius;
  if (facets) computeNormals(mesh, 0.0f);
  return mesh;
}

TriangleMesh revolve(std::span<const vec2> profile, int segments, float creaseDegrees) {
  const int last = static_cast<int>(profile.size()) - 1;
  TriangleMesh mesh = parametric(segments, last, true, false, [&](float u, float v) {
    const vec2 p = profile[static_cast<std::size_t>(std::lround(v * static_cast<float>(last)))];
    const float angle = -2.0f * kPi * u;
    return vec3(p.x * std::cos(angle), p.y, p.x * std::sin(angle));
  });
  const float length = pathLength(profile);
  for (std::size_t j = 0; j < profile.size(); ++j) {
    const float v = pathLength(profile.first(j + 1)) / length;
    const std::size_t row = static_cast<std::size_t>(segments) + 1;
    for (std::size_t i = 0; i < row; ++i) mesh.uvs[j * row + i].y = v;
  }
  computeNormals(mesh, creaseDegrees);
  return mesh;
}

std::vector<vec2> smoothCurve(std::span<const vec2> points, int perSpan) {
  assert(points.size() >= 2);
  std::vector<vec2> curve{points.front()};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const vec2 b = points[i], c = points[i + 1];
    const vec2 a = i > 0 ? points[i - 1] : 2.0f * b - c;
    const vec2 d = i + 2 < points.size() ? points[i + 2] : 2.0f * c - b;
    const float t1 = std::sqrt(glm::distance(a, b)), t2 = t1 + std::sqrt(glm::distance(b, c));
    const float t3 = t2 + std::sqrt(glm::distance(c, d));
    for (int k = 1; k < perSpan; ++k) {
      const float t = glm::mix(t1, t2, at(k, perSpan));
      const vec2 ab = glm::mix(a, b, t / t1), bc = glm::mix(b, c, (t - t1) / (t2 - t1));
      const vec2 cd = glm::mix(c, d, (t - t2) / (t3 - t2));
      const vec2 abc = glm::mix(ab, bc, t / t2), bcd = glm::mix(bc, cd, (t - t1) / (t3 - t1));
      curve.push_back(glm::mix(abc, bcd, (t - t1) / (t2 - t1)));
    }
    curve.push_back(c);
  }
  return curve;
}

std::vector<vec2> discProfile(float radius, float height, float bevel, int bevelSteps) {
  std::vector<vec2> profile{{0.0f, 0.0f}, {radius - 2.0f * bevel, 0.0f}};
  const auto arc = [&](vec2 center, float from) {
    for (int k = 0; k <= bevelSteps; ++k) {
      const float angle = from + 0.5f * kPi * at(k, bevelSteps);
      profile.push_back(center + bevel * vec2(std::cos(angle), std::sin(angle)));
    }
  };
  arc({radius - bevel, bevel}, -0.5f * kPi);
  arc({radius - bevel, height - bevel}, 0.0f);
  for (float r : {radius - 1.2f * bevel, radius - 2.0f * bevel, 0.5f * radius, 0.0f}) profile.emplace_back(r, height);
  return profile;
}

TriangleMesh superellipsoid(vec3 halfSize, float exponent, int perEdge) {
  const auto warp = [](float x) { return std::tan(x * kPi / 4.0f); };  // makes the cells more uniform
  TriangleMesh mesh;
  for (glm::length_t face = 0; face < 6; ++face) {
    const glm::length_t axis = face / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    const float side = face % 2 == 0 ? 1.0f : -1.0f;
    TriangleMesh part = parametric(perEdge, perEdge, false, false, [&](float u, float v) {
      vec3 q;
      q[axis] = warp(side);
      q[a] = warp(side * (2.0f * u - 1.0f));  // reversed with the side, so that the front is outside
      q[b] = warp(2.0f * v - 1.0f);
      const vec3 power = glm::pow(glm::abs(q), vec3(exponent));
      return halfSize * q * std::pow(power.x + power.y + power.z, -1.0f / exponent);
    });
    mesh.append(part);
  }
  computeNormals(mesh);
  return mesh;
}

TriangleMesh torusKnot(int p, int q, float radius, float swing, float tube, int along, int around) {
  const auto fp = static_cast<float>(p), fq = static_cast<float>(q);
  TriangleMesh mesh = parametric(along, around, true, true, [&](float u, float v) {
    const float phi = 2.0f * kPi * u;
    const float cp = std::cos(fp * phi), sp = std::sin(fp * phi), cq = std::cos(fq * phi), sq = std::sin(fq * phi);
    const float r = radius + swing * cq, dr = -fq * swing * sq;
    const vec3 tangent = glm::normalize(vec3(dr * cp - fp * r * sp, dr * sp + fp * r * cp, -fq * swing * cq));
    const vec3 away(cq * cp, cq * sp, -sq);  // from the circle of the supporting torus
    const vec3 n = glm::normalize(away - tangent * glm::dot(away, tangent));
    const float psi = -2.0f * kPi * v;
    return vec3(r * cp, r * sp, -swing * sq) + tube * (std::cos(psi) * n + std::sin(psi) * glm::cross(tangent, n));
  });
  computeNormals(mesh);
  return mesh;
}

TriangleMesh twistedPrism(const PrismShape& shape) {
  struct Row {
    float inset, scale, y;
  };
  constexpr int kBevelSteps = 6;
  constexpr std::array kCap = {0.0f, 0.5f, 0.9f, 0.98f};
  std::vector<Row> rows;
  for (float s : kCap) rows.push_back({shape.bevel, s, 0.0f});
  for (int k = 0; k <= kBevelSteps; ++k) {
    const float a = 0.5f * kPi * at(k, kBevelSteps);
    rows.push_back({shape.bevel * (1.0f - std::sin(a)), 1.0f, shape.bevel * (1.0f - std::cos(a))});
  }
  for (int k = 0; k <= shape.rings; ++k) {
    const float margin = 1.3f * shape.bevel;
    rows.push_back({0.0f, 1.0f, glm::mix(margin, shape.height - margin, at(k, shape.rings))});
  }
  for (std::size_t k = kCap.size() + kBevelSteps + 1; k-- > 0;) {
    rows.push_back({rows[k].inset, rows[k].scale, shape.height - rows[k].y});
  }

  const int outline = shape.sides * shape.perSide, last = static_cast<int>(rows.size()) - 1;
  TriangleMesh mesh = parametric(outline, last, true, false, [&](float u, float v) {
    const Row& row = rows[static_cast<std::size_t>(std::lround(v * static_cast<float>(last)))];
    const int index = static_cast<int>(std::lround(u * static_cast<float>(outline)));
    const float t = row.y / shape.height, angle = shape.twist * t;
    const vec2 p = row.scale * glm::mix(1.0f, shape.taper, t) * polygonPoint(shape, index, row.inset);
    return vec3(std::cos(angle) * p.x - std::sin(angle) * p.y, row.y, -std::sin(angle) * p.x - std::cos(angle) * p.y);
  });
  computeNormals(mesh);
  return mesh;
}

TriangleMesh box(vec3 low, vec3 high) {
  const vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  TriangleMesh mesh = quad(low, y, x);
  for (const TriangleMesh& face :
       {quad(low, x, z), quad(low, z, y), quad(low + z, x, y), quad(low + x, y, z), quad(low + y, z, x)}) {
    mesh.append(face);
  }
  return mesh;
}

TriangleMesh quad(vec3 corner, vec3 a, vec3 b) {
  TriangleMesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.normals.assign(4, glm::normalize(glm::cross(a, b)));
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh flatDisc(float inner, float outer, int segments, float metersPerTile) {
  TriangleMesh mesh = parametric(segments, 1, true, false, [&](float u, float v) {
    const float r = glm::mix(outer, inner, v), angle = -2.0f * kPi * u;
    return vec3(r * std::cos(angle), 0.0f, r * std::sin(angle));
  });
  computeNormals(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.uvs[i] = vec2(mesh.positions[i].x, mesh.positions[i].z) / metersPerTile;
  }
  return mesh;
}

}  // namespace quintet::demo
