// SPDX-License-Identifier: Apache-2.0
// The table of all lights: powers of each kind computed by hand, slots, instances, and textures.
#include "render/lights/light_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

// The unit square [0,1]² in z = 0 as two triangles.
scene::Geometry unitSquare(int material) {
  scene::Geometry geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  geometry.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  geometry.material = material;
  return geometry;
}

scene::Material emitter(const vec3& emission) {
  scene::Material material;
  material.emissive = emission;
  return material;
}

scene::Instance instanceOf(int mesh, const mat4& worldFromObject = mat4(1.0f)) {
  scene::Instance instance;
  instance.mesh = mesh;
  instance.worldFromObject = worldFromObject;
  return instance;
}

// Material 0 is dark, material 1 emits; mesh 0 is a dark square, mesh 1 an emissive one.
scene::Scene squares(const vec3& emission = vec3(2.0f)) {
  scene::Scene scene;
  scene.materials = {scene::Material{}, emitter(emission)};
  scene.meshes.resize(2);
  scene.meshes[0].geometries = {unitSquare(0)};
  scene.meshes[1].geometries = {unitSquare(1)};
  return scene;
}

std::vector<double> probabilities(const LightTable& table) {
  std::vector<double> result;
  for (const shared::AliasEntry& entry : table.entries) result.push_back(entry.probability);
  return result;
}

TEST(LightTable, IsEmptyWithoutEmission) {
  scene::Scene scene = squares(vec3(0.0f));
  scene.instances = {instanceOf(0), instanceOf(1)};
  scene.lights.resize(1);
  scene.lights[0].intensity = vec3(0.0f);
  const LightTable table = buildLightTable(scene, {});
  EXPECT_TRUE(table.lights.empty());
  EXPECT_TRUE(table.entries.empty());
  EXPECT_EQ(table.environmentLight, shared::kNoLight);
  EXPECT_EQ(table.slots, (std::vector<std::uint32_t>{shared::kNoLight, shared::kNoLight}));
  EXPECT_EQ(table.firstSlots, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(buildLightTable(scene::Scene{}, {}).lights.empty());
}

TEST(LightTable, SamplesByPowerWithinClasses) {
  scene::Scene scene = squares(vec3(2.0f));
  scene.instances = {instanceOf(1)};
  scene.lights.resize(4);
  scene.lights[0].intensity = vec3(0.5f);
  scene.lights[1].type = scene::LightType::spot;
  scene.lights[1].intensity = vec3(3.0f);
  scene.lights[1].innerConeAngle = 0.3f;
  scene.lights[1].outerConeAngle = 0.8f;
  scene.lights[2].type = scene::LightType::directional;
  scene.lights[2].intensity = vec3(1.5f);
  scene.lights[3].intensity = vec3(0.0f);
  scene::Environment environment;
  environment.constant = vec3(0.7f);

  const LightTable table = buildLightTable(scene, environment);
  ASSERT_EQ(table.lights.size(), 7u);
  EXPECT_EQ(table.environmentLight, 6u);
  const double crossSection = std::numbers::pi * 0.5;  // R² of the unit square
  const double cosInner = std::cos(0.3), cosOuter = std::cos(0.8);
  const double spot = 3.0 * 2.0 * std::numbers::pi * ((1.0 - cosInner) + (cosInner - cosOuter) / 3.0);
  const std::vector<double> powers{4.0 * std::numbers::pi * 0.5,
                                   spot,
                                   1.5 * crossSection,
                                   0.0,
                                   std::numbers::pi * 0.5 * 2.0,
                                   std::numbers::pi * 0.5 * 2.0,
                                   4.0 * std::numbers::pi * 0.7 * crossSection};
  const double local = powers[0] + powers[1], directional = powers[2], triangles = powers[4] + powers[5];
  const double total = local + directional + triangles + powers[6];
  const auto share = [&](double power, double ofClass) { return power / ofClass * (0.1 + 0.6 * ofClass / total); };
  const std::vector<double> expected{
      share(powers[0], local),     share(powers[1], local),     share(powers[2], directional), 0.0,
      share(powers[4], triangles), share(powers[5], triangles), share(powers[6], powers[6])};
  const std::vector<double> found = probabilities(table);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-5) << i;
  EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), 1.0, 1e-6);
}

TEST(LightTable, GivesEachClassItsMinimumShare) {
  scene::Scene scene = squares(vec3(1e-6f));
  scene.instances = {instanceOf(0, glm::scale(mat4(1.0f), vec3(1e4f))), instanceOf(1)};
  scene::Environment environment;
  environment.constant = vec3(1e3f);
  const LightTable table = buildLightTable(scene, environment);
  EXPECT_NEAR(table.entries[0].probability + table.entries[1].probability, kMinimumClassShare, 1e-5);
  EXPECT_NEAR(table.entries[2].probability, 1.0 - kMinimumClassShare, 1e-5);
}

TEST(LightTable, IntegratesSpotAttenuation) {
  for (const auto& [inner, outer] :
       {std::pair{0.0, 0.5}, {0.3, 0.8}, {0.5, 0.5}, {0.0, 0.01}, {1.0, std::numbers::pi / 2}}) {
    const double cosInner = std::cos(inner), cosOuter = std::cos(outer);
    double sum = 0.0;
    constexpr int kSteps = 200'000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = cosOuter + (1.0 - cosOuter) * (i + 0.5) / kSteps;
      const double a = std::clamp((c - cosOuter) / std::max(0.001, cosInner - cosOuter), 0.0, 1.0);
      sum += a * a * 2.0 * std::numbers::pi * (1.0 - cosOuter) / kSteps;
    }
    EXPECT_NEAR(spotSolidAngle(cosInner, cosOuter), sum, 1e-6 * sum) << inner << " " << outer;
  }
}

TEST(LightTable, CopiesPunctualLights) {
  scene::Scene scene;
  scene.lights.resize(1);
  scene.lights[0].type = scene::LightType::spot;
  scene.lights[0].intensity = {1, 2, 3};
  scene.lights[0].position = {4, 5, 6};
  scene.lights[0].direction = {0, -1, 0};
  scene.lights[0].innerConeAngle = 0.2f;
  scene.lights[0].outerConeAngle = 0.4f;
  const shared::LightData light = buildLightTable(scene, {}).lights.at(0);
  EXPECT_EQ(light.type, shared::kLightSpot);
  EXPECT_EQ(light.intensity, vec3(1, 2, 3));
  EXPECT_EQ(light.position, vec3(4, 5, 6));
  EXPECT_EQ(light.direction, vec3(0, -1, 0));
  EXPECT_FLOAT_EQ(light.cosInner, std::cos(0.2f));
  EXPECT_FLOAT_EQ(light.cosOuter, std::cos(0.4f));
}

// A slot per geometry of an instance; triangle p of the geometry is p lights after its slot.
TEST(LightTable, AssignsSlotsAndIndices) {
  scene::Scene scene = squares();
  scene.meshes[1].geometries = {unitSquare(0), unitSquare(1), unitSquare(scene::kNone), unitSquare(1)};
  scene.instances = {instanceOf(1), instanceOf(0), instanceOf(1)};
  scene.lights.resize(1);
  const LightTable table = buildLightTable(scene, {});
  EXPECT_EQ(table.firstSlots, (std::vector<std::uint32_t>{0, 4, 5}));
  const std::uint32_t none = shared::kNoLight;
  EXPECT_EQ(table.slots, (std::vector<std::uint32_t>{none, 1, none, 3, none, none, 5, none, 7}));
  ASSERT_EQ(table.lights.size(), 9u);
  const shared::LightData& last = table.lights[8];
  EXPECT_EQ(last.type, shared::kLightTriangle);
  EXPECT_EQ(last.instance, 2u);
  EXPECT_EQ(last.geometry, 3u);
  EXPECT_EQ(last.primitive, 1u);
}

// A texture on the emissive square of `squares`.
scene::Scene textured(io::Image image, scene::Sampler sampler = {}) {
  scene::Scene scene = squares(vec3(2.0f));
  scene.images.push_back({"image", std::move(image)});
  scene.textures.push_back({"texture", 0, sampler});
  scene.materials[1].emissiveTexture.texture = 0;
  scene.instances = {instanceOf(1)};
  return scene;
}

io::Image gray(std::uint32_t width, std::uint32_t height, auto value) {
  io::Image image = io::makeImage(width, height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (float& c : image.pixel<float>(x, y)) c = static_cast<float>(value(x, y));
  return image;
}

bool equal(const LightTable& a, const LightTable& b) {
  const auto bytes = [](const auto& values) {
    const auto view = std::as_bytes(std::span(values));
    return std::vector<std::byte>(view.begin(), view.end());
  };
  return bytes(a.lights) == bytes(b.lights) && bytes(a.nodes) == bytes(b.nodes) &&
         bytes(a.entries) == bytes(b.entries) && a.slots == b.slots && a.firstSlots == b.firstSlots &&
         a.environmentLight == b.environmentLight;
}

TEST(LightTable, EditsGiveTheTableOfTheEditedScene) {
  scene::Scene scene = squares();
  scene.instances = {instanceOf(0), instanceOf(1)};
  scene.lights.resize(2);
  scene::Environment environment;
  environment.constant = vec3(0.5f);
  LightTableBuilder builder(scene, environment);
  LightTable table;  // is built in the memory of the last one
  const auto expectTableOfScene = [&](const char* edit) {
    const LightTable expected = buildLightTable(scene, environment);
    builder.build(std::vector<mat4>(2, mat4(1.0f)), table);
    EXPECT_TRUE(equal(table, expected)) << edit;
  };
  expectTableOfScene("none");
  scene.lights[1].intensity = {3, 2, 1};
  builder.setPunctualLights(scene.lights);
  expectTableOfScene("light");
  scene.materials[0].emissive = vec3(1.0f);
  scene.materials[1].emissive = vec3(0.0f);
  builder.setEmission(scene);
  expectTableOfScene("emission");
  environment.intensity = 0.3f;
  builder.setEnvironment(buildEnvironmentTable(environment).integral);
  expectTableOfScene("intensity");
  environment.intensity = 0.0f;
  builder.setEnvironment(0.0);
  expectTableOfScene("no environment");
}

// Instances of a grid of triangles, more lights than one task builds: the tables after each edit of a material are those
// of a new scene. Textures, a set of solids with two materials, and lights that come and go.
TEST(LightTable, EditsOfManyLightsGiveTheTableOfTheEditedScene) {
  scene::Scene scene = textured(gray(16, 16, [](auto x, auto y) { return x < 8 ? 0.0 : 1.0 + y; }));
  scene.materials.push_back(emitter({0.25f, 0.5f, 1.0f}));
  scene::Geometry& grid = scene.meshes[0].geometries[0];
  grid = {};
  grid.material = 0;
  for (std::uint32_t i = 0; i < 1500; ++i) {
    const vec3 corner(i % 40, i / 40, std::sin(static_cast<float>(i)));
    grid.positions.insert(grid.positions.end(), {corner, corner + vec3(0.5f, 0, 0.1f), corner + vec3(0, 0.7f, 0)});
    grid.triangles.push_back(uvec3(0, 1, 2) + 3 * i);
  }
  scene::PrimitiveSet& solids = scene.meshes.emplace_back().primitiveSets.emplace_back();
  solids.primitives.resize(4);
  for (int i = 0; i < 4; ++i) solids.primitives[static_cast<std::size_t>(i)].material = i % 3;
  for (int i = 0; i < 9; ++i) {
    const mat4 turned = glm::rotate(mat4(1.0f), 0.3f * static_cast<float>(i), vec3(0, 1, 0));
    scene.instances.push_back(instanceOf(i % 4 == 3 ? i / 4 + 1 : 0, turned));
  }
  std::vector<mat4> worldFromObject;
  for (const scene::Instance& instance : scene.instances) worldFromObject.push_back(instance.worldFromObject);
  LightTableBuilder builder(scene, {});
  builder.copyGeometry();
  LightTable table;
  const auto expectTableOf = [&](const scene::Scene& edited, std::size_t lights) {
    builder.setEmission(edited);
    builder.copyGeometry();
    builder.build(worldFromObject, table);
    EXPECT_TRUE(equal(table, buildLightTable(edited, {})));
    EXPECT_EQ(table.lights.size(), lights);
  };
  const std::size_t square = 2 * 2, set = 4, grids = 7 * 1500;
  builder.build(worldFromObject, table);
  EXPECT_EQ(table.lights.size(), square + set);
  scene::Scene edited = scene;
  edited.materials[0].emissive = {0.5f, 0.25f, 2.0f};
  expectTableOf(edited, grids + square + set);
  edited.materials[0].emissive = {0.5f, 2.0f, 0.25f};  // all lights, with new powers
  expectTableOf(edited, grids + square + set);
  edited.materials[1].emissive = vec3(0.0f);
  expectTableOf(edited, grids + set);
  edited.materials[0].unlit = true;
  expectTableOf(edited, set);
  edited.materials[2].emissive = vec3(0.0f);
  edited.materials[1].emissive = vec3(3.0f);
  edited.materials[1].emissiveTexture.offset = vec2(0.5f, 0.0f);
  expectTableOf(edited, square + set);
  expectTableOf(scene, square + set);
}

// Only edits that change an emission require new tables.
TEST(LightTable, EditsThatDoNotChangeAnEmissionAreFound) {
  scene::Scene scene = squares();
  scene.instances = {instanceOf(0), instanceOf(1)};
  LightTableBuilder builder(scene, {});
  EXPECT_FALSE(builder.setEmission(scene));
  scene.materials[1].baseColor = vec4(0.5f);
  scene.materials[1].doubleSided = true;
  EXPECT_FALSE(builder.setEmission(scene));
  scene.materials[1].emissive += vec3(1.0f);
  EXPECT_TRUE(builder.setEmission(scene));
  EXPECT_FALSE(builder.setEmission(scene));
  scene.materials[1].unlit = true;
  EXPECT_TRUE(builder.setEmission(scene));
}

// Instances that no ray hits are not lights.
TEST(LightTable, HiddenInstancesHaveNoLights) {
  scene::Scene scene = squares();
  scene.instances = {instanceOf(1), instanceOf(1), instanceOf(1)};
  scene.instances[0].mask = 0;
  scene.instances[1].mask = 0x100;  // only 8 bits are used
  scene.instances[2].mask = 0x80;
  const LightTable table = buildLightTable(scene, {});
  EXPECT_EQ(table.firstSlots, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(table.slots, (std::vector<std::uint32_t>{shared::kNoLight, shared::kNoLight, 0}));
  ASSERT_EQ(table.lights.size(), 2u);
  EXPECT_EQ(table.lights[0].instance, 2u);
  EXPECT_NEAR(table.entries[0].probability, 0.5, 1e-6);
}

// A surface that is missing everywhere emits nothing, unless an animation can show it.
TEST(LightTable, InvisibleMaterialsAreNoLights) {
  scene::Scene scene = squares();
  scene.instances = {instanceOf(1)};
  scene::Material& material = scene.materials[static_cast<std::size_t>(scene.meshes[1].geometries[0].material)];
  material.alphaMode = scene::AlphaMode::mask;
  material.alphaCutoff = 1.0f;
  EXPECT_EQ(buildLightTable(scene, {}).lights.size(), 2u) << "an alpha equal to the cutoff is visible";
  material.alphaCutoff = 1.01f;
  EXPECT_TRUE(buildLightTable(scene, {}).lights.empty());
  scene.materialStates.assign(scene.materials.size(), {material});
  EXPECT_EQ(buildLightTable(scene, {}).lights.size(), 2u);
}

TEST(LightTable, ScalesPowerWithWorldArea) {
  scene::Scene scene = squares();
  const mat4 mirrored = glm::scale(mat4(1.0f), vec3(-1.0f, 3.0f, 1.0f));
  const mat4 turned = glm::rotate(glm::translate(mat4(1.0f), vec3(5, 6, 7)), 0.7f, vec3(0, 1, 0));
  const mat4 doubled = glm::scale(mat4(1.0f), vec3(2.0f));
  scene.instances = {instanceOf(1), instanceOf(1, doubled), instanceOf(1, mirrored), instanceOf(1, turned)};
  const std::vector<double> found = probabilities(buildLightTable(scene, {}));
  const std::vector<double> areas{1, 1, 4, 4, 3, 3, 1, 1};
  for (std::size_t i = 0; i < areas.size(); ++i) EXPECT_NEAR(found[i], areas[i] / 18.0, 1e-6) << i;
}

TEST(LightTable, SkipsDegenerateTrianglesAndUnlitMaterials) {
  scene::Scene scene = squares();
  scene.meshes[1].geometries[0].triangles.push_back({0, 1, 1});
  scene.instances = {instanceOf(1)};
  const LightTable table = buildLightTable(scene, {});
  ASSERT_EQ(table.entries.size(), 3u);
  EXPECT_EQ(table.entries[2].probability, 0.0f);
  EXPECT_NEAR(table.entries[0].probability, 0.5f, 1e-6f);
  scene.materials[1].unlit = true;
  EXPECT_TRUE(buildLightTable(scene, {}).lights.empty());
}

TEST(LightTable, SkipsTheLargestGeometriesBeyondTheLimit) {
  scene::Scene scene = squares();
  scene.meshes.push_back(scene.meshes[1]);
  for (int i = 0; i < 10; ++i) scene.meshes[2].geometries[0].triangles.push_back({0, 1, 2});
  scene.instances = {instanceOf(2), instanceOf(1), instanceOf(2), instanceOf(1)};
  const std::uint32_t none = shared::kNoLight;
  EXPECT_EQ(buildLightTable(scene, {}).lights.size(), 28u);
  const LightTable table = buildLightTable(scene, {}, 17);
  EXPECT_EQ(table.slots, (std::vector<std::uint32_t>{4, 0, none, 2}));
  EXPECT_EQ(buildLightTable(scene, {}, 3).slots, (std::vector<std::uint32_t>{none, 0, none, none}));
}

// Returns the mean radiance of a textured square, from its probability relative to that of a point light.
double meanRadiance(scene::Scene scene) {
  scene.lights.resize(1);
  scene.lights[0].intensity = vec3(1.0f);
  const LightTable table = buildLightTable(scene, {});
  const double share = (table.entries[0].probability - 0.1) / 0.8;
  return 4.0 * std::numbers::pi * (1.0 / share - 1.0) / std::numbers::pi;
}

TEST(LightTable, AveragesTextures) {
  const auto one = [](auto, auto) { return 1.0; };
  EXPECT_NEAR(meanRadiance(textured(gray(4, 4, one))), 2.0, 1e-3);
  // A ramp: large triangles use coarser levels, which have the same mean. Borders add an error of a texel.
  for (const std::uint32_t size : {8u, 64u, 1000u, 2048u}) {
    const auto ramp = [size](auto x, auto) { return (x + 0.5) / size; };
    EXPECT_NEAR(meanRadiance(textured(gray(size, size, ramp))), 1.0, 0.02) << size;
  }
  io::Image bytes = io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (std::uint8_t& v : bytes.samples<std::uint8_t>()) v = 188;
  EXPECT_NEAR(meanRadiance(textured(bytes)), 2.0 * 0.5029, 2e-3);
}

TEST(LightTable, SkipsBlackPartsOfTextures) {
  // White below the diagonal x = y of the texture, far from it: triangle 0 (u ≥ v) is white, 1 is black.
  const auto lower = [](auto x, auto y) { return x > y + 2 ? 1.0 : 0.0; };
  scene::Sampler clamped;
  clamped.wrapU = clamped.wrapV = scene::Wrap::clampToEdge;
  const LightTable table = buildLightTable(textured(gray(32, 32, lower), clamped), {});
  EXPECT_EQ(table.entries[0].probability, 1.0f);
  EXPECT_EQ(table.entries[1].probability, 0.0f);
}

// A single bright texel at any position gives power to the triangle that shows it, for all texture sizes.
TEST(LightTable, FindsSingleBrightTexels) {
  for (const std::uint32_t size : {5u, 33u, 300u, 1023u})
    for (const uvec2 bright : {uvec2(0, 0), uvec2(size - 1, 0), uvec2(size - 1, size / 2), uvec2(size / 2, size / 2)}) {
      const auto spot = [&](auto x, auto y) { return uvec2(x, y) == bright ? 1000.0 : 0.0; };
      const LightTable table = buildLightTable(textured(gray(size, size, spot)), {});
      ASSERT_EQ(table.entries.size(), 2u);
      EXPECT_GT(table.entries[0].probability, 0.0f) << size << " " << bright.x << "," << bright.y;
    }
}

TEST(LightTable, AppliesTextureTransformAndWrap) {
  // The left half is white. The transform shows only u in [0, 0.25], or with an offset only the black half.
  const auto left = [](auto x, auto) { return x < 32 ? 1.0 : 0.0; };
  scene::Scene scene = textured(gray(64, 64, left));
  scene.materials[1].emissiveTexture.scale = vec2(0.25f, 1.0f);
  scene.materials[1].emissiveTexture.offset = vec2(0.1f, 0.0f);
  EXPECT_NEAR(meanRadiance(scene), 2.0, 1e-3);
  scene.materials[1].emissiveTexture.offset = vec2(0.6f, 0.0f);
  EXPECT_TRUE(buildLightTable(scene, {}).lights.empty());
  scene.materials[1].emissiveTexture.offset = vec2(1.1f, 0.0f);
  EXPECT_NEAR(meanRadiance(scene), 2.0, 1e-3);
  scene.textures[0].sampler.wrapU = scene::Wrap::clampToEdge;
  EXPECT_TRUE(buildLightTable(scene, {}).lights.empty());
  scene.textures[0].sampler.wrapU = scene::Wrap::mirroredRepeat;
  EXPECT_TRUE(buildLightTable(scene, {}).lights.empty());
  scene.materials[1].emissiveTexture.offset = vec2(1.7f, 0.0f);
  EXPECT_NEAR(meanRadiance(scene), 2.0, 1e-3);
}

}  // namespace
}  // namespace quintet::render
