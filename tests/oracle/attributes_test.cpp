// SPDX-License-Identifier: Apache-2.0
// Hit attributes must belong to the committed hit, not to later candidates. Where they do not, the two workarounds of
// the shader library must work: recompute the attributes in closest-hit from the ray and t (shaders/quintet/hit.glsl),
// or write them only for t in range and use no any-hit shader.
#include <random>

#include "checks.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle::attributes_test {
namespace {

constexpr std::uint32_t kLayers = 8;

struct Ray {
  vec3 origin{0};
  vec3 direction{0};
  std::uint32_t ignored = 0;  // one bit per layer
  std::uint32_t flags = 0;
};
struct Result {
  float t;
  std::uint32_t layer;
  vec2 attributes;  // as the closest-hit shader reads them
  vec2 recomputed;
};

constexpr char kCommon[] = R"(
struct Input { vec3 origin; vec3 direction; uint ignored; uint flags; };
struct Output { float t; uint layer; vec2 attributes; vec2 recomputed; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vertices { vec3 at[]; };
)";
constexpr char kRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT Output result;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  result = Output(-2.0, 0u, vec2(0.0), vec2(0.0));
  traceRayEXT(tlas, ray.flags, 0xFFu, 0u, 0u, 0u, ray.origin, 0.0, ray.direction, 1e9, 0);
  launch.outputs.at[launchIndex()] = result;
}
)";
constexpr char kMiss[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
void main() { result.t = -1.0; }
)";
constexpr char kAnyHit[] = R"(
void main() {
  if ((launch.inputs.at[launchIndex()].ignored >> gl_PrimitiveID & 1u) != 0u) ignoreIntersectionEXT;
}
)";
// Reads the barycentrics of the candidate, like an alpha test.
constexpr char kTriangleAnyHit[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  bool inside = attributes.x >= 0.0 && attributes.y >= 0.0 && attributes.x + attributes.y <= 1.0;
  if (!inside || (launch.inputs.at[launchIndex()].ignored >> gl_PrimitiveID & 1u) != 0u) ignoreIntersectionEXT;
}
)";
// Computes barycentrics as ratios of areas in object space.
constexpr char kTriangleClosestHit[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
hitAttributeEXT vec2 attributes;
void main() {
  Vertices vertices = Vertices(launch.address[0]);
  vec3 a = vertices.at[3 * gl_PrimitiveID], ab = vertices.at[3 * gl_PrimitiveID + 1] - a, ac = vertices.at[3 * gl_PrimitiveID + 2] - a;
  vec3 p = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT - a, n = cross(ab, ac);
  result = Output(gl_HitTEXT, gl_PrimitiveID, attributes, vec2(dot(cross(p, ac), n), dot(cross(ab, p), n)) / dot(n, n));
}
)";
// Layer i is the plane z = -2 i, inside a box. The attributes are (layer, t).
constexpr char kBoxClosestHit[] = R"(
layout(location = 0) rayPayloadInEXT Output result;
hitAttributeEXT vec2 attributes;
void main() {
  float z = gl_ObjectRayOriginEXT.z + gl_HitTEXT * gl_ObjectRayDirectionEXT.z;
  result = Output(gl_HitTEXT, gl_PrimitiveID, attributes, vec2(round(-0.5 * z), gl_HitTEXT));
}
)";
std::string intersection(bool guarded) {
  return std::string(R"(
hitAttributeEXT vec2 attributes;
void main() {
  float t = (-2.0 * float(gl_PrimitiveID) - gl_ObjectRayOriginEXT.z) / gl_ObjectRayDirectionEXT.z;
)") + (guarded ? "  if (t < gl_RayTminEXT || t >= gl_RayTmaxEXT) return;\n" : "") +
         "  attributes = vec2(gl_PrimitiveID, t);\n  reportIntersectionEXT(t, 1u);\n}\n";
}

// Rays from both sides for every set of ignored layers.
std::vector<Ray> allRays(std::uint32_t flags) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-0.2f, 0.2f);
  std::vector<Ray> rays;
  for (std::uint32_t ignored = 0; ignored < 1u << kLayers; ++ignored)
    for (const bool below : {false, true}) {
      const vec3 from(unit(random), unit(random), below ? -20.0f : 5.0f);
      rays.push_back({from, {0.01f * unit(random), 0.01f * unit(random), below ? 1.0f : -1.0f}, ignored, flags});
    }
  return rays;
}

// Returns the nearest layer that is not ignored; kLayers if all are ignored.
std::uint32_t expectedLayer(const Ray& ray) {
  const bool below = ray.direction.z > 0;
  for (std::uint32_t k = 0; k < kLayers; ++k) {
    const std::uint32_t layer = below ? kLayers - 1 - k : k;
    if ((ray.flags & kOpaque) || !(ray.ignored >> layer & 1)) return layer;
  }
  return kLayers;
}

const Program& program() {
  static std::unique_ptr<Program> made;
  if (!made) {
    const std::string guarded = intersection(true), plain = intersection(false);
    made = std::make_unique<Program>(
        ProgramText{.common = kCommon,
                    .rayGeneration = kRayGeneration,
                    .miss = {kMiss},
                    .hit = {{.closestHit = kTriangleClosestHit, .anyHit = kTriangleAnyHit},
                            {.closestHit = kBoxClosestHit, .anyHit = kAnyHit, .intersection = plain},
                            {.closestHit = kBoxClosestHit, .intersection = guarded}}});
    atEnd([] { made.reset(); });
  }
  return *made;
}

// The layers are triangles of different shapes, so a point has different barycentrics in each. They are tilted, so that
// their boxes overlap and a builder cannot sort them along the ray. Along the test rays they keep their order.
Triangles layers() {
  Triangles result{.opaque = false};
  for (std::uint32_t k = 0; k < kLayers; ++k) {
    const float z = -2.0f * static_cast<float>(k), grow = 3.0f + 0.5f * static_cast<float>(k * 5 % kLayers);
    const float slope = k % 2 ? 3.0f : -3.0f;
    for (const vec2 corner : {vec2(-grow, -grow), vec2(grow, -2.5f), vec2(0.4f, grow)})
      result.positions.push_back(vec3(corner, z + slope * corner.x));
    result.indices.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  }
  return result;
}

enum class Source { attributes, recomputed };

void checkTriangles(Source source) {
  const Triangles triangles = layers();
  Scene scene;
  scene.add(scene.addBlas({triangles}));
  const gpu::Buffer vertices = gpu::makeBufferOf(test::testContext(), triangles.positions, 0, "vertices");
  const std::vector<Ray> rays = allRays(0);
  const auto results = run<Result>(program(), scene, rays, {.addresses = {vertices.address()}});
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t layer = expectedLayer(rays[k]);
    if (layer == kLayers) {
      checks.equal(results[k].t, -1.0f, "ray {} hits nothing", k);
      continue;
    }
    checks.equal(results[k].layer, layer, "ray {}: layer", k);
    const vec3 *v = &triangles.positions[3 * layer], ab = v[1] - v[0], ac = v[2] - v[0], n = glm::cross(ab, ac);
    const float t = glm::dot(v[0] - rays[k].origin, n) / glm::dot(rays[k].direction, n);
    checks.near(results[k].t, t, 1e-4f, "ray {}: t", k);
    const vec3 p = rays[k].origin + t * rays[k].direction;
    const vec2 expected =
        vec2(glm::dot(glm::cross(p - v[0], ac), n), glm::dot(glm::cross(ab, p - v[0]), n)) / glm::dot(n, n);
    const vec2 got = source == Source::attributes ? results[k].attributes : results[k].recomputed;
    const bool right = glm::all(glm::lessThan(glm::abs(got - expected), vec2(1e-4f)));
    checks.that(right, "ray {}: barycentrics {} instead of {}", k, textOf(got), textOf(expected));
  }
  checks.done();
}

// lavapipe is correct for triangles alone, but not for triangles next to boxes.
TEST(Attributes, KeepsBarycentricsOfTheCommittedTriangle) { checkTriangles(Source::attributes); }
TEST(Attributes, RecomputesBarycentricsFromTheRay) { checkTriangles(Source::recomputed); }

// A triangle in front of a plane that the intersection shader of a box around both reports. The plane is out of range
// after the triangle is committed.
void checkTriangleBeforeBox(Source source, const KnownQuirk* quirk) {
  Triangles triangle = triangleAt(0, 0, 0);
  for (vec3& p : triangle.positions) p.z = 0.25f + 1.25f * p.x;  // its box starts in front of the other box
  const gpu::Buffer vertices = gpu::makeBufferOf(test::testContext(), triangle.positions, 0, "vertices");
  Checks checks;
  for (const bool boxFirst : {false, true}) {
    Scene scene;
    const std::size_t blas[] = {scene.addBlas({triangle}), scene.addBlas({Boxes{{boxAt({0, 0, 0})}}})};
    for (const bool second : {false, true}) scene.add(blas[second != boxFirst], {.recordOffset = second != boxFirst});
    std::vector<Ray> rays;
    for (int k = 0; k < 64; ++k)
      rays.push_back(
          {{0.2f - 0.05f * static_cast<float>(k % 8), 0.03f * static_cast<float>(k / 8 - 4), 2}, {0, 0, -1}});
    const auto results = run<Result>(program(), scene, rays, {.addresses = {vertices.address()}});
    for (std::size_t k = 0; k < rays.size(); ++k) {
      checks.near(results[k].t, 1.75f - 1.25f * rays[k].origin.x, 1e-5f, "ray {}: t", k);
      const float w = 0.5f * (rays[k].origin.y + 1), u = 0.5f * (rays[k].origin.x + 1 - w);
      const vec2 got = source == Source::attributes ? results[k].attributes : results[k].recomputed;
      const bool right = glm::all(glm::lessThan(glm::abs(got - vec2(u, w)), vec2(1e-5f)));
      if (quirk)
        checks.quirkThat(right, "ray {}: barycentrics {} instead of ({} {})", k, textOf(got), u, w);
      else
        checks.that(right, "ray {}: barycentrics {} instead of ({} {})", k, textOf(got), u, w);
    }
  }
  quirk ? checks.done(*quirk) : checks.done();
}

TEST(Attributes, KeepsBarycentricsNextToABox) { checkTriangleBeforeBox(Source::attributes, &kLooseAttributes); }
TEST(Attributes, RecomputesBarycentricsNextToABox) { checkTriangleBeforeBox(Source::recomputed, nullptr); }

void checkBoxes(std::uint32_t group, std::uint32_t flags, Source source, const KnownQuirk* quirk) {
  Scene scene;
  Boxes boxes{.opaque = false};
  for (std::uint32_t k = 0; k < kLayers; ++k) boxes.boxes.push_back(boxAt({0, 0, -2.0f * static_cast<float>(k)}, 1.5f));
  scene.add(scene.addBlas({boxes}), {.recordOffset = group});
  const std::vector<Ray> rays = allRays(flags);
  const auto results = run<Result>(program(), scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t layer = expectedLayer(rays[k]);
    if (layer == kLayers) {
      checks.equal(results[k].t, -1.0f, "ray {} hits nothing", k);
      continue;
    }
    checks.equal(results[k].layer, layer, "ray {}: layer", k);
    const vec2 got = source == Source::attributes ? results[k].attributes : results[k].recomputed;
    const bool right = got == vec2(layer, results[k].t);
    if (quirk)
      checks.quirkThat(right, "ray {}: attributes {} of layer {}", k, textOf(got), layer);
    else
      checks.that(right, "ray {}: attributes {} of layer {}", k, textOf(got), layer);
  }
  quirk ? checks.done(*quirk) : checks.done();
}

TEST(Attributes, KeepsAttributesOfBoxesWithAnAnyHitShader) { checkBoxes(1, 0, Source::attributes, &kLooseAttributes); }
TEST(Attributes, RecomputesAttributesOfBoxesWithAnAnyHitShader) { checkBoxes(1, 0, Source::recomputed, nullptr); }
TEST(Attributes, KeepsAttributesIfBoxesReportOutOfRange) {
  checkBoxes(1, kOpaque, Source::attributes, &kLooseAttributes);
}
TEST(Attributes, KeepsAttributesThatAreWrittenOnlyInRange) { checkBoxes(2, kOpaque, Source::attributes, nullptr); }

}  // namespace
}  // namespace quintet::oracle::attributes_test
