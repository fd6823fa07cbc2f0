// SPDX-License-Identifier: Apache-2.0
#include "rt_test_support.h"

#include "harness.h"
#include "program/linked/device_stages.h"

namespace quintet::rt::test {
namespace {

constexpr char kCommon[] = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
struct Ray { vec3 origin; float tMin; vec3 direction; float tMax; };
struct Hit { float t; uint primitive; uint geometry; uint custom; uint tag; uint kind; float u; float v; };
struct Box { vec3 low; vec3 high; };
layout(buffer_reference, scalar) readonly buffer Rays { Ray at[]; };
layout(buffer_reference, scalar) buffer Hits { Hit at[]; };
layout(buffer_reference, scalar) readonly buffer Map { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Boxes { Box at[]; };
layout(push_constant, scalar) uniform Launch {
  Rays rays; Hits hits; uint count; uint flags; uint mask; uint recordOffset; uint recordStride; uint missIndex;
} launch;
)";

constexpr char kRecord[] = R"(
layout(shaderRecordEXT, scalar) buffer Record { uint64_t map; uint64_t boxes; uint tag; uint padding; } record;
uint inputPrimitive() { return record.map == 0ul ? gl_PrimitiveID : Map(record.map).at[gl_PrimitiveID]; }
)";

constexpr char kRayGenerationText[] = R"(
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadEXT Hit hit;
void main() {
  uint i = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
  if (i >= launch.count) return;
  Ray ray = launch.rays.at[i];
  hit = Hit(-2.0, 0, 0, 0, 0, 0, 0.0, 0.0);
  traceRayEXT(tlas, launch.flags, launch.mask, launch.recordOffset, launch.recordStride, launch.missIndex, ray.origin,
              ray.tMin, ray.direction, ray.tMax, 0);
  launch.hits.at[i] = hit;
}
)";

constexpr char kMissText[] = R"(
layout(location = 0) rayPayloadInEXT Hit hit;
layout(shaderRecordEXT, scalar) buffer Record { uint tag; } record;
void main() { hit = Hit(-1.0, 0, 0, 0, record.tag, 0, 0.0, 0.0); }
)";

constexpr char kClosestHitText[] = R"(
layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 attributes;
void main() {
  hit = Hit(gl_HitTEXT, inputPrimitive(), gl_GeometryIndexEXT, gl_InstanceCustomIndexEXT, record.tag, gl_HitKindEXT,
            attributes.x, attributes.y);
}
)";

// Reports the sphere inscribed in the box: the nearer of the two intersections within the interval of the ray.
constexpr char kIntersectionText[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  Box box = Boxes(record.boxes).at[inputPrimitive()];
  vec3 toCenter = 0.5 * (box.low + box.high) - gl_ObjectRayOriginEXT;
  float radius = 0.5 * (box.high.x - box.low.x), a = dot(gl_ObjectRayDirectionEXT, gl_ObjectRayDirectionEXT);
  float b = dot(toCenter, gl_ObjectRayDirectionEXT), d = b * b - a * (dot(toCenter, toCenter) - radius * radius);
  if (d < 0.0) return;
  float nearer = (b - sqrt(d)) / a, farther = (b + sqrt(d)) / a;
  float t = nearer >= gl_RayTminEXT ? nearer : farther;
  if (t >= gl_RayTminEXT && t < gl_RayTmaxEXT) {
    attributes = vec2(0.0);
    reportIntersectionEXT(t, nearer >= gl_RayTminEXT ? 1u : 2u);
  }
}
)";

constexpr char kOddOnlyText[] = R"(
void main() { if (inputPrimitive() % 2u == 0u) ignoreIntersectionEXT; }
)";
constexpr char kAcceptAllText[] = "void main() {}\n";

struct Launch {
  VkDeviceAddress rays, hits;
  std::uint32_t count, flags, mask, recordOffset, recordStride, missIndex;
};

std::unique_ptr<Pipeline> makePipeline(const gpu::BindlessSet& set) {
  const std::string record(kRecord);
  const std::pair<shader::Stage, std::string> texts[] = {
      {shader::Stage::rayGeneration, kRayGenerationText},    {shader::Stage::miss, kMissText},
      {shader::Stage::closestHit, record + kClosestHitText}, {shader::Stage::intersection, record + kIntersectionText},
      {shader::Stage::anyHit, record + kAcceptAllText},      {shader::Stage::anyHit, record + kOddOnlyText},
  };
  std::vector<std::vector<std::uint32_t>> spirv;
  PipelineOptions options;
  for (const auto& [stage, text] : texts) spirv.push_back(compileStage(stage, text));
  for (std::size_t k = 0; k < spirv.size(); ++k)
    options.stages.push_back({program::vulkanStage(texts[k].first), spirv[k], "test"});
  options.groups = {{.general = 0},
                    {.general = 1},
                    {.closestHit = 2},
                    {.closestHit = 2, .anyHit = 4, .intersection = 3},
                    {.closestHit = 2, .anyHit = 5, .intersection = 3}};
  options.name = "test pipeline";
  return std::make_unique<Pipeline>(quintet::test::testContext(), set, options, nullptr);
}

struct Objects {
  gpu::BindlessSet set{quintet::test::testContext(), 0, 128};
  std::unique_ptr<Pipeline> pipeline = makePipeline(set);
};
std::unique_ptr<Objects> objects;

// Registered after the environment of the harness, so it is torn down before the device.
struct Cleaner : testing::Environment {
  void TearDown() override { objects.reset(); }
};

Objects& testObjects() {
  if (!objects) {
    objects = std::make_unique<Objects>();
    testing::AddGlobalTestEnvironment(new Cleaner);
  }
  return *objects;
}

}  // namespace

std::vector<std::uint32_t> compileStage(shader::Stage stage, const std::string& text) {
  static const shader::Compiler compiler{shader::CompilerOptions{.cacheFolder = quintet::test::shaderCache()}};
  shader::Source source;
  source.stage = stage;
  source.text = kCommon + text;
  source.name = "test" + std::string(shader::stageExtension(stage));
  shader::Result result = compiler.compile(source);
  std::string messages;
  for (const Diagnostic& d : result.diagnostics) messages += "\n" + d.format();
  if (!result.ok()) throw std::runtime_error("the shader does not compile:" + messages);
  return std::move(result.spirv);
}

SbtContents contentsOf(std::vector<SbtRecord> hit, const std::vector<std::uint32_t>& missTags) {
  SbtContents contents;
  contents.rayGeneration.group = kRayGeneration;
  contents.hit = std::move(hit);
  for (const std::uint32_t tag : missTags) {
    const auto bytes = std::as_bytes(std::span(&tag, 1));
    contents.miss.push_back({kMiss, {bytes.begin(), bytes.end()}});
  }
  return contents;
}

std::vector<Hit> traceRays(const Tlas& tlas, const SbtContents& contents, const std::vector<Ray>& rays,
                           const TraceOptions& options) {
  gpu::Context& context = quintet::test::testContext();
  const Pipeline& pipeline = testPipeline();
  const ShaderBindingTable table(context, pipeline, contents, "test table");
  const gpu::Buffer rayBuffer = gpu::makeBufferOf(context, rays, 0, "rays");
  const gpu::Buffer hitBuffer = gpu::makeBufferOf(context, std::vector<Hit>(rays.size()), 0, "hits");
  testSet().setAccelerationStructure(tlas.handle());
  const auto count = static_cast<std::uint32_t>(rays.size());
  const Launch launch{rayBuffer.address(),  hitBuffer.address(), count,
                      options.flags,        options.mask,        options.recordOffset,
                      options.recordStride, options.missIndex};
  context.submitAndWait([&](gpu::Commands& commands) {
    trace(commands, pipeline, table, std::as_bytes(std::span(&launch, 1)), 64, (count + 63) / 64);
  });
  return hitBuffer.downloadAs<Hit>(rays.size());
}

SingleBlas::SingleBlas(const BlasInput& input)
    : blas(std::move(BlasBuilder(quintet::test::testContext()).build({&input, 1})[0])),
      tlas(quintet::test::testContext(), 1) {
  std::vector<SbtRecord> hit;
  for (std::size_t g = 0; g < input.geometries.size(); ++g)
    hit.push_back(hitRecord(kTriangleHit, {.map = blas.primitiveMap(g), .tag = static_cast<std::uint32_t>(g)}));
  contents = contentsOf(std::move(hit));
  buildTlas();
}

void SingleBlas::buildTlas() {
  const InstanceInput instance{.blas = &blas};
  tlas.buildAndWait({&instance, 1});
}

std::vector<Hit> SingleBlas::trace(const std::vector<Ray>& rays, const TraceOptions& options) {
  return traceRays(tlas, contents, rays, options);
}

Mesh quad(float z) { return {{{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}}, {{0, 1, 2}, {0, 2, 3}}}; }

Mesh randomMesh(std::size_t triangles, std::uint32_t seed, float size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  Mesh mesh;
  for (std::uint32_t k = 0; k < triangles; ++k) {
    const vec3 corner = point();
    for (int i = 0; i < 3; ++i) mesh.positions.push_back(corner + size * (point() - 0.5f));
    mesh.triangles.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  }
  return mesh;
}

std::vector<Ray> randomRays(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = 4.0f * point() - 1.5f;
    ray.direction = point() - ray.origin;
  }
  return rays;
}

Hit bruteForce(const Mesh& mesh, const Ray& ray) {
  using glm::dvec3;
  Hit best;
  double bestT = ray.tMax;
  const dvec3 origin(ray.origin), direction(ray.direction);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const dvec3 a(mesh.positions[mesh.triangles[k][0]]);
    const dvec3 ab = dvec3(mesh.positions[mesh.triangles[k][1]]) - a,
                ac = dvec3(mesh.positions[mesh.triangles[k][2]]) - a;
    const dvec3 p = cross(direction, ac), s = origin - a, q = cross(s, ab);
    const double determinant = dot(ab, p);
    if (determinant == 0.0) continue;
    const double u = dot(s, p) / determinant, v = dot(direction, q) / determinant, t = dot(ac, q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || !(t >= ray.tMin) || !(t < bestT)) continue;
    bestT = t;
    best.t = static_cast<float>(t);
    best.primitive = static_cast<std::uint32_t>(k);
    best.u = static_cast<float>(u);
    best.v = static_cast<float>(v);
  }
  return best;
}

void expectSameHits(const std::vector<Hit>& hits, const Mesh& mesh, const std::vector<Ray>& rays) {
  ASSERT_EQ(hits.size(), rays.size());
  std::size_t different = 0, hitCount = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Hit expected = bruteForce(mesh, rays[k]);
    hitCount += expected.t >= 0.0f;
    const bool sameT = (hits[k].t < 0.0f) == (expected.t < 0.0f) && std::abs(hits[k].t - expected.t) < 1e-4f;
    const bool samePrimitive = hits[k].primitive == expected.primitive && std::abs(hits[k].u - expected.u) < 2e-2f &&
                               std::abs(hits[k].v - expected.v) < 2e-2f;
    if (!sameT || (expected.t >= 0.0f && !samePrimitive)) ++different;
  }
  // Rays close to an edge or to the intersection of two triangles are ambiguous in float precision.
  EXPECT_LE(different, rays.size() / 500);
  EXPECT_GT(hitCount, rays.size() / 20) << "the test traces too little";
}

gpu::BindlessSet& testSet() { return testObjects().set; }
const Pipeline& testPipeline() { return *testObjects().pipeline; }

}  // namespace quintet::rt::test
