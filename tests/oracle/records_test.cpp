// SPDX-License-Identifier: Apache-2.0
// The shader binding table: the record of a hit, a miss or a callable, and its data. Vulkan 1.3, "Hit Shader Binding
// Table": record = instance offset (24 bits) + geometry index · stride (4 bits) + offset (4 bits). The miss index has
// 16 bits. Higher bits of the arguments are not used.
#include <algorithm>

#include "bare.h"
#include "checks.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle::records_test {
namespace {

// Returns geometries with one triangle each, at distances of 4 in x.
std::vector<Triangles> geometries(std::uint32_t count) {
  std::vector<Triangles> result;
  for (std::uint32_t g = 0; g < count; ++g) result.push_back(triangleAt(4.0f * static_cast<float>(g), 0, 0));
  return result;
}

// Every offset and stride of 4 bits, with 5 geometries and 3 instances.
TEST(Records, AddsInstanceOffsetGeometryTimesStrideAndRayOffset) {
  constexpr std::uint32_t kGeometries = 5, kInstanceOffsets[] = {0, 7, 100};
  Scene scene;
  const std::size_t blas = scene.addBlas(geometries(kGeometries));
  for (std::uint32_t k = 0; k < 3; ++k)
    scene.add(blas, {.worldFromObject = glm::translate(mat4(1.0f), vec3(0, 10.0f * static_cast<float>(k), 0)),
                     .recordOffset = kInstanceOffsets[k]});
  Table table{.miss = {recordOf(0, 0u)}, .hit = {}};
  for (std::uint32_t k = 0; k < 100 + 15 + 4 * 15 + 1; ++k) table.hit.push_back(recordOf(kProbeTriangles, 1000 + k));
  std::vector<ProbeRay> rays;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t offset = 0; offset < 16; ++offset)
    for (std::uint32_t stride = 0; stride < 16; ++stride)
      for (std::uint32_t instance = 0; instance < 3; ++instance)
        for (std::uint32_t geometry = 0; geometry < kGeometries; ++geometry) {
          rays.push_back({.origin = {4.0f * static_cast<float>(geometry), 10.0f * static_cast<float>(instance), 2},
                          .offset = offset,
                          .stride = stride});
          expected.push_back(1000 + kInstanceOffsets[instance] + geometry * stride + offset);
        }
  const auto hits = traceProbe(scene, rays, table);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k)
    checks.equal(hits[k].tag, expected[k], "offset {}, stride {}, geometry {}", rays[k].offset, rays[k].stride,
                 hits[k].geometry);
  checks.done();
}

TEST(Records, IgnoresHigherBitsOfOffsetAndStride) {
  Scene scene;
  scene.add(scene.addBlas(geometries(3)));
  Table table{.miss = {recordOf(0, 0u)}, .hit = {}};
  for (std::uint32_t k = 0; k < 64; ++k) table.hit.push_back(recordOf(kProbeTriangles, 1000 + k));
  std::vector<ProbeRay> rays;
  std::vector<std::uint32_t> expected;
  for (const std::uint32_t offset : {0x10u, 0x13u, 0xFFFFFFF5u, 0x80000002u, 0x2u})
    for (const std::uint32_t stride : {0x10u, 0x21u, 0xFFFFFFF2u, 0x3u})
      for (std::uint32_t geometry = 0; geometry < 3; ++geometry) {
        rays.push_back({.origin = {4.0f * static_cast<float>(geometry), 0, 2}, .offset = offset, .stride = stride});
        expected.push_back(1000 + (offset & 15) + geometry * (stride & 15));
      }
  const auto hits = traceProbe(scene, rays, table);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k)
    checks.equal(hits[k].tag, expected[k], "offset {:#x}, stride {:#x}", rays[k].offset, rays[k].stride);
  checks.done();
}

TEST(Records, Uses16BitsOfTheMissIndex) {
  Table table{.miss = {}, .hit = {recordOf(kProbeTriangles, 0u)}};
  for (std::uint32_t k = 0; k < 65536; ++k) table.miss.push_back(recordOf(0, k ^ 0xABCDEF));
  Scene scene;
  std::vector<ProbeRay> rays;
  for (std::uint32_t bit = 0; bit < 16; ++bit) rays.push_back({.miss = 1u << bit});
  for (const std::uint32_t index : {0u, 0xFFFFu, 0xFFFEu, 0x5555u, 0xAAAAu, 1000u, 54321u})
    rays.push_back({.miss = index});
  const std::size_t within = rays.size();
  for (const std::uint32_t index : {0x10000u, 0x12345u, 0xFFFFFFFFu, 0x80000000u}) rays.push_back({.miss = index});
  const auto hits = traceProbe(scene, rays, table);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    checks.equal(hits[k].end, kMissed, "miss index {:#x}", rays[k].miss);
    const std::uint32_t expected = (rays[k].miss & 0xFFFF) ^ 0xABCDEF;
    checks.equal(hits[k].tag, expected, "miss index {:#x}{}", rays[k].miss,
                 k < within ? "" : " (upper bits are not used)");
  }
  checks.done();
}

// Instance offsets of up to 24 bits, without and with the largest stride and offset. Of the 2^24 + 256 records of the
// table only the used ones are written.
TEST(Records, Uses24BitsOfTheInstanceOffset) {
  const gpu::RayTracingLimits& limits = test::testContext().info().limits;
  const rt::SbtContents contents =
      probe().contents({.miss = {recordOf(0, 0u)}, .hit = {recordOf(kProbeTriangles, 0u)}});
  const BareTable small(contents, probe().pipeline().groupHandles());
  const std::uint64_t stride = small.regions.hit.stride, count = (1u << 24) + 256;
  gpu::Buffer large(test::testContext(), {.size = stride * count,
                                          .usage = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR,
                                          .alignment = limits.baseAlignment,
                                          .name = "large hit table"});

  constexpr std::uint32_t kGeometries = 4;
  std::vector<std::uint32_t> offsets = {0, 0xFFFFFF, 0xFFFFFE, 0x555555, 0xAAAAAA, 0x010000};
  for (std::uint32_t bit = 0; bit < 24; bit += 3) offsets.push_back(1u << bit);
  Scene scene;
  const std::size_t blas = scene.addBlas(geometries(kGeometries));
  std::vector<ProbeRay> rays;
  std::vector<std::uint32_t> expected;
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const float y = 10.0f * static_cast<float>(k);
    scene.add(blas, {.worldFromObject = glm::translate(mat4(1.0f), vec3(0, y, 0)), .recordOffset = offsets[k]});
    for (std::uint32_t geometry = 0; geometry < kGeometries; ++geometry)
      for (const std::uint32_t ray : {0u, 15u}) {
        rays.push_back({.origin = {4.0f * static_cast<float>(geometry), y, 2}, .offset = ray, .stride = ray});
        expected.push_back(offsets[k] + geometry * ray + ray);
      }
  }
  std::vector<std::byte> record(limits.handleSize + 4);
  const std::span handles = probe().pipeline().groupHandles();
  std::memcpy(record.data(), handles.data() + contents.hit[0].group * limits.handleSize, limits.handleSize);
  std::vector<std::uint32_t> written = expected;
  std::ranges::sort(written);
  written.erase(std::unique(written.begin(), written.end()), written.end());
  for (const std::uint32_t index : written) {
    const std::uint32_t tag = index ^ 0x5A5A5A5A;
    std::memcpy(record.data() + limits.handleSize, &tag, 4);
    large.upload(record, index * stride);
  }
  BareRegions regions = small.regions;
  regions.hit = {large.address(), stride, large.size()};
  const auto bytes = bareTrace(probe().pipeline().handle(), regions, scene.handle(), std::as_bytes(std::span(rays)),
                               static_cast<std::uint32_t>(rays.size()), sizeof(ProbeHit));
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    ProbeHit hit;
    std::memcpy(&hit, bytes.data() + k * sizeof hit, sizeof hit);
    checks.equal(hit.end, kHit, "record {:#x}", expected[k]);
    checks.equal(hit.tag ^ 0x5A5A5A5A, expected[k], "record of offset and stride {}", rays[k].offset);
  }
  checks.done();
}

// ---- Data of the records

constexpr std::uint32_t kWords = 24;
constexpr char kDataCommon[] = R"(
struct Input { float x; uint miss; };
struct Output { uint stage; uint words[24]; uint any[24]; uint intersection[24]; };
#define RECORD layout(shaderRecordEXT, scalar) buffer RecordData { uint words[24]; } record;
)";
constexpr char kDataRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint nothing;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, ray.miss, vec3(ray.x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
}
)";
std::string copyRecord(const char* member, const std::string& before = {}, const std::string& after = {}) {
  return "RECORD\n" + before + "void main() {\n  for (uint k = 0u; k < 24u; ++k) launch.outputs.at[launchIndex()]." +
         member + "[k] = record.words[k];\n" + after + "}\n";
}

std::array<std::uint32_t, kWords> wordsOf(std::uint32_t record) {
  std::array<std::uint32_t, kWords> words;
  for (std::uint32_t k = 0; k < kWords; ++k) words[k] = (record + 1) * 1000003u + k * 7919u;
  return words;
}

struct DataResult {
  std::uint32_t stage;
  std::array<std::uint32_t, kWords> words, any, intersection;
};

// Records with 96 bytes of data, one for each of ten instances of triangles and of boxes.
TEST(Records, ReadsDataInEveryStage) {
  const std::string end = "  launch.outputs.at[launchIndex()].stage = ";
  const HitGroupText triangles{.closestHit = copyRecord("words", {}, end + "1u;\n"), .anyHit = copyRecord("any")};
  HitGroupText boxes = triangles;
  boxes.intersection = copyRecord("intersection", "hitAttributeEXT vec2 a;\n",
                                  "  a = vec2(0.0);\n  reportIntersectionEXT(gl_RayTminEXT + 2.0, 1u);\n");
  const Program program({.common = kDataCommon,
                         .rayGeneration = kDataRayGeneration,
                         .miss = {copyRecord("words", {}, end + "2u;\n")},
                         .hit = {triangles, boxes}});
  constexpr std::uint32_t kInstances = 20, kMisses = 5;
  Table table;
  for (std::uint32_t k = 0; k < kMisses; ++k) table.miss.push_back(recordOf(0, wordsOf(100 + k)));
  for (std::uint32_t k = 0; k < kInstances; ++k) table.hit.push_back(recordOf(k % 2, wordsOf(k)));
  Scene scene;
  const std::size_t blas[] = {scene.addBlas({triangleAt(0, 0, 0, 1, false)}),
                              scene.addBlas({Boxes{{boxAt({0, 0, 0})}, false}})};
  struct Aim {
    float x;
    std::uint32_t miss;
  };
  std::vector<Aim> rays;
  for (std::uint32_t k = 0; k < kInstances; ++k) {
    scene.add(blas[k % 2], {.worldFromObject = glm::translate(mat4(1.0f), vec3(4.0f * static_cast<float>(k), 0, 0)),
                            .recordOffset = k});
    rays.push_back({4.0f * static_cast<float>(k), k % kMisses});
  }
  for (std::uint32_t k = 0; k < kMisses; ++k) rays.push_back({-100, k});
  const auto results = run<DataResult>(program, scene, rays, {.table = &table});
  Checks checks;
  for (std::uint32_t k = 0; k < rays.size(); ++k) {
    const bool hit = k < kInstances;
    const auto expected = wordsOf(hit ? k : 100 + k - kInstances);
    checks.equal(results[k].stage, hit ? 1u : 2u, "ray {}: stage", k);
    for (std::uint32_t w = 0; w < kWords; ++w) {
      checks.equal(results[k].words[w], expected[w], "ray {}: word {} of {}", k, w, hit ? "closest-hit" : "miss");
      if (hit) checks.equal(results[k].any[w], expected[w], "ray {}: word {} of any-hit", k, w);
      if (hit && k % 2) checks.equal(results[k].intersection[w], expected[w], "ray {}: word {} of intersection", k, w);
    }
  }
  checks.done();
}

// A record of zeros calls no shader, and the payload does not change.
TEST(Records, CallsNoShaderForUnusedRecords) {
  Scene scene;
  const std::size_t blas = scene.addBlas({triangleAt(0, 0, 0)});
  scene.add(blas);
  scene.add(blas, {.worldFromObject = glm::translate(mat4(1.0f), vec3(4, 0, 0)), .recordOffset = 1});
  rt::SbtContents contents = probe().contents({.miss = {recordOf(0, 0u), recordOf(0, 0u)},
                                               .hit = {recordOf(kProbeTriangles, 5u), recordOf(kProbeTriangles, 6u)}});
  contents.miss[1].group = contents.hit[1].group = rt::SbtRecord::kUnusedGroup;
  const BareTable table(contents, probe().pipeline().groupHandles());
  std::vector<ProbeRay> rays;
  for (const float x : {0.0f, 4.0f, 50.0f})
    for (const std::uint32_t miss : {0u, 1u}) rays.push_back({.origin = {x, 0, 2}, .miss = miss});
  const auto bytes = bareTrace(probe().pipeline().handle(), table.regions, scene.handle(),
                               std::as_bytes(std::span(rays)), 6, sizeof(ProbeHit));
  const std::uint32_t expected[] = {kHit, kHit, kNothing, kNothing, kMissed, kNothing};
  Checks checks;
  for (std::size_t k = 0; k < 6; ++k) {
    ProbeHit hit;
    std::memcpy(&hit, bytes.data() + k * sizeof hit, sizeof hit);
    checks.equal(hit.end, expected[k], "ray {}", k);
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::records_test
