// SPDX-License-Identifier: Apache-2.0
// Scenes from memory: what they hold, what they reject, and that they render like the same scene from a file.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(ApiScene, CountsWhatWasAdded) {
  const Scene scene = lampScene();
  EXPECT_EQ(scene.meshCount(), 3u);
  EXPECT_EQ(scene.materialCount(), 3u);
  EXPECT_EQ(scene.instanceCount(), 3u);
  EXPECT_EQ(scene.lightCount(), 0u);
  EXPECT_EQ(scene.findInstance("lamp"), 1);
  EXPECT_EQ(scene.findMaterial("panel"), 2);
  EXPECT_EQ(scene.findInstance("sun"), std::nullopt);
  EXPECT_EQ(scene.bounds(), (Bounds{{-3, 0, -3}, {3, 2.5f, 3}}));
  EXPECT_EQ(scene.transform(2), Transform::translation({0.6f, 1, 0}) * Transform::scaling({0.5f, 1, 0.5f}));
}

TEST(ApiScene, ReturnsMaterialsAsTheyWereAdded) {
  Scene scene;
  const std::array<std::uint8_t, 3> pixel{10, 20, 30};
  const int texture =
      scene.addTexture({.width = 1, .height = 1, .channels = 3, .pixels = std::span<const std::uint8_t>(pixel)});
  const Material material{
      .name = "all",
      .baseColor = {0.1f, 0.2f, 0.3f, 0.4f},
      .baseColorTexture = {.texture = texture, .uvSet = 1, .offset = {0.5f, 1}, .scale = {2, 3}, .rotation = 1},
      .metallic = 0.5f,
      .roughness = 0.25f,
      .emissive = {1, 2, 3},
      .alphaMode = AlphaMode::mask,
      .alphaCutoff = 0.3f,
      .doubleSided = true,
      .ior = 1.7f,
      .transmission = 0.6f,
      .thickness = 0.1f,
      .attenuationDistance = 2,
      .attenuationColor = {0.5f, 0.6f, 0.7f},
      .specular = 0.9f,
      .specularColor = {1, 2, 3},
      .clearcoat = 0.8f,
      .clearcoatRoughness = 0.15f,
      .sheenColor = {0.4f, 0.3f, 0.2f},
      .sheenRoughness = 0.35f,
      .diffuseTransmission = 0.45f,
      .diffuseTransmissionColor = {0.3f, 0.2f, 0.1f},
      .anisotropy = 0.55f,
      .anisotropyRotation = 1.5f,
      .anisotropyTexture = {.texture = texture},
      .iridescence = 0.65f,
      .iridescenceTexture = {.texture = texture, .uvSet = 1},
      .iridescenceIor = 1.4f,
      .iridescenceThicknessMinimum = 120,
      .iridescenceThicknessMaximum = 480,
      .iridescenceThicknessTexture = {.texture = texture, .rotation = 0.5f},
      .dispersion = 0.3f,
      .multiscatterColor = {0.5f, 0.25f, 1},
      .scatterAnisotropy = 0.5f,
      .dielectricPriority = 2};
  EXPECT_EQ(scene.material(scene.addMaterial(material)), material);
}

TEST(ApiScene, CopiesAreIndependent) {
  const Scene original = lampScene();
  Scene copy = original;
  copy.addInstance({.mesh = 0});
  copy.setTransform(0, Transform::translation({0, 5, 0}));
  EXPECT_EQ(original.instanceCount(), 3u);
  EXPECT_EQ(copy.instanceCount(), 4u);
  EXPECT_EQ(original.transform(0), Transform::scaling({3, 1, 3}));
}

TEST(ApiScene, RejectsInvalidObjectsAndStaysUnchanged) {
  Scene scene = lampScene();
  const std::array<Float3, 3> normals{{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}};
  const std::array<UInt3, 1> beyond{{{0, 1, 4}}};
  std::array<Float3, 4> infinite = kCorners;
  infinite[2][1] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(scene.addMesh({.positions = kCorners, .indices = kSquare, .normals = normals}), UsageError);
  EXPECT_THROW(scene.addMesh({.positions = kCorners, .indices = beyond}), UsageError);
  EXPECT_THROW(scene.addMesh({.positions = infinite, .indices = kSquare}), UsageError);
  EXPECT_THROW(scene.addMesh({.positions = kCorners}), UsageError);  // 4 vertices are no list of triangles
  EXPECT_THROW(scene.addMesh({.positions = kCorners, .indices = kSquare, .material = 3}), UsageError);
  EXPECT_THROW(scene.addInstance({.mesh = 3}), UsageError);
  EXPECT_THROW(scene.addInstance({.mesh = 0, .worldFromObject = Transform::scaling({1, 0, 1})}), UsageError);
  EXPECT_THROW(scene.addInstance({.mesh = 0, .mask = 256}), UsageError);
  EXPECT_THROW(scene.addMaterial({.roughness = 1.5f}), UsageError);
  EXPECT_THROW(scene.addMaterial({.baseColorTexture = {.texture = 0}}), UsageError);
  EXPECT_THROW(scene.setMaterial(0, {.metallic = kNan}), UsageError);
  EXPECT_THROW(scene.setMaterial(3, {}), UsageError);
  EXPECT_THROW(scene.setTransform(-1, {}), UsageError);
  EXPECT_THROW(scene.addLight({.intensity = {1, -1, 1}}), UsageError);
  EXPECT_THROW(scene.addLight({.type = LightType::spot, .direction = {0, 0, 0}}), UsageError);
  EXPECT_THROW(scene.addCamera({.verticalFov = 4}), UsageError);
  EXPECT_THROW(scene.setEnvironment({.radiance = {0, kNan, 0}}), UsageError);
  const std::array<float, 5> values{};
  EXPECT_THROW(scene.addTexture({.width = 2, .height = 1, .channels = 3, .pixels = std::span<const float>(values)}),
               UsageError);
  EXPECT_EQ(scene.meshCount(), 3u);
  EXPECT_EQ(scene.materialCount(), 3u);
  EXPECT_EQ(scene.instanceCount(), 3u);
  EXPECT_EQ(scene.lightCount() + scene.cameraCount(), 0u);
  EXPECT_EQ(scene.material(0).metallic, 0.0f);
}

TEST(ApiScene, MessagesNameTheObject) {
  Scene scene = lampScene();
  const std::array<float, 6> values{1, 1, 1, 1, kNan, 1};
  const std::array<Float3, 2> radiance{{{1, 1, 1}, {1, kNan, 1}}};
  const std::span<const float> texels(values);
  const auto material = [&](Material changed) {
    changed.name = "steel";
    return messageOf([&] { scene.addMaterial(changed); });
  };
  const int texture = scene.addTexture({.width = 1, .height = 1, .channels = 3, .pixels = texels.first(3)});
  EXPECT_THAT(material({.roughness = 2}), HasSubstr("'steel'.roughness"));
  EXPECT_THAT(material({.normalScale = kNan}), HasSubstr("'steel'.normalScale"));
  EXPECT_THAT(material({.alphaCutoff = kNan}), HasSubstr("'steel'.alphaCutoff"));
  EXPECT_THAT(material({.sheenColor = {0, 2, 0}}), HasSubstr("'steel'.sheenColor"));
  EXPECT_THAT(material({.anisotropy = 1.5f}), HasSubstr("'steel'.anisotropy"));
  EXPECT_THAT(material({.anisotropyRotation = kNan}), HasSubstr("'steel'.anisotropyRotation"));
  EXPECT_THAT(material({.iridescence = -1}), HasSubstr("'steel'.iridescence"));
  EXPECT_THAT(material({.iridescenceIor = 0.9f}), HasSubstr("'steel'.iridescenceIor"));
  EXPECT_THAT(material({.iridescenceThicknessMinimum = -1}), HasSubstr("'steel'.iridescenceThicknessMinimum"));
  EXPECT_THAT(material({.iridescenceThicknessMaximum = kNan}), HasSubstr("'steel'.iridescenceThicknessMaximum"));
  EXPECT_THAT(material({.dispersion = -0.1f}), HasSubstr("'steel'.dispersion"));
  EXPECT_THAT(material({.clearcoatNormalScale = kNan}), HasSubstr("'steel'.clearcoatNormalScale"));
  for (const TextureUse& use :
       {TextureUse{.texture = texture, .offset = {0, kNan}}, TextureUse{.texture = texture, .scale = {kNan, 1}},
        TextureUse{.texture = texture, .rotation = kNan}})
    EXPECT_THAT(material({.emissiveTexture = use}), HasSubstr("'steel': the transform of texture"));
  EXPECT_THAT(messageOf([&] { scene.setMaterial(0, {.name = "tin", .metallic = 2}); }), HasSubstr("'tin'.metallic"));
  EXPECT_THAT(messageOf([&] { scene.addInstance({.mesh = 9, .name = "chair"}); }), HasSubstr("'chair'.mesh"));
  EXPECT_THAT(messageOf([&] { scene.setTransform(2, Transform::scaling({0, 1, 1})); }), HasSubstr("'panel'"));
  EXPECT_THAT(messageOf([&] { scene.addMesh({.positions = kCorners}, "list"); }), HasSubstr("mesh 'list'"));
  EXPECT_THAT(messageOf([&] { scene.addMesh({.positions = kCorners, .indices = kSquare, .material = 7}, "quad"); }),
              HasSubstr("'quad'"));
  EXPECT_THAT(messageOf([&] { scene.addLight({.intensity = {0, -1, 0}, .name = "sun"}); }), HasSubstr("light 'sun'"));
  EXPECT_THAT(messageOf([&] { scene.addCamera({.verticalFov = 4}, "front"); }), HasSubstr("camera 'front'"));
  EXPECT_THAT(messageOf([&] {
                scene.addTexture({.name = "bricks", .width = 2, .height = 1, .channels = 3, .pixels = texels});
              }),
              AllOf(HasSubstr("texture 'bricks'"), HasSubstr("pixel (1, 0)")));
  EXPECT_THAT(messageOf([&] { scene.setEnvironment({.width = 2, .height = 1, .pixels = radiance}); }),
              AllOf(HasSubstr("environment"), HasSubstr("pixel (1, 0)")));
}

// Values above the largest radiance or coordinate would make sums over samples infinite.
TEST(ApiScene, RejectsValuesAboveTheLimitsOfTheRenderer) {
  Scene scene = lampScene();
  const std::array<float, 4> texels{1, 1e12f, 1e20f, 0};
  EXPECT_THAT(messageOf([&] {
                scene.addTexture(
                    {.name = "sky", .width = 4, .height = 1, .channels = 1, .pixels = std::span<const float>(texels)});
              }),
              HasSubstr("texture 'sky': pixel (2, 0) is 1e+20, above 1e+12"));
  EXPECT_THAT(messageOf([&] { scene.addLight({.intensity = {0, 1e13f, 0}, .name = "sun"}); }), HasSubstr("1e+12"));
  EXPECT_THAT(messageOf([&] {
                scene.addMaterial({.name = "lamp", .emissive = {1e20f, 0, 0}});
              }),
              HasSubstr("emissive"));
  EXPECT_THAT(messageOf([&] { scene.setEnvironment({.radiance = {1e13f, 0, 0}}); }), HasSubstr("1e+12"));
  EXPECT_THAT(messageOf([&] { scene.setTransform(1, Transform::scaling({1, 1e20f, 1})); }), HasSubstr("'lamp'"));
  scene.setEnvironment({.radiance = {1e12f, 0, 0}});
}

TEST(ApiScene, RendersLikeTheSameSceneInAFile) {
  Scene memory;
  const std::array<Float2, 4> uv{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const std::array<Float4, 4> colors{{{1, 0.2f, 0.2f, 1}, {0.2f, 1, 0.2f, 1}, {0.2f, 0.2f, 1, 1}, {1, 1, 1, 1}}};
  memory.addMesh({.positions = kCorners,
                  .indices = kSquare,
                  .uv0 = uv,
                  .colors = colors,
                  .material = memory.addMaterial({.baseColor = {0.8f, 0.7f, 0.6f, 1}, .roughness = 0.5f})});
  memory.addInstance({.mesh = 0});
  memory.addLight({.intensity = {20, 20, 20}, .position = {1, 2, 1}});
  memory.setEnvironment({.radiance = {0.1f, 0.1f, 0.2f}});
  const Scene file = Scene::fromToml(R"(
[[material]]
name = "m"
base_color = [0.8, 0.7, 0.6]
roughness = 0.5
[[mesh]]
positions = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]
indices = [[0, 1, 2], [0, 2, 3]]
uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
colors = [[1, 0.2, 0.2, 1], [0.2, 1, 0.2, 1], [0.2, 0.2, 1, 1], [1, 1, 1, 1]]
material = "m"
[[light]]
type = "point"
intensity = 20
position = [1, 2, 1]
[environment]
color = [0.1, 0.1, 0.2]
)");
  EXPECT_EQ(rendered(memory), rendered(file));
}

TEST(ApiScene, TexturesCoverTheMesh) {
  // The left half is red, the right half green; unlit, so the image shows the texels.
  const std::array<float, 6> texels{1, 0, 0, 0, 1, 0};
  const std::array<Float2, 4> uv{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  Scene scene;
  const int texture = scene.addTexture({.width = 2,
                                        .height = 1,
                                        .channels = 3,
                                        .pixels = std::span<const float>(texels),
                                        .wrapU = Wrap::clampToEdge,
                                        .filter = Filter::nearest});
  const int material = scene.addMaterial({.baseColorTexture = {.texture = texture}, .unlit = true});
  scene.addMesh({.positions = kCorners, .indices = kSquare, .uv0 = uv, .material = material});
  scene.addInstance({.mesh = 0});
  Renderer renderer(
      device(), scene, pathTracer(),
      {.width = 32, .height = 32, .camera = Camera{.lookFrom = {0, 3, 0}, .up = {0, 0, -1}, .verticalFov = 0.5f}});
  renderer.render(4);
  const Image image = renderer.image();
  const auto left = image.at(8, 16), right = image.at(24, 16);
  EXPECT_NEAR(left[0], 1, 1e-3);
  EXPECT_NEAR(left[1], 0, 1e-3);
  EXPECT_NEAR(right[0], 0, 1e-3);
  EXPECT_NEAR(right[1], 1, 1e-3);
}

// The header states 192 MiB of pixels, which do not follow.
TEST(ApiScene, LimitsTheMemoryOfFiles) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("quintet_lying_" + std::to_string(::getpid()) + ".hdr");
  std::ofstream(file) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n";
  constexpr std::size_t kLimit = std::size_t{1} << 20;
  Scene scene;
  EXPECT_THROW(scene.addTexture(file, kLimit), MemoryError);
  EXPECT_THROW(scene.setEnvironment(file, kLimit), MemoryError);
  const std::string text = "[environment]\nimage = \"" + file.filename().string() + "\"\n";
  EXPECT_THROW(Scene::fromToml(text, file.parent_path(), kLimit), MemoryError);
  EXPECT_THROW(scene.addTexture(file), FileError) << "the default limit is that of the machine";
  std::filesystem::remove(file);
}

TEST(ApiScene, FromTomlReportsTheLine) {
  try {
    Scene::fromToml("[[material]]\nname = \"a\"\nrougness = 1\n");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.location(), "line 3");
  }
}

}  // namespace
}  // namespace quintet::test
