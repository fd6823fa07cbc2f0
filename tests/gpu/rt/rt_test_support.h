// A small ray tracer for the tests: rays in, hits out, the shaders below. Hit records carry what the
// closest-hit shader reports, so that every test sees the shader binding table at work.
#ifndef QUINTET_TESTS_GPU_RT_SUPPORT_H
#define QUINTET_TESTS_GPU_RT_SUPPORT_H

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "harness.h"
#include "rt/acceleration_structure.h"
#include "rt/pipeline.h"

namespace quintet::rt::test {

struct Ray {
  vec3 origin{0};
  float tMin = 0.0f;
  vec3 direction{0, 0, -1};
  float tMax = 1e30f;
};

struct Hit {
  float t = -1.0f;              // < 0: miss
  std::uint32_t primitive = 0;  // of the input, through the map
  std::uint32_t geometry = 0;
  std::uint32_t custom = 0;  // instance custom index
  std::uint32_t tag = 0;     // of the hit record, or the miss record
  std::uint32_t kind = 0;
  float u = 0, v = 0;
};

// The data of every hit record.
struct RecordData {
  VkDeviceAddress map = 0;
  VkDeviceAddress boxes = 0;  // for the intersection shader: boxes in input order
  std::uint32_t tag = 0;
  std::uint32_t padding = 0;
};

struct TraceOptions {
  std::uint32_t flags = 0;
  std::uint32_t mask = 0xFF;
  std::uint32_t recordOffset = 0;
  std::uint32_t recordStride = 1;
  std::uint32_t missIndex = 0;
};

// Groups of TestPipeline, for SbtRecord::group.
enum Group : std::uint32_t { kRayGeneration, kMiss, kTriangleHit, kBoxHit, kBoxHitOddOnly, kGroupCount };

inline SbtRecord hitRecord(Group group, const RecordData& data) {
  const auto bytes = std::as_bytes(std::span(&data, 1));
  return {group, {bytes.begin(), bytes.end()}};
}
// Hit records, one miss record per tag.
SbtContents contentsOf(std::vector<SbtRecord> hit, const std::vector<std::uint32_t>& missTags = {0});

// Compiles ray tracing GLSL, the common declarations put before it; throws with the diagnostics.
std::vector<std::uint32_t> compileStage(shader::Stage stage, const std::string& text);

// The pipeline with the groups above; made once per process. kBoxHit and kBoxHitOddOnly share their
// intersection shader, and differ in the any-hit shader.
const Pipeline& testPipeline();
gpu::BindlessSet& testSet();

std::vector<Hit> traceRays(const Tlas& tlas, const SbtContents& contents, const std::vector<Ray>& rays,
                           const TraceOptions& options = {});

// One BLAS and one instance of it, a triangle hit record per geometry (tag: its index).
struct SingleBlas {
  explicit SingleBlas(const BlasInput& input);
  std::vector<Hit> trace(const std::vector<Ray>& rays, const TraceOptions& options = {});
  void placeInstance();
  Blas blas;
  Tlas tlas;
  SbtContents contents;
};

// Host data that owns its arrays.
struct Mesh {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  GeometryInput geometry() const { return {.positions = positions, .triangles = triangles}; }
};
Mesh quad(float z);                                                             // x, y from -1 to 1, two triangles
Mesh randomMesh(std::size_t triangles, std::uint32_t seed, float size = 0.1f);  // in the unit cube
std::vector<Ray> randomRays(std::size_t count, std::uint32_t seed);             // from around the unit cube into it

// The oracle: closest hit by testing every triangle in double precision (Möller and Trumbore, 1997).
Hit bruteForce(const Mesh& mesh, const Ray& ray);
// Compares t and, unless two triangles are about equally near, the primitive.
void expectSameHits(const std::vector<Hit>& hits, const Mesh& mesh, const std::vector<Ray>& rays);

}  // namespace quintet::rt::test
#endif
