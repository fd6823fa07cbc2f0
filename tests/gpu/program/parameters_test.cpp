// SPDX-License-Identifier: Apache-2.0
// Parameters of every type on the device: numbers in scalar layout, choices, and images as textures.
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/file.h"
#include "harness.h"
#include "io/codec.h"
#include "render/scene/texture_upload.h"
#include "run_program.h"

namespace quintet::test {
namespace {

const std::string kHead = R"([program]
ray_generation = "main.rgen"
[[ray]]
name = "r"
miss = "m.rmiss"
)";

TEST(Parameters, OfEveryTypeReachTheShader) {
  const std::string toml = kHead + R"(
[[parameter]]
name = "tint"
type = "color"
default = [1, 2, 3]
[[parameter]]
name = "on"
type = "bool"
default = true
[[parameter]]
name = "uv"
type = "vec2"
default = [4, 5]
[[parameter]]
name = "count"
type = "int"
default = 0
[[parameter]]
name = "size"
type = "uint"
default = 0
[[parameter]]
name = "mode"
type = "choice"
choices = ["red", "green", "blue"]
default = "red"
[[parameter]]
name = "quad"
type = "vec4"
default = [0, 0, 0, 0]
[[output]]
name = "a"
[[output]]
name = "b"
[[output]]
name = "c"
)";
  const Files files = {{"m.rmiss", "void main() {}\n"}, {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  storeOutput(kOutput_a, launchPixel(), vec4(parameters.tint, parameters.on));
  storeOutput(kOutput_b, launchPixel(), vec4(parameters.uv, parameters.count, parameters.mode == kChoice_mode_blue ? 50.0 : 60.0));
  storeOutput(kOutput_c, launchPixel(), parameters.quad + vec4(0.0, 0.0, 0.0, float(parameters.size)));
}
)"}};
  const Outputs outputs =
      runProgram(toml, files, namedSquares({"a"}), 1, {"count=-7", "size=3000000000", "mode=blue", "quad=1,2,3,0"});
  EXPECT_EQ(outputs[0][0], vec4(1, 2, 3, 1));
  EXPECT_EQ(outputs[1][0], vec4(4, 5, -7, 50));
  EXPECT_EQ(outputs[2][0], vec4(1, 2, 3, 3e9f));
}

// 2 × 2 texels: red, green; blue, mid gray with alpha 0.2.
io::Image fourTexels() {
  io::Image image = io::makeImage(2, 2, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
  const std::uint8_t texels[] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 128, 128, 128, 51};
  std::ranges::copy(texels, image.samples<std::uint8_t>().begin());
  return image;
}

std::string bytesOf(const io::Image& image) {
  const std::vector<std::byte> png = io::encodePng(image);
  return std::string(reinterpret_cast<const char*>(png.data()), png.size());
}

const std::string kImages = kHead + R"(
[[parameter]]
name = "srgb"
type = "image"
default = "four.png"
[[parameter]]
name = "linear"
type = "image"
default = "four.png"
encoding = "linear"
[[parameter]]
name = "other"
type = "image"
default = ""
[[output]]
name = "texels"
[[output]]
name = "other"
)";

const Files kImageFiles = {{"four.png", bytesOf(fourTexels())},
                           {"m.rmiss", "void main() {}\n"},
                           {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const uint i = pixel.x;
  const uint texel = i % 4u;
  const vec2 uv = (vec2(texel % 2u, texel / 2u) + 0.5) / 2.0;
  vec4 value = sampleParameter(i < 4u ? parameters.srgb : parameters.linear, uv);
  if (i == 8u) value = vec4(parameterSize(parameters.srgb), parameterSize(parameters.other));
  if (i == 9u) value = sampleParameter(parameters.linear, vec2(0.5, 0.25));
  if (i == 10u) value = texelParameter(parameters.linear, ivec2(1, 0));
  if (i == 11u) value = sampleParameter(parameters.linear, vec2(2.25, -0.75));
  storeOutput(kOutput_texels, pixel, value);
  storeOutput(kOutput_other, pixel, sampleParameter(parameters.other, vec2(0.25)));
}
)"}};

void expectNear(const vec4& value, const vec4& expected, float tolerance = 2e-3f) {
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(value[c], expected[c], tolerance);
}

TEST(Parameters, ImagesAreTextures) {
  const Outputs outputs = runProgram(kImages, kImageFiles, namedSquares({"a"}), 12);
  const std::vector<vec4>& texels = outputs[0];
  expectNear(texels[0], {1, 0, 0, 1});
  expectNear(texels[1], {0, 1, 0, 1});
  expectNear(texels[2], {0, 0, 1, 1});
  const float gray = std::pow((128.0f / 255.0f + 0.055f) / 1.055f, 2.4f);  // IEC 61966-2-1
  expectNear(texels[3], {gray, gray, gray, 0.2f});
  expectNear(texels[7], {128 / 255.0f, 128 / 255.0f, 128 / 255.0f, 0.2f});
  EXPECT_EQ(texels[8], vec4(2, 2, 1, 1)) << "sizes";
  expectNear(texels[9], {0.5f, 0.5f, 0, 1}, 0.02f);  // between red and green
  expectNear(texels[10], {0, 1, 0, 1});
  expectNear(texels[11], {1, 0, 0, 1});  // repeated
  EXPECT_EQ(outputs[1][0], vec4(1.0f)) << "no image means white";
}

TEST(Parameters, ImagesAreSetByPath) {
  std::string folder = (std::filesystem::temp_directory_path() / "quintet-parameters-XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  io::Image image = io::makeImage(1, 1, 3, io::PixelType::f32, io::ColorEncoding::linear);
  image.pixel<float>(0, 0)[0] = 8.0f;
  image.pixel<float>(0, 0)[2] = 0.5f;
  const std::string file = folder + "/one.exr";
  io::writeImage(file, image);
  const Outputs outputs = runProgram(kImages, kImageFiles, namedSquares({"a"}), 1, {"other=" + file, "srgb="});
  EXPECT_EQ(outputs[1][0], vec4(8.0f, 0.0f, 0.5f, 1.0f));
  EXPECT_EQ(outputs[0][0], vec4(1.0f)) << "an empty name means white";
  writeFile(folder + "/broken.png", std::string_view("not an image"));
  EXPECT_THROW(runProgram(kImages, kImageFiles, namedSquares({"a"}), 1, {"other=" + folder + "/broken.png"}),
               FileError);
  EXPECT_THROW(runProgram(kImages, kImageFiles, namedSquares({"a"}), 1, {"other=" + folder + "/none.png"}), FileError);
  std::filesystem::remove_all(folder);
}

TEST(Parameters, ReuseReleasedSlots) {
  gpu::BindlessSet set(testContext(), 8, 32);
  render::TextureSlots slots(set, 3, 5);
  const std::vector<std::uint32_t> first = slots.acquire(2), second = slots.acquire(3);
  EXPECT_EQ(first, (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(second, (std::vector<std::uint32_t>{5, 6, 7}));
  EXPECT_THROW(slots.acquire(1), UsageError);
  slots.release(first);
  EXPECT_EQ(slots.acquire(2), first);
}

}  // namespace
}  // namespace quintet::test
