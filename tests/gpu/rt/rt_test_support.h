// SPDX-License-Identifier: Apache-2.0
// A small ray tracer that maps rays to hits. The data of hit records is part of the hits, so every test also tests the
// shader binding table.
#ifndef QUINTET_TESTS_GPU_RT_SUPPORT_H
#define QUINTET_TESTS_GPU_RT_SUPPORT_H

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "harness.h"
#include "rt/blas_builder.h"
#include "rt/pipeline.h"
#include "rt/tlas.h"
#include "shader/compiler.h"

namespace quintet::rt::test {

struct Ray {
  vec3 origin{0};
  float tMin = 0.0f;
  vec3 direction{0, 0, -1};
  float tMax = 1e30f;
};

struct Hit {
  float t = -1.0f;              // negative for a miss
  std::uint32_t primitive = 0;  // index in the input, through the map
  std::uint32_t geometry = 0;
  std::uint32_t custom = 0;  // instance custom index
  std::uint32_t tag = 0;     // of the hit or miss record
  std::uint32_t kind = 0;
  float u = 0, v = 0;
};

// The data of a hit record.
struct RecordData {
  VkDeviceAddress map = 0;
  VkDeviceAddress boxes = 0;  // boxes in input order, for the intersection shader
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

// Groups of testPipeline(), for SbtRecord::group.
enum Group : std::uint32_t { kRayGeneration, kMiss, kTriangleHit, kBoxHit, kBoxHitOddOnly, kGroupCount };

inline SbtRecord hitRecord(Group group, const RecordData& data) {
  const auto bytes = std::as_bytes(std::span(&data, 1));
  return {group, {bytes.begin(), bytes.end()}};
}
// Returns a table with these hit records and one miss record per tag.
SbtContents contentsOf(std::vector<SbtRecord> hit, const std::vector<std::uint32_t>& missTags = {0});

// Compiles ray tracing GLSL after the common declarations. Throws an exception with the diagnostics.
std::vector<std::uint32_t> compileStage(shader::Stage stage, const std::string& text);

// The pipeline with the groups above, created once per process. kBoxHit and kBoxHitOddOnly share an intersection shader
// and have different any-hit shaders.
const Pipeline& testPipeline();
gpu::BindlessSet& testSet();

std::vector<Hit> traceRays(const Tlas& tlas, const SbtContents& contents, const std::vector<Ray>& rays,
                           const TraceOptions& options = {});

// One BLAS with one instance and a triangle hit record per geometry, whose tag is the index of the geometry.
struct SingleBlas {
  explicit SingleBlas(const BlasInput& input);
  std::vector<Hit> trace(const std::vector<Ray>& rays, const TraceOptions& options = {});
  void buildTlas();
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
Mesh quad(float z);                                                             // two triangles with x and y in [-1,1]
Mesh randomMesh(std::size_t triangles, std::uint32_t seed, float size = 0.1f);  // in the unit cube
std::vector<Ray> randomRays(std::size_t count, std::uint32_t seed);             // from outside the unit cube into it

// Reference: finds the closest hit by testing every triangle in double precision (Möller and Trumbore, 1997).
Hit bruteForce(const Mesh& mesh, const Ray& ray);
// Compares t and, unless two triangles are at nearly the same distance, the primitive.
void expectSameHits(const std::vector<Hit>& hits, const Mesh& mesh, const std::vector<Ray>& rays);

}  // namespace quintet::rt::test
#endif
