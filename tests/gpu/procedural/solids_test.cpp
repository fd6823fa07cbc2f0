// SPDX-License-Identifier: Apache-2.0
// Each solid, compared with the oracle on the host: t, entering or leaving, normal; and rays that leave a surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "expectation.h"

namespace quintet::test {
namespace {

using scene::Primitive;
using scene::PrimitiveType;

constexpr std::array kTypes{PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder, PrimitiveType::cone,
                            PrimitiveType::torus};
const char* nameOf(PrimitiveType type) {
  constexpr std::array kNames{"sphere", "box", "cylinder", "cone", "torus"};
  return kNames[static_cast<std::size_t>(type)];
}

// Rays from outside, from inside, along an axis of the solid, and with limits; with directions of any length.
std::vector<ProbeRay> raysAround(Random& random, std::size_t count, const mat4& worldFromPrimitive) {
  std::vector<ProbeRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 from =
        i % 4 == 0 ? random.inBox(1.2f) : random.onSphere() * random.uniform(1.5f, i % 4 == 1 ? 50.0f : 4.0f);
    vec3 along = random.inBox(1.3f) - from;
    if (i % 11 == 0)
      along =
          vec3(glm::equal(glm::uvec3(0, 1, 2), glm::uvec3(random.below(3)))) * (random.below(2) == 1 ? 1.0f : -1.0f);
    along *= std::exp(random.uniform(-3.0f, 3.0f));
    ProbeRay ray;
    ray.origin = worldFromPrimitive * vec4(from, 1.0f);
    ray.direction = worldFromPrimitive * vec4(along, 0.0f);
    const float unit = 1.0f / glm::length(along);
    if (i % 3 == 0) ray.tmin = random.uniform(0.0f, 1.0f) * glm::length(from) * unit;
    if (i % 7 == 0) ray.tmax = ray.tmin + random.uniform(0.0f, 2.0f) * unit;
    rays.push_back(ray);
  }
  return rays;
}

Primitive randomPrimitive(Random& random, PrimitiveType type, float stretch) {
  Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = random.affine(stretch, 3.0f);
  primitive.parameter = random.uniform(0.02f, 0.95f);
  return primitive;
}

struct Agreement {
  std::size_t hits = 0, doubtful = 0;
};

void compare(const ProbeHit& hit, const Expected& expected, const Primitive& primitive, const mat4& worldFromObject) {
  EXPECT_EQ(expected.difference, "");
  if (!expected.hit || hit.t < 0.0f) return;
  // The point lies on the surface, for any origin of the ray.
  const dmat4 worldFromPrimitive = dmat4(worldFromObject) * dmat4(primitive.objectFromPrimitive);
  const auto fromPoint =
      oracle::crossings(primitive, toObject({.origin = hit.position, .direction = hit.normal}, worldFromObject));
  double nearest = 1e30;
  for (const oracle::Crossing& crossing : fromPoint) nearest = std::min(nearest, std::abs(crossing.t));
  EXPECT_LT(nearest, static_cast<double>(hit.error)) << "error bound " << hit.error;
  EXPECT_LT(hit.error, 3e-5 * (glm::length(dvec3(worldFromPrimitive[3])) + glm::length(dvec3(hit.position)) + 1.0));
}

class Solids : public testing::TestWithParam<PrimitiveType> {};

// Texture coordinates of a point of a canonical solid, and the directions of increasing u and of decreasing v (point.glsl).
struct Chart {
  glm::dvec2 uv{0};
  dvec3 along{0}, up{0};
};

Chart chartAt(PrimitiveType type, std::uint32_t face, const dvec3& p) {
  const double rho = std::hypot(p.x, p.z), turn = 0.5 + std::atan2(p.x, p.z) / glm::two_pi<double>();
  const dvec3 out = dvec3(p.x, 0, p.z) / rho, around(out.z, 0, -out.x);
  if (type == PrimitiveType::sphere)
    return {{turn, std::acos(p.y) / glm::pi<double>()}, around, dvec3(0, 1, 0) - p.y * p};
  if (type == PrimitiveType::torus) {
    const double angle = std::atan2(p.y, rho - 1);
    return {{turn, 0.5 - angle / glm::two_pi<double>()}, around, dvec3(0, std::cos(angle), 0) - std::sin(angle) * out};
  }
  const auto square = [](double right, double above) { return glm::dvec2(0.5 + 0.5 * right, 0.5 - 0.5 * above); };
  switch (face) {
    case 0: return {square(p.z, p.y), {0, 0, 1}, {0, 1, 0}};
    case 1: return {square(-p.z, p.y), {0, 0, -1}, {0, 1, 0}};
    case 2: return {square(p.x, p.z), {1, 0, 0}, {0, 0, 1}};
    case 3: return {square(p.x, -p.z), {1, 0, 0}, {0, 0, -1}};
    case 4: return {square(-p.x, p.y), {-1, 0, 0}, {0, 1, 0}};
    case 5: return {square(p.x, p.y), {1, 0, 0}, {0, 1, 0}};
    default: break;
  }
  const dvec3 up = type == PrimitiveType::cone ? dvec3(0, 1, 0) - 0.5 * out : dvec3(0, 1, 0);
  return {{turn, 0.5 - 0.5 * p.y}, around, up};
}

TEST_P(Solids, HaveTextureCoordinatesAndTangents) {
  Random random(700 + static_cast<std::uint32_t>(GetParam()));
  int compared = 0;
  for (int round = 0; round < 3; ++round) {
    Primitive primitive = randomPrimitive(random, GetParam(), 1.5f);
    primitive.parameter = 0.3f;
    const mat4 worldFromObject = random.affine(1.5f, 2.0f);
    const dmat4 world = dmat4(worldFromObject) * dmat4(primitive.objectFromPrimitive), inverse = glm::inverse(world);
    std::vector<ProbeRay> rays;
    for (int i = 0; i < 200; ++i) {
      const vec3 from = 3.0f * random.onSphere(), to = random.inBox(0.9f);
      rays.push_back({.origin = vec3(world * glm::dvec4(dvec3(from), 1)),
                      .direction = vec3(world * glm::dvec4(dvec3(to - from), 0))});
    }
    const std::vector<ProbeHit> hits = probe(sceneOf(solidsOf({primitive}), worldFromObject), rays);
    for (const ProbeHit& hit : hits) {
      if (hit.t < 0.0f) continue;
      const dvec3 p(inverse * glm::dvec4(dvec3(hit.position), 1));
      if (std::hypot(p.x, p.z) < 0.1) continue;  // near the axis, directions around it are not defined
      const Chart chart = chartAt(GetParam(), hit.face, p);
      if (std::abs(chart.uv.x - 0.5) > 0.49) continue;  // near the seam
      EXPECT_NEAR(hit.uv.x, chart.uv.x, 2e-4) << "face " << hit.face;
      EXPECT_NEAR(hit.uv.y, chart.uv.y, 2e-4) << "face " << hit.face;
      const dvec3 n(hit.normal), along = glm::dmat3(world) * chart.along, up = glm::dmat3(world) * chart.up;
      const dvec3 tangent = glm::normalize(along - n * glm::dot(n, along));
      EXPECT_LT(glm::length(dvec3(hit.tangent) - tangent), 2e-3) << "face " << hit.face;
      EXPECT_GT(glm::dot(dvec3(hit.bitangent), up), 0.0) << "face " << hit.face;
      EXPECT_NEAR(glm::dot(dvec3(hit.bitangent), n), 0.0, 1e-4);
      EXPECT_NEAR(glm::dot(dvec3(hit.bitangent), dvec3(hit.tangent)), 0.0, 1e-4);
      EXPECT_NEAR(glm::length(dvec3(hit.bitangent)), 1.0, 1e-4);
      compared++;
    }
  }
  EXPECT_GT(compared, 250);
}

TEST_P(Solids, AgreeWithTheOracle) {
  Random random(100 + static_cast<std::uint32_t>(GetParam()));
  Agreement agreement;
  std::size_t count = 0;
  for (int round = 0; round < 6; ++round) {
    const float stretch = round < 2 ? 1.0f : 3.0f;
    const Primitive primitive = randomPrimitive(random, GetParam(), stretch);
    const mat4 worldFromObject = round % 2 ? random.affine(stretch, 5.0f) : mat4(1.0f);
    const std::vector<ProbeRay> rays = raysAround(random, 2000, worldFromObject * primitive.objectFromPrimitive);
    const std::vector<ProbeHit> hits = probe(sceneOf(solidsOf({primitive}), worldFromObject), rays);
    for (std::size_t i = 0; i < rays.size(); ++i, ++count) {
      const auto crossings = [&](const oracle::Ray& ray) { return oracle::crossings(primitive, ray); };
      const Expected expected = expectHit(crossings, hits[i], rays[i], worldFromObject);
      agreement.doubtful += expected.doubtful;
      if (expected.doubtful) continue;
      agreement.hits += expected.hit.has_value();
      SCOPED_TRACE(testing::Message() << nameOf(GetParam()) << " " << round << " ray " << i);
      compare(hits[i], expected, primitive, worldFromObject);
      if (HasFailure()) return;
    }
  }
  std::printf("%zu rays: %zu hits, %zu doubtful\n", count, agreement.hits, agreement.doubtful);
  EXPECT_GT(agreement.hits, count / 4);
  EXPECT_LT(agreement.doubtful, count / 100);
}

// Cosines of leaving rays: from steep to so grazing that only the offset keeps the ray off the surface.
constexpr std::array kCosines{1.0f, 0.3f, 1e-2f, 1e-4f, 1e-6f};

// Computed in double, so that the rounded direction has the right cosine up to 1e-7.
vec3 flatDirection(Random& random, const vec3& normal, float cosine) {
  const dvec3 n(normal);
  const dvec3 along = glm::normalize(glm::cross(n, dvec3(random.onSphere())));
  const double c = static_cast<double>(cosine);
  return c * n + std::sqrt(1.0 - c * c) * along;
}

struct Placement {
  const char* name;
  mat4 worldFromObject;
  mat4 objectFromPrimitive;
};

std::vector<Placement> placements(Random& random) {
  const mat4 one(1.0f);
  return {{"unchanged", one, one},
          {"small", one, glm::scale(one, vec3(1e-3f))},
          {"large", glm::scale(one, vec3(1e4f)), one},
          {"far from the object's origin", one, glm::translate(one, vec3(700, -500, 510))},
          {"far from the world's origin", glm::translate(one, vec3(700, -500, 510)), one},
          {"rotated and stretched", random.affine(3.0f, 5.0f), random.affine(3.0f, 5.0f)},
          {"flat", one, random.rotation() * glm::scale(one, vec3(1, 0.02f, 1))},
          {"flat in the world", random.rotation() * glm::scale(one, vec3(1, 1, 0.02f)), random.rotation()}};
}

// A ray that leaves a convex solid outwards never hits it again. A ray that goes inwards hits it once more.
TEST_P(Solids, AreNotHitByRaysLeavingThem) {
  Random random(200 + static_cast<std::uint32_t>(GetParam()));
  for (const Placement& place : placements(random)) {
    SCOPED_TRACE(testing::Message() << nameOf(GetParam()) << " " << place.name);
    Primitive primitive;
    primitive.type = GetParam();
    primitive.objectFromPrimitive = place.objectFromPrimitive;
    const scene::Scene scene = sceneOf(solidsOf({primitive}), place.worldFromObject);
    const mat4 worldFromPrimitive = place.worldFromObject * place.objectFromPrimitive;
    std::vector<ProbeRay> rays = raysAround(random, 2500, worldFromPrimitive), second;
    for (ProbeRay& ray : rays) ray.tmin = 0.0f, ray.tmax = 1e30f;
    const std::vector<ProbeHit> first = probe(scene, rays);
    std::vector<const ProbeHit*> from;
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first[i].t < 0.0f) continue;
      for (const float sign : {1.0f, -1.0f}) {
        const vec3 direction = flatDirection(random, sign * first[i].normal, kCosines[i % kCosines.size()]);
        second.push_back({.origin = leave(first[i], direction), .direction = direction});
        from.push_back(&first[i]);
      }
    }
    const std::vector<ProbeHit> hits = probe(scene, second);
    std::size_t outside = 0, inside = 0, wrongOutside = 0, wrongInside = 0, pastEdge = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const oracle::Ray local = toObject(second[i], place.worldFromObject);
      // first[i].normal is on the ray's side: sign +1 and front means outside.
      const bool goesOutside = from[i]->front == (i % 2 == 0);
      if (goesOutside) {
        ++outside;
        // The ray may hit a torus again, if the oracle says so.
        const bool again =
            GetParam() == PrimitiveType::torus && oracle::firstHit(oracle::crossings(primitive, local), 0.0, 1e30);
        wrongOutside += hits[i].t >= 0.0f && !(again && hits[i].front);
      } else if (!oracle::inside(primitive, local.origin)) {
        ++pastEdge;  // starts at the edge of a face, or at an apex
      } else {
        ++inside;
        wrongInside += hits[i].t < 0.0f || hits[i].front;
      }
    }
    EXPECT_EQ(wrongOutside, 0u) << "of " << outside;
    EXPECT_EQ(wrongInside, 0u) << "of " << inside;
    EXPECT_GT(outside, 300u);
    EXPECT_LE(pastEdge, inside / 300);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Solids, testing::ValuesIn(kTypes),
                         [](const auto& type) { return std::string(nameOf(type.param)); });

}  // namespace
}  // namespace quintet::test
