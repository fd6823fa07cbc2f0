// SPDX-License-Identifier: Apache-2.0
// The decoders of block-compressed images against those of the device, with random blocks of all modes.
#include "io/block_decode.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gpu/commands.h"
#include "gpu/error.h"
#include "gpu/image.h"
#include "harness.h"

namespace quintet::io {
namespace {

constexpr std::uint32_t kBlockImageSide = 256;  // pixels: 4096 blocks
constexpr std::size_t kBlocks = std::size_t{kBlockImageSide / 4} * (kBlockImageSide / 4);

// An image in a compressed format, which gpu::Image does not support.
class CompressedImage {
 public:
  CompressedImage(gpu::Context& context, VkFormat format) : context_(context) {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {kBlockImageSide, kBlockImageSide, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    gpu::check(context.vk().vkCreateImage(context.device(), &info, nullptr, &image_), "create an image");
    VkMemoryRequirements needs{};
    context.vk().vkGetImageMemoryRequirements(context.device(), image_, &needs);
    VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocation.allocationSize = needs.size;
    while (!(needs.memoryTypeBits >> allocation.memoryTypeIndex & 1)) ++allocation.memoryTypeIndex;
    gpu::check(context.vk().vkAllocateMemory(context.device(), &allocation, nullptr, &memory_), "allocate memory");
    gpu::check(context.vk().vkBindImageMemory(context.device(), image_, memory_, 0), "bind memory");
  }
  ~CompressedImage() {
    context_.vk().vkDestroyImage(context_.device(), image_, nullptr);
    context_.vk().vkFreeMemory(context_.device(), memory_, nullptr);
  }
  CompressedImage(const CompressedImage&) = delete;
  CompressedImage& operator=(const CompressedImage&) = delete;
  VkImage handle() const { return image_; }

 private:
  gpu::Context& context_;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

// Texels as the device decodes them: RGBA.
std::vector<float> decodeOnDevice(VkFormat format, std::span<const std::byte> blocks) {
  gpu::Context& context = test::testContext();
  const CompressedImage from(context, format);
  const gpu::Image to(
      context, {kBlockImageSide, kBlockImageSide, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT, "texels"});
  gpu::Buffer upload(context, {.size = blocks.size(), .memory = gpu::Memory::upload, .name = "blocks"});
  const gpu::Buffer texels(context, {.size = to.byteSize(), .memory = gpu::Memory::readback, .name = "texels"});
  upload.upload(blocks);
  context.submitAndWait([&](gpu::Commands& commands) {
    constexpr VkImageSubresourceLayers kLayer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    constexpr auto kFrom = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kTo = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    VkBufferImageCopy copy{};
    copy.imageSubresource = kLayer;
    copy.imageExtent = {kBlockImageSide, kBlockImageSide, 1};
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = kLayer;
    blit.srcOffsets[1] = blit.dstOffsets[1] = {kBlockImageSide, kBlockImageSide, 1};
    commands.transition(from.handle(), VK_IMAGE_LAYOUT_UNDEFINED, kTo);
    context.vk().vkCmdCopyBufferToImage(commands.handle(), upload.handle(), from.handle(), kTo, 1, &copy);
    commands.transition(from.handle(), kTo, kFrom);
    commands.transition(to, VK_IMAGE_LAYOUT_UNDEFINED, kTo);
    context.vk().vkCmdBlitImage(commands.handle(), from.handle(), kFrom, to.handle(), kTo, 1, &blit, VK_FILTER_NEAREST);
    commands.transition(to, kTo, kFrom);
    commands.copy(to, texels);
    commands.toHost(gpu::Stage::transfer);
  });
  return texels.downloadAs<float>(std::size_t{4} * kBlockImageSide * kBlockImageSide);
}

struct Case {
  const char* name;
  BlockFormat block;
  VkFormat format;
  // Largest difference from lavapipe, which interpolates between the endpoints of BC1 to BC5 in 8 bits and truncates the
  // result. The others are exact on all devices.
  float tolerance;
};

// Largest difference of a weight of BC1 to BC5: the H100 has 3/8 for 1/3 and for 2/5.
constexpr float kWeightError = 1.0f / 24.0f;

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

constexpr Case kCases[] = {
    {"BC1", BlockFormat::bc1Rgba, VK_FORMAT_BC1_RGBA_UNORM_BLOCK, 1.01f / 255.0f},
    {"BC1WithoutAlpha", BlockFormat::bc1Rgb, VK_FORMAT_BC1_RGB_UNORM_BLOCK, 1.01f / 255.0f},
    {"BC2", BlockFormat::bc2, VK_FORMAT_BC2_UNORM_BLOCK, 1.01f / 255.0f},
    {"BC3", BlockFormat::bc3, VK_FORMAT_BC3_UNORM_BLOCK, 2.0f / 255.0f},
    {"BC4", BlockFormat::bc4, VK_FORMAT_BC4_UNORM_BLOCK, 2.0f / 255.0f},
    {"BC4Signed", BlockFormat::bc4Signed, VK_FORMAT_BC4_SNORM_BLOCK, 2.0f / 127.0f},
    {"BC5", BlockFormat::bc5, VK_FORMAT_BC5_UNORM_BLOCK, 2.0f / 255.0f},
    {"BC5Signed", BlockFormat::bc5Signed, VK_FORMAT_BC5_SNORM_BLOCK, 2.0f / 127.0f},
    {"BC6", BlockFormat::bc6, VK_FORMAT_BC6H_UFLOAT_BLOCK, 0.0f},
    {"BC6Signed", BlockFormat::bc6Signed, VK_FORMAT_BC6H_SFLOAT_BLOCK, 0.0f},
    {"BC7", BlockFormat::bc7, VK_FORMAT_BC7_UNORM_BLOCK, 1e-6f},
};

class BlockDecode : public testing::TestWithParam<Case> {};

// Random bits have all modes of BC6H, which are in the lowest five bits. The mode of BC7 is the number of zero bits at the
// beginning, so that the higher ones would be rare.
std::vector<std::byte> randomBlocks(BlockFormat format) {
  std::mt19937 random(5);
  std::vector<std::byte> blocks(kBlocks * bytesPerBlock(format));
  for (std::byte& byte : blocks) byte = static_cast<std::byte>(random());
  for (std::size_t i = 0; i < kBlocks && format == BlockFormat::bc7; ++i) {
    const std::size_t mode = i % 9;  // 8 is reserved
    std::byte& first = blocks[16 * i];
    first = mode == 8 ? std::byte{0} : (first | std::byte{1}) << mode;
  }
  return blocks;
}

TEST_P(BlockDecode, EqualsTheDevice) {
  const Case& c = GetParam();
  const gpu::Context& context = test::testContext();  // loads the function
  VkFormatProperties properties{};
  vkGetPhysicalDeviceFormatProperties(context.physicalDevice(), c.format, &properties);
  if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_SRC_BIT))
    GTEST_SKIP() << "the device does not support " << c.name;
  float tolerance = c.tolerance;
  const bool isSigned = c.block == BlockFormat::bc4Signed || c.block == BlockFormat::bc5Signed;
  const bool isInterpolated = c.tolerance > 1e-6f;  // BC1 to BC5
  if (isInterpolated && !context.info().software) tolerance += kWeightError * (isSigned ? 2.0f : 1.0f);
  const std::vector<std::byte> blocks = randomBlocks(c.block);
  const std::vector<float> expected = decodeOnDevice(c.format, blocks);
  // The samples as they are stored, without decoding sRGB.
  const Image raw = decodeBlocks(c.block, blocks, kBlockImageSide, kBlockImageSide);
  ASSERT_EQ(raw.width, kBlockImageSide);
  std::size_t different = 0;
  for (std::uint32_t y = 0; y < kBlockImageSide; ++y)
    for (std::uint32_t x = 0; x < kBlockImageSide; ++x)
      for (std::uint32_t k = 0; k < raw.channels; ++k) {
        float value = 0.0f;
        switch (raw.type) {
          case PixelType::u8: value = static_cast<float>(raw.pixel<std::uint8_t>(x, y)[k]) / 255.0f; break;
          case PixelType::u16: value = static_cast<float>(raw.pixel<std::uint16_t>(x, y)[k]) / 65535.0f; break;
          case PixelType::f32: value = raw.pixel<float>(x, y)[k]; break;
        }
        const float wanted = expected[4 * (std::size_t{y} * kBlockImageSide + x) + k];
        if (std::abs(value - wanted) <= tolerance) continue;
        if (++different <= 5)
          ADD_FAILURE() << "block " << (y / 4 * (kBlockImageSide / 4) + x / 4) << ", texel " << x % 4 << ", " << y % 4
                        << ", channel " << k << ": " << value << ", expected " << wanted << "; first byte "
                        << std::to_integer<int>(
                               blocks[(y / 4 * (kBlockImageSide / 4) + x / 4) * bytesPerBlock(c.block)]);
      }
  EXPECT_EQ(different, 0u);
}

INSTANTIATE_TEST_SUITE_P(Formats, BlockDecode, testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace quintet::io
