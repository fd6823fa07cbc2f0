// SPDX-License-Identifier: Apache-2.0
// Integer arithmetic of ray tracing shaders, with the environment variables that the library sets for drivers and, in a
// separate process, without them.
#include "checks.h"
#include "child.h"
#include "probe.h"

namespace quintet::oracle::integer_test {
namespace {

constexpr std::uint32_t kWidth = 512, kHeight = 64;

struct Result {
  std::uint32_t pixelX, pixelY;    // pixels of 64 × 8 blocks, swapped
  std::uint32_t spread, unspread;  // bits interleaved (Morton) and back
  std::uint32_t a, b, c, d;
  std::uint32_t hit;     // computed in closest-hit, from a payload
  std::uint32_t stored;  // number of invocations with this swapped pixel
};

constexpr char kCommon[] = R"(
struct Input { uint unused; };
struct Output { uint pixelX; uint pixelY; uint spread; uint unspread; uint a; uint b; uint c; uint d; uint hit; uint stored; };
uint hash(uint x) { x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu; return x ^ (x >> 16); }
uvec2 swapped(uint x, uint y) { return uvec2(((x >> 6) * 8u + (y & 7u)) * 8u + (x & 7u), (y & ~7u) + ((x & 63u) >> 3)); }
uint mix3(uint h, uint i) { return bitfieldExtract(h, int(i & 15u), 9) ^ (h << (i & 7u)) ^ bitfieldReverse(h) ^ (h / (1u + (i & 63u))); }
)";
constexpr char kRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uvec2 payload;
uint spread(uint x) {
  x = (x | (x << 8)) & 0x00FF00FFu; x = (x | (x << 4)) & 0x0F0F0F0Fu; x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}
uint unspread(uint x) {
  x &= 0x55555555u; x = (x | (x >> 1)) & 0x33333333u; x = (x | (x >> 2)) & 0x0F0F0F0Fu;
  x = (x | (x >> 4)) & 0x00FF00FFu; return (x | (x >> 8)) & 0x0000FFFFu;
}
void main() {
  uint x = gl_LaunchIDEXT.x, y = gl_LaunchIDEXT.y, i = y * gl_LaunchSizeEXT.x + x, h = hash(i);
  uvec2 pixel = swapped(x, y);
  payload = uvec2(h, i);
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
  launch.outputs.at[i].pixelX = pixel.x;
  launch.outputs.at[i].pixelY = pixel.y;
  launch.outputs.at[i].spread = spread(x) | (spread(y) << 1);
  launch.outputs.at[i].unspread = unspread(h) | (unspread(h >> 1) << 16);
  launch.outputs.at[i].a = h;
  launch.outputs.at[i].b = uint(int(h) >> int(i & 31u));
  launch.outputs.at[i].c = (h & ~(0xFFu << (i & 15u))) + ((h >> 7) & 63u) * 3u;
  launch.outputs.at[i].d = mix3(h, i);
  launch.outputs.at[i].hit = payload.x;
  // Outside the image if a mask is lost. The index is clamped, and the host checks the counts.
  uint to = min(pixel.y * gl_LaunchSizeEXT.x + pixel.x, gl_LaunchSizeEXT.x * gl_LaunchSizeEXT.y - 1u);
  atomicAdd(launch.outputs.at[to].stored, 1u);
}
)";
constexpr char kClosestHit[] = R"(
layout(location = 0) rayPayloadInEXT uvec2 payload;
void main() { payload.x = mix3(payload.x, payload.y) + (payload.y % 7u) * (payload.x & 1023u); }
)";

std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
std::uint32_t reversed(std::uint32_t x) {
  std::uint32_t result = 0;
  for (int k = 0; k < 32; ++k) result |= (x >> k & 1) << (31 - k);
  return result;
}
std::uint32_t mix3(std::uint32_t h, std::uint32_t i) {
  return ((h >> (i & 15)) & 511) ^ (h << (i & 7)) ^ reversed(h) ^ (h / (1 + (i & 63)));
}
std::uint32_t everySecond(std::uint32_t x) {
  std::uint32_t result = 0;
  for (int k = 0; k < 16; ++k) result |= (x >> (2 * k) & 1) << k;
  return result;
}
std::uint32_t spread(std::uint32_t x) {
  std::uint32_t result = 0;
  for (int k = 0; k < 16; ++k) result |= (x >> k & 1) << (2 * k);
  return result;
}

Result expectedOf(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t i = y * kWidth + x, h = hash(i);
  Result r{};
  r.pixelX = ((x >> 6) * 8 + (y & 7)) * 8 + (x & 7);
  r.pixelY = (y & ~7u) + ((x & 63) >> 3);
  r.spread = spread(x) | spread(y) << 1;
  r.unspread = everySecond(h) | everySecond(h >> 1) << 16;
  r.a = h;
  r.b = static_cast<std::uint32_t>(static_cast<std::int32_t>(h) >> (i & 31));
  r.c = (h & ~(0xFFu << (i & 15))) + ((h >> 7) & 63) * 3;
  r.d = mix3(h, i);
  r.hit = mix3(h, i) + (i % 7) * (h & 1023);
  r.stored = 1;
  return r;
}

void checkIntegers() {
  const Program program({.common = kCommon,
                         .rayGeneration = kRayGeneration,
                         .miss = {"void main() {}"},
                         .hit = {{.closestHit = kClosestHit}}});
  Scene scene;
  scene.add(scene.addBlas({triangleAt(0, 0, 0)}));
  const auto results = run<Result>(program, scene, std::vector<std::uint32_t>{0}, {.size = {kWidth, kHeight, 1}});
  Checks checks;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const Result &r = results[y * kWidth + x], e = expectedOf(x, y);
      checks.equal(uvec2(r.pixelX, r.pixelY), uvec2(e.pixelX, e.pixelY), "pixel {} {}: swapped", x, y);
      checks.equal(uvec2(r.spread, r.unspread), uvec2(e.spread, e.unspread), "pixel {} {}: interleaved bits", x, y);
      checks.equal(uvec4(r.a, r.b, r.c, r.d), uvec4(e.a, e.b, e.c, e.d), "pixel {} {}: shifts and masks", x, y);
      checks.equal(r.hit, e.hit, "pixel {} {}: in closest-hit", x, y);
      checks.equal(r.stored, 1u, "pixel {} {}: invocations that stored here", x, y);
    }
  checks.done();
}

TEST(Integers, ComputesShiftsMasksAndProductsLikeTheHost) { checkIntegers(); }

TEST(BareDriver, DISABLED_ComputesIntegersWithoutEnvironmentVariables) { checkIntegers(); }
TEST(BareDriver, ComputesIntegersWithoutEnvironmentVariables) {
  const ChildEnd end =
      runInChild("BareDriver.DISABLED_ComputesIntegersWithoutEnvironmentVariables",
                 {{"QUINTET_NO_DRIVER_WORKAROUNDS", "1"}, {"GALLIUM_OVERRIDE_CPU_CAPS", {}}, {"LP_NUM_THREADS", {}}});
  Checks checks;
  checks.quirkThat(end == ChildEnd::passed, "the process {}", end == ChildEnd::crashed ? "crashed" : "failed");
  checks.done(kIntegerMasks);
}

}  // namespace
}  // namespace quintet::oracle::integer_test
