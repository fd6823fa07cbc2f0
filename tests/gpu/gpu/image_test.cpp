// SPDX-License-Identifier: Apache-2.0
#include "gpu/image.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/math.h"
#include "gpu/commands.h"
#include "gpu/descriptors.h"
#include "gpu/error.h"
#include "gpu/uploader.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

using Texel = std::array<std::uint8_t, 4>;

Image upload(const ImageOptions& options, std::span<const std::byte> pixels) {
  Image image(test::testContext(), options);
  Uploader(test::testContext(), 2 << 20).upload(image, pixels);
  return image;
}

// Returns the samples of the texture `z` of the set at the texture coordinates `xy`.
std::vector<vec4> sample(const BindlessSet& set, const std::vector<vec3>& uvsAndIndex) {
  test::ComputeOptions options;
  options.set = &set;
  return test::runCompute<vec4>(R"(
    layout(set = 0, binding = 1) uniform sampler2D textures[];
    #define In vec3
    #define Out vec4
    Out run(uint index, In value) { return textureLod(textures[nonuniformEXT(uint(value.z))], value.xy, 0.0); }
  )",
                                uvsAndIndex, uvsAndIndex.size(), options);
}

float linearFromSrgb(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }

TEST(GpuImage, RoundTripsPixels) {
  Context& context = test::testContext();
  std::vector<float> pixels(37 * 23 * 4);
  std::iota(pixels.begin(), pixels.end(), 0.5f);
  const Image image = upload({.width = 37, .height = 23, .format = VK_FORMAT_R32G32B32A32_SFLOAT, .name = "floats"},
                             std::as_bytes(std::span(pixels)));
  EXPECT_EQ(image.byteSize(), pixels.size() * 4);
  const Buffer buffer(context, {.size = image.byteSize(), .memory = Memory::readback, .name = "pixels"});
  context.submitAndWait([&](Commands& commands) {
    commands.transition(image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    commands.copy(image, buffer);
    commands.toHost(Stage::transfer);
  });
  EXPECT_EQ(buffer.downloadAs<float>(pixels.size()), pixels);
}

TEST(GpuImage, RoundTripsMoreThanTheRing) {
  Context& context = test::testContext();
  std::vector<std::uint32_t> pixels(2048 * 1500);  // 12 MiB through halves of 1 MiB
  std::iota(pixels.begin(), pixels.end(), 0u);
  const Image image = upload({.width = 2048, .height = 1500, .name = "large"}, std::as_bytes(std::span(pixels)));
  const Buffer buffer(context, {.size = image.byteSize(), .name = "pixels"});
  context.submitAndWait([&](Commands& commands) {
    commands.transition(image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    commands.copy(image, buffer);
  });
  EXPECT_TRUE(buffer.downloadAs<std::uint32_t>(pixels.size()) == pixels);
}

TEST(GpuImage, DecodesSrgbExceptAlpha) {
  Context& context = test::testContext();
  std::vector<Texel> pixels(256);
  std::vector<vec3> uvs(256);
  for (int i = 0; i < 256; ++i) {
    const auto byte = static_cast<std::uint8_t>(i);
    pixels[i] = {byte, byte, static_cast<std::uint8_t>(255 - i), byte};
    uvs[i] = {(static_cast<float>(i) + 0.5f) / 256.0f, 0.5f, 0.0f};
  }
  const auto bytes = std::as_bytes(std::span(pixels));
  const Image srgb = upload({.width = 256, .format = VK_FORMAT_R8G8B8A8_SRGB, .name = "srgb"}, bytes);
  const Image plain = upload({.width = 256, .format = VK_FORMAT_R8G8B8A8_UNORM, .name = "unorm"}, bytes);
  const Sampler nearest(context, {.filter = VK_FILTER_NEAREST});
  BindlessSet set(context, 1, 128);
  set.setTexture(0, srgb, nearest);
  const std::vector<vec4> decoded = sample(set, uvs);
  context.wait(context.submitted());
  set.setTexture(0, plain, nearest);
  const std::vector<vec4> raw = sample(set, uvs);
  for (int i = 0; i < 256; ++i) {
    const float c = static_cast<float>(i) / 255.0f;
    // The H200 decodes to 8 bits, with errors up to 0.0039 near white.
    EXPECT_NEAR(decoded[i].x, linearFromSrgb(c), 5e-3f) << i;
    EXPECT_NEAR(decoded[i].z, linearFromSrgb(1.0f - c), 5e-3f) << i;
    EXPECT_NEAR(decoded[i].w, c, 1e-6f) << i;
    EXPECT_NEAR(raw[i].x, c, 1e-6f) << i;
  }
}

TEST(GpuImage, AppliesFilterAndAddressModes) {
  Context& context = test::testContext();
  const std::vector<float> pixels = {0, 1, 2, 3};
  const Image ramp =
      upload({.width = 4, .format = VK_FORMAT_R32_SFLOAT, .name = "ramp"}, std::as_bytes(std::span(pixels)));
  const Sampler linear(context, {.addressU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
  const Sampler repeat(context, {});
  const Sampler mirror(context, {.filter = VK_FILTER_NEAREST, .addressU = VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT});
  BindlessSet set(context, 3, 128);
  set.setTexture(0, ramp, linear);
  set.setTexture(1, ramp, repeat);
  set.setTexture(2, ramp, mirror);
  const std::vector<vec4> colors = sample(set, {{0.5f, 0.5f, 0}, {-0.2f, 0.5f, 0}, {1.0f, 0.5f, 1}, {1.1f, 0.5f, 2}});
  EXPECT_NEAR(colors[0].x, 1.5f, 1e-2f);  // between the middle texels
  EXPECT_NEAR(colors[1].x, 0.0f, 1e-2f);  // clamped
  EXPECT_NEAR(colors[2].x, 1.5f, 1e-2f);  // between the last and the first
  EXPECT_NEAR(colors[3].x, 3.0f, 1e-2f);  // mirrored to 0.9
}

TEST(GpuImage, RejectsInvalidSizesAndFormats) {
  Context& context = test::testContext();
  EXPECT_THAT([&] { const Image i(context, {.width = 1u << 30, .name = "wide"}); },
              ThrowsMessage<MemoryError>(HasSubstr("image 'wide' of 1073741824 × 1 pixels")));
  EXPECT_THROW(Image(context, {.width = 0, .name = "none"}), MemoryError);
  EXPECT_THROW(Image(context, {.format = VK_FORMAT_D32_SFLOAT, .name = "depth"}), UsageError);
}

TEST(GpuDescriptors, IndexesTexturesPerInvocation) {
  Context& context = test::testContext();
  constexpr std::uint32_t kCount = 100;
  const Sampler sampler(context, {});
  BindlessSet set(context, kCount, 128);
  std::vector<Image> images;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const float value = static_cast<float>(i);
    images.push_back(upload({.format = VK_FORMAT_R32_SFLOAT, .name = "constant"}, std::as_bytes(std::span(&value, 1))));
    set.setTexture(i, images.back(), sampler);
  }
  std::vector<vec3> uvs;
  for (std::uint32_t i = 0; i < 1000; ++i) uvs.emplace_back(0.5f, 0.5f, static_cast<float>((i * 37) % kCount));
  const std::vector<vec4> colors = sample(set, uvs);
  for (std::uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(colors[i].x, uvs[i].z) << i;
}

TEST(GpuDescriptors, SupportsUnboundTextures) {
  Context& context = test::testContext();
  const float value = 42;
  const Image image = upload({.format = VK_FORMAT_R32_SFLOAT, .name = "only"}, std::as_bytes(std::span(&value, 1)));
  const Sampler sampler(context, {});
  BindlessSet set(context, 5, 128);
  set.setTexture(3, image, sampler);
  EXPECT_EQ(sample(set, {{0.5f, 0.5f, 3.0f}})[0].x, 42.0f);
}

TEST(GpuDescriptors, RejectsTooManyTextures) {
  EXPECT_THAT([] { const BindlessSet set(test::testContext(), 1'000'000'000, 128); },
              ThrowsMessage<MemoryError>(HasSubstr("1000000000 textures")));
}

}  // namespace
}  // namespace quintet::gpu
