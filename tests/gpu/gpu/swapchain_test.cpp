// SPDX-License-Identifier: Apache-2.0
// Presenting to a surface without a window (VK_EXT_headless_surface), which lavapipe has.
#include "gpu/present/swapchain.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "gpu/error.h"
#include "gpu/instance.h"
#include "gpu/present/draw_list_renderer.h"
#include "gpu/present/line_renderer.h"
#include "harness.h"
#include "shader/compiler.h"

namespace quintet::gpu {
namespace {

VkSurfaceKHR makeHeadlessSurface(VkInstance instance) {
  const auto create = instanceFunction<PFN_vkCreateHeadlessSurfaceEXT>(instance, "vkCreateHeadlessSurfaceEXT");
  if (!create) throw Error("no function vkCreateHeadlessSurfaceEXT");
  const VkHeadlessSurfaceCreateInfoEXT info{VK_STRUCTURE_TYPE_HEADLESS_SURFACE_CREATE_INFO_EXT};
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  check(create(instance, &info, nullptr, &surface), "create a headless surface");
  return surface;
}

// A device that presents; null if no driver has headless surfaces.
std::unique_ptr<Context> presentingContext() {
  ContextOptions options;
  options.device = test::testContext().info().name;
  options.surface =
      SurfaceSource{{VK_KHR_SURFACE_EXTENSION_NAME, VK_EXT_HEADLESS_SURFACE_EXTENSION_NAME}, makeHeadlessSurface};
  try {
    return std::make_unique<Context>(options);
  } catch (const Error&) {
    return nullptr;
  }
}

std::vector<std::uint32_t> compileStage(const std::string& file) {
  shader::Source source;
  source.stage = *shader::stageOfFile(file);
  source.text = readTextFile(std::string(QUINTET_SOURCE_ROOT) + "/shaders/window/" + file);
  source.name = file;
  const shader::Result result = shader::Compiler({}).compile(source);
  EXPECT_TRUE(result.ok());
  return result.spirv;
}

std::unique_ptr<DrawListRenderer> makeRenderer(Context& context, VkFormat format) {
  return std::make_unique<DrawListRenderer>(context, format, compileStage("triangles.vert"),
                                            compileStage("triangles.frag"));
}

constexpr std::uint32_t kWhite = 0xFFFFFFFF;

// Two triangles with texture coordinates from 0 to 1.
void addRectangle(DrawList& list, std::size_t texture, float left, float top, float right, float bottom,
                  std::uint32_t color, const std::array<float, 4>& clip) {
  const auto first = static_cast<std::uint32_t>(list.indices.size());
  const auto vertex = static_cast<std::uint32_t>(list.vertices.size());
  list.vertices.insert(
      list.vertices.end(),
      {{left, top, 0, 0, color}, {right, top, 1, 0, color}, {right, bottom, 1, 1, color}, {left, bottom, 0, 1, color}});
  list.indices.insert(list.indices.end(), {0, 1, 2, 0, 2, 3});
  list.commands.push_back({texture, clip[0], clip[1], clip[2], clip[3], first, 6, vertex});
}

std::shared_ptr<const std::vector<std::byte>> pixels(std::initializer_list<int> values) {
  auto bytes = std::make_shared<std::vector<std::byte>>();
  for (const int value : values) bytes->push_back(std::byte(value));
  return bytes;
}

// The drawn pixels, RGBA.
class Canvas {
 public:
  Canvas(Context& context, std::uint32_t width, std::uint32_t height)
      : context_(context),
        image_(context, {.width = width,
                         .height = height,
                         .format = VK_FORMAT_R8G8B8A8_UNORM,
                         .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                         .name = "canvas"}),
        bytes_(context, {.size = image_.byteSize(), .memory = Memory::readback, .name = "pixels"}) {}

  void draw(DrawListRenderer& renderer, const DrawList& list, const DrawListRenderer::External& external = {}) {
    context_.submitAndWait([&](Commands& commands) {
      commands.transition(image_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
      renderer.draw(commands, {image_.view(), {image_.width(), image_.height()}, 0}, list, {0, 0, 0, 1}, external);
      commands.transition(image_, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
      commands.copy(image_, bytes_);
      commands.toHost(Stage::transfer);
    });
  }
  std::vector<int> at(std::uint32_t x, std::uint32_t y) const {
    std::vector<int> result;
    for (std::size_t c = 0; c < 4; ++c)
      result.push_back(std::to_integer<int>(bytes_.mapped()[4 * (std::size_t{y} * image_.width() + x) + c]));
    return result;
  }

 private:
  Context& context_;
  Image image_;
  Buffer bytes_;
};

using Rgba = std::vector<int>;

TEST(Swapchain, PresentsFramesOfChangingSize) {
  const std::unique_ptr<Context> context = presentingContext();
  if (!context) GTEST_SKIP() << "the driver has no VK_EXT_headless_surface";
  {
    Swapchain swapchain(*context);
    const std::unique_ptr<DrawListRenderer> renderer = makeRenderer(*context, swapchain.format());
    renderer->setTexture(0, {1, 1}, pixels({255, 255, 255, 255}));
    VkExtent2D drawn{};
    const auto frame = [&](VkExtent2D size) {
      return swapchain.draw(size, [&](Commands& commands, const RenderTarget& target) {
        drawn = target.size;
        EXPECT_LT(target.slot, Swapchain::kFramesInFlight);
        DrawList list;
        addRectangle(list, 0, 0, 0, 10, 10, kWhite, {0, 0, 1e4f, 1e4f});
        renderer->draw(commands, target, list, {0, 0, 0, 1});
      });
    };
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(frame({64, 48}));
    EXPECT_EQ(drawn.width, 64u);
    EXPECT_TRUE(frame({1, 1}));
    EXPECT_EQ(drawn.width, 1u);
    EXPECT_FALSE(frame({0, 0})) << "a minimized window";
    EXPECT_FALSE(frame({64, 0}));
    EXPECT_TRUE(frame({33, 21}));
    EXPECT_EQ(drawn.height, 21u);
  }
  EXPECT_THAT(context->validationMessages(), testing::IsEmpty());
}

TEST(DrawListRenderer, DrawsTexturesWithinTheirClipRectangle) {
  const std::unique_ptr<Context> context = presentingContext();
  if (!context) GTEST_SKIP() << "the driver has no VK_EXT_headless_surface";
  {
    const auto renderer = makeRenderer(*context, VK_FORMAT_R8G8B8A8_UNORM);
    Canvas canvas(*context, 16, 8);
    // Two pixels: red and green.
    renderer->setTexture(1, {2, 1}, pixels({255, 0, 0, 255, 0, 255, 0, 255}), VK_FILTER_NEAREST);
    renderer->setTexture(0, {1, 1}, pixels({255, 255, 255, 255}));
    DrawList list;
    addRectangle(list, 1, 0, 0, 8, 8, kWhite, {0, 0, 16, 4});
    addRectangle(list, 0, 8, 0, 16, 8, 0x80FF0000, {8, 0, 16, 8});  // blue with alpha 1/2
    addRectangle(list, 7, 0, 0, 16, 8, kWhite, {0, 0, 16, 8});      // a texture that was never set
    canvas.draw(*renderer, list);
    EXPECT_EQ(canvas.at(1, 1), (Rgba{255, 0, 0, 255}));
    EXPECT_EQ(canvas.at(6, 3), (Rgba{0, 255, 0, 255}));
    EXPECT_EQ(canvas.at(1, 5), (Rgba{0, 0, 0, 255})) << "outside of the clip rectangle";
    EXPECT_EQ(canvas.at(12, 6), (Rgba{0, 0, 128, 255}));

    // The same texture with other pixels, and then with a different size.
    renderer->setTexture(1, {2, 1}, pixels({1, 2, 3, 255, 4, 5, 6, 255}), VK_FILTER_NEAREST);
    canvas.draw(*renderer, list);
    EXPECT_EQ(canvas.at(1, 1), (Rgba{1, 2, 3, 255}));
    renderer->setTexture(1, {1, 1}, pixels({9, 8, 7, 255}));
    canvas.draw(*renderer, list);
    EXPECT_EQ(canvas.at(1, 1), (Rgba{9, 8, 7, 255}));
    EXPECT_EQ(canvas.at(6, 1), (Rgba{9, 8, 7, 255}));
    canvas.draw(*renderer, {});
    EXPECT_EQ(canvas.at(1, 1), (Rgba{0, 0, 0, 255}));
  }
  EXPECT_THAT(context->validationMessages(), testing::IsEmpty());
}

TEST(DrawListRenderer, CallsExternalCommandsInOrder) {
  const std::unique_ptr<Context> context = presentingContext();
  if (!context) GTEST_SKIP() << "the driver has no VK_EXT_headless_surface";
  {
    const auto renderer = makeRenderer(*context, VK_FORMAT_R8G8B8A8_UNORM);
    LineRenderer lines(*context, VK_FORMAT_R8G8B8A8_UNORM, compileStage("lines.vert"), compileStage("lines.frag"));
    Canvas canvas(*context, 16, 8);
    renderer->setTexture(0, {1, 1}, pixels({255, 255, 255, 255}));
    DrawList list;
    addRectangle(list, 0, 0, 0, 16, 8, 0xFF0000FF, {0, 0, 16, 8});  // red
    DrawCommand command;
    command.left = 2, command.top = 0, command.right = 12, command.bottom = 8;
    command.external = true;
    list.commands.push_back(command);
    addRectangle(list, 0, 8, 0, 16, 8, 0xFFFF0000, {0, 0, 16, 8});  // blue
    LineList thick;
    thick.lines.push_back({.ax = -20, .ay = 4, .bx = 40, .by = 4, .color = 0xFF00FF00, .width = 30, .outline = 0});
    context->submitAndWait([&](Commands& commands) { lines.prepare(commands, 0, thick); });
    canvas.draw(*renderer, list, [&](Commands& commands, const RenderTarget& target, const VkRect2D& rectangle) {
      EXPECT_EQ(rectangle.offset.x, 2);
      EXPECT_EQ(rectangle.extent.width, 10u);
      lines.record(commands, target, rectangle);
    });
    EXPECT_EQ(canvas.at(1, 1), (Rgba{255, 0, 0, 255})) << "outside of the rectangle";
    EXPECT_EQ(canvas.at(6, 6), (Rgba{0, 255, 0, 255}));
    EXPECT_EQ(canvas.at(10, 1), (Rgba{0, 0, 255, 255})) << "drawn after it";
    canvas.draw(*renderer, list);
    EXPECT_EQ(canvas.at(6, 6), (Rgba{255, 0, 0, 255}));
  }
  EXPECT_THAT(context->validationMessages(), testing::IsEmpty());
}

}  // namespace
}  // namespace quintet::gpu
