// SPDX-License-Identifier: Apache-2.0
// Values for the test of scripts/gdb_printers.py. A comment "print EXPRESSION = TEXT" states what gdb must print at the next
// call of stop(); "…" in TEXT is any text. The program links no library of Quintet: it defines the functions that it needs.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <quintet/diagnostic.h>
#include <quintet/types.h>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "base/math.h"
#include "gpu/buffer.h"
#include "gpu/context.h"
#include "gpu/image.h"
#include "io/exr/exr.h"
#include "io/image.h"
#include "quintet/shared/explain.h"
#include "quintet/shared/film.h"
#include "quintet/shared/frame.h"
#include "scene/model/scene.h"
#include "spirv/module.h"

#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"

namespace quintet::gpu {

// Without a device. `run` compares the member `found` with that of src/gpu/context.cpp.
struct Context::Impl {
  FoundDevice found;
};
Context::Context(const ContextOptions&) : impl_(std::make_unique<Impl>()) {
  impl_->found.info.index = 1;
  impl_->found.info.name = "NVIDIA H200";
  impl_->found.info.driver = "NVIDIA 580.159.04";
}
Context::~Context() = default;
bool ContextOptions::validationRequested() { return false; }

Buffer::Buffer(Context& context, const BufferOptions& options)
    : context_(&context),
      handle_(std::bit_cast<VkBuffer>(std::uint64_t{7})),
      address_(0x7f0000001000),
      size_(options.size) {}
Buffer::~Buffer() = default;

Image::Image(Context& context, const ImageOptions& options)
    : context_(&context), handle_(std::bit_cast<VkImage>(std::uint64_t{8})), options_(options) {}
Image::~Image() = default;

}  // namespace quintet::gpu

namespace quintet {
namespace {

void stop() {}

void mathTypes() {
  const float infinite = std::numeric_limits<float>::infinity();
  // print v3 = vec3(1, 0.1, -inf)
  const vec3 v3{1, 0.1f, -infinite};
  // print limits = vec4(3.4028235e+38, 1e-45, 16777216, nan)
  const vec4 limits{std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min(), 1 << 24,
                    std::numeric_limits<float>::quiet_NaN()};
  // print u2 = uvec2(3, 4294967295)
  const uvec2 u2{3, ~0u};
  // print i4 = ivec4(-1, 0, 1, 2)
  const glm::ivec4 i4{-1, 0, 1, 2};
  // print d2 = dvec2(0.1, 1e+300)
  const glm::dvec2 d2{0.1, 1e300};
  // print b3 = bvec3(true, false, true)
  const glm::bvec3 b3{true, false, true};
  // print bytes = unsigned char vec2(1, 255)
  const glm::u8vec2 bytes{1, 255};
  // print reference = …vec3(1, 0.1, -inf)
  const vec3& reference = v3;
  // print m4 = mat4 by rows = {row0 = (2, 0, 0, 5), row1 = (0, 2, 0, 6), row2 = (0, 0, 2, 7), row3 = (0, 0, 0, 1)}
  const mat4 m4 = glm::translate(mat4(1.0f), vec3(5, 6, 7)) * glm::scale(mat4(1.0f), vec3(2));
  // print m43 = mat4x3 by rows = {row0 = (1, 4, 7, 10), row1 = (2, 5, 8, 11), row2 = (3, 6, 9, 12)}
  const glm::mat4x3 m43{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  // print rotation = quat(w 0.70710677, x 0, y 0.70710677, z 0), 90° about (0, 1, 0)
  const quat rotation = glm::angleAxis(0.5f * kPi, vec3(0, 1, 0));
  // print noRotation = quat(w 1, x 0, y 0, z 0), no rotation
  const quat noRotation{1, 0, 0, 0};
  // print notUnit = quat(w 0, x 2, y 0, z 0), not a unit quaternion
  const quat notUnit{0, 2, 0, 0};
  // print box = bounds from (0, -1, 0) to (1, 2, 3)
  const Bounds3 box{{0, -1, 0}, {1, 2, 3}};
  // print emptyBox = empty bounds, min (inf, inf, inf), max (-inf, -inf, -inf)
  const Bounds3 emptyBox;
  // print publicBox = bounds from (0, 0, 0) to (1, 2, 3)
  const Bounds publicBox{{0, 0, 0}, {1, 2, 3}};
  // print moved = transform by rows = {row0 = (1, 0, 0, 5), row1 = (0, 1, 0, 6), row2 = (0, 0, 1, 7)}
  const Transform moved = Transform::translation({5, 6, 7});
  // print hash = 0000000000000001000000000000beef
  const Hash hash{1, 0xbeef};
  // print points = std::vector of length 2, capacity 2 = {vec2(1, 2), vec2(3, 4)}
  const std::vector<vec2> points{{1, 2}, {3, 4}};
  // print view = std::span of length 2 = {vec2(1, 2), vec2(3, 4)}
  const std::span<const vec2> view = points;
  stop();
}

void hostTypes() {
  // print unknownLine = a.rgen
  const SourceLocation unknownLine{"a.rgen"};
  // print mistake = a.rchit:12:3: error: payload is too small [Q101]
  Diagnostic mistake{Severity::error, "a.rchit", 12, 3, "Q101", "payload is too small"};
  // print withRelated = a.rchit:12:3: error: payload is too small [Q101] = {related = a.rgen:7: the trace}
  Diagnostic withRelated = mistake;
  withRelated.related.push_back({"a.rgen", 7, 0, "the trace"});
  // print *(quintet::Diagnostic*)&garbage = <Cannot access memory at address 0x…>
  std::array<std::byte, sizeof(Diagnostic)> garbage;
  garbage.fill(std::byte{0x5a});
  // print image = 4x2, 3 channels, f32, linear, premultiplied, 96 bytes
  io::Image image{4, 2, 3, io::PixelType::f32, io::ColorEncoding::linear, std::vector<std::byte>(96), true};
  // print exr = 4x2, 2 channels: R (half), normal.X (f32)
  io::ExrImage exr{4, 2, {{"R", io::ExrType::half, {}}, {"normal.X", io::ExrType::f32, {}}}};
  // print scene = "box.glb", meshes: 1, instances: 2
  scene::Scene scene;
  scene.name = "box.glb";
  scene.instances.resize(2);
  // print scene.meshes[0] = "box", geometries: 1
  scene.meshes.push_back({"box", {{}}, {}, nullptr});
  // print scene.meshes[0].geometries[0] = positions: 3, triangles: 1, material: -1
  scene.meshes[0].geometries[0].positions.resize(3);
  scene.meshes[0].geometries[0].triangles.resize(1);
  // print load = %57 = OpLoad %6 (3, 4), line 12
  const std::array<std::uint32_t, 2> operands{3, 4};
  const spirv::Instruction load{spv::Op::OpLoad, 6, 57, operands, 0, 12};
  // print end = OpReturn
  const spirv::Instruction end{spv::Op::OpReturn};
  stop();
}

void deviceTypes() {
  // print context = context of device 1, "NVIDIA H200", NVIDIA 580.159.04
  gpu::Context context;
  // print emptyBuffer = empty buffer
  const gpu::Buffer emptyBuffer;
  // print buffer = buffer of 64 bytes at 0x7f0000001000
  const gpu::Buffer buffer(context, {.size = 64});
  // print image = image "film", 4x2, VK_FORMAT_R8G8B8A8_UNORM
  const gpu::Image image(context, {.width = 4, .height = 2, .name = "film"});

  stop();
}

// Values that C++ and GLSL share.
void sharedTypes() {
  using namespace shared;
  // print deviceAddress = 0x7f0000001000
  const Address deviceAddress = 0x7f0000001000;
  // print vulkanAddress = 0x10
  const VkDeviceAddress vulkanAddress = 16;
  // print instance = {worldFromObject = {vec4(1, 0, 0, 5), …}, …, firstGeometry = 5, …, flags = kInstanceMirrored | kInstanceOpaque, …}
  const InstanceData instance{{{1, 0, 0, 5}}, {}, 5, 6, kInstanceMirrored | kInstanceOpaque, 0};
  // print merged = {…, firstGeometry = address 0x7f0000001000, firstLightSlot = address 0x7f0000001000, flags = kInstanceMerged, …}
  const InstanceData merged{{}, {}, 0x1000, 0x7f00, kInstanceMerged, 0};
  // print geometry = {positions = 0x7f0000001000, …, uvs = {0x20, 0x0}, …, triangleCount = 12, kind = kGeometryTriangles}
  const GeometryData geometry{.positions = deviceAddress, .uvs = {32}, .triangleCount = 12};
  // print frame = {…, environmentLight = kNoLight, …, flags = kFrameTransparent, …, plannedSamples = kIndependentPixels, …}
  const Frame frame{.environmentLight = kNoLight, .flags = kFrameTransparent, .plannedSamples = kIndependentPixels};
  // print light = {…, type = kLightSpot, …, geometry = range 10, …}
  const LightData light{.type = kLightSpot, .geometry = std::bit_cast<uint>(0.1f)};
  // print unlimited = {…, type = kLightPoint, …, geometry = unlimited range, …}
  const LightData unlimited{.type = kLightPoint};
  // print triangle = {…, type = kLightTriangle, …, geometry = 7, …, leaf = kNoLight}
  const LightData triangle{.type = kLightTriangle, .geometry = 7, .leaf = kNoLight};
  // print node = {center = vec3(1, 2, 3), …, axis = (0, -1, 0), cone = thetaO 60°, thetaE 90°, link = kLightNodeLeaf | kLightNodeIndex 12}
  const LightNode node{{1, 2, 3}, 0, 0, 0x80010000, 0x00004000, kLightNodeLeaf | 12u};
  // print below = {…, axis = (0, 0, -1), …}
  const LightNode below{.axis = 0x7fff7fff};
  // print material = {…, flags = kMaterialBlend | kTextureNormal | kTextureIridescenceThickness | 0x80000000, …}
  const MaterialData material{.flags = kMaterialBlend | 1u << (kMaterialTextureShift + kTextureNormal) |
                                       1u << (kMaterialTextureShift + kTextureIridescenceThickness) | 0x80000000u};
  // print texture = {…, index = kNoTexture, uvSet = 1}
  const TextureData texture{.index = kNoTexture, .uvSet = 1};
  // print csg = {operation = kCsgIntersect, operand = 1}
  const CsgNodeData csg{kCsgIntersect, 1};
  // print ray = {origin = vec3(1, 2, 3), tmax = 0.5, direction = vec3(0, 0, -1), kind = 9}
  const RayRecord ray{{1, 2, 3}, 0.5f, {0, 0, -1}, 9};  // of an unknown kind
  // print record = {kind = kLogLightSample, wordCount = 3, pixel = uvec2(4, 5), sampleIndex = 6}
  const LogRecord record{kLogLightSample, 3, {4, 5}, 6};
  // print sum = sum -1.5
  const FixedSum sum{{0, 0x80000000u, ~1u, ~0u}};
  // print notFinite = sum that is not finite
  const FixedSum notFinite{{0, 0, 0, kNotFiniteWord}};
  stop();
}

}  // namespace
}  // namespace quintet

int main() {
  quintet::mathTypes();
  quintet::hostTypes();
  quintet::deviceTypes();
  quintet::sharedTypes();
}
