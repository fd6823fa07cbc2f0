// SPDX-License-Identifier: Apache-2.0
// Light through glass and alpha against closed forms: slabs, thin walls, blend, mask, transparent backgrounds, and
// unlit surfaces.
#include <gtest/gtest.h>

#include <array>

#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

ImageOptions batches(std::uint32_t count, std::uint32_t size = 8) {
  ImageOptions options;
  options.batches = count;
  options.width = options.height = size;
  return options;
}

// Returns the reflectance of a smooth interface for unpolarized light (Fresnel 1823). `eta` is the index behind the
// interface over the index in front of it.
double unpolarizedFresnel(double cosine, double eta) {
  const double inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * inside) / (cosine + eta * inside);
  const double p = (eta * cosine - inside) / (eta * cosine + inside);
  return 0.5 * (s * s + p * p);
}

constexpr float kFar = 4.0f;  // distance of the wall
const vec3 kBehind(1.0f, 0.5f, 2.0f);

// A camera along -z looks through a geometry that is rotated about y, in front of an emissive wall on a black
// background. The image is small: every path that leaves the slab straight hits the wall, and all others hit the
// background. The angle must be less than 45 degrees; beyond it, reflected paths hit the wall, too.
SceneBuilder lookingThrough(const scene::Geometry& geometry, const scene::Material& material, float degrees) {
  SceneBuilder scene;
  const mat4 turned = glm::rotate(mat4(1.0f), glm::radians(degrees), vec3(0, 1, 0));
  scene.add(geometry, material, turned).add(quad({-50, -50, -kFar}, {100, 0, 0}, {0, 100, 0}), emitter(kBehind));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  return scene;
}

struct SlabCase {
  const char* name;
  float degrees;
  float ior;
  float absorbs;  // transmittance of 1 m
};

class GlassSlab : public testing::TestWithParam<SlabCase> {};

// The sum over all internal reflections is T = (1-R)² a / (1 - R² a²), where a is the transmittance of one crossing.
TEST_P(GlassSlab, TransmitsByFresnelAndBeer) {
  const SlabCase& c = GetParam();
  constexpr double kThickness = 0.3;
  scene::Material glass = clearGlass(c.ior, static_cast<float>(kThickness));
  glass.attenuationColor = vec3(c.absorbs, 1.0f, std::sqrt(c.absorbs));
  glass.attenuationDistance = 1.0f;
  const auto half = static_cast<float>(0.5 * kThickness);
  const RenderedImage image =
      renderImage(lookingThrough(box({-3, -3, -half}, {3, 3, half}), glass, c.degrees), batches(64));

  const double cosine = std::cos(glm::radians(static_cast<double>(c.degrees)));
  const double r = unpolarizedFresnel(cosine, c.ior);
  const double length = kThickness / std::sqrt(1.0 - (1.0 - cosine * cosine) / (c.ior * c.ior));
  vec4 expected(0, 0, 0, 1);
  for (glm::length_t i = 0; i < 3; ++i) {
    const double a = std::pow(static_cast<double>(glass.attenuationColor[i]), length);
    expected[i] = kBehind[i] * static_cast<float>((1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a));
  }
  expectUniform(image, expected, {.error = 0.005, .rounding = 2e-4});
}

INSTANTIATE_TEST_SUITE_P(Cases, GlassSlab,
                         testing::Values(SlabCase{"ClearStraight", 0, 1.5f, 1.0f},
                                         SlabCase{"ClearTilted", 35, 1.5f, 1.0f},
                                         SlabCase{"ColoredTilted", 40, 1.5f, 0.1f},
                                         SlabCase{"DenseColored", 25, 2.4f, 0.3f}),
                         [](const auto& test) { return std::string(test.param.name); });

// A hole filled with glass leads into a medium without another boundary. Light from infinity is absorbed completely
// where the medium absorbs (red, one half per meter), for light samples and BSDF samples, and also behind a pane.
TEST(OpenMedium, AbsorbsAllLightFromInfinity) {
  constexpr float kHole = 0.01f, kTint = 0.5f, kAlbedo = 0.8f;
  scene::Material glass = clearGlass(1.0f, 1.0f), window = clearGlass(1.5f, 0.0f);
  glass.attenuationColor = {0.5f, 1.0f, 1.0f}, glass.attenuationDistance = 1.0f;
  glass.specular = window.specular = 0.0f;
  window.baseColor = vec4(vec3(kTint), 1.0f);
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = {0.6f, -0.8f, 0.0f};
  sun.intensity = vec3(2.0f);
  const auto level = [](float half, float y) { return quad({-half, y, half}, {2 * half, 0, 0}, {0, 0, -2 * half}); };
  for (const char* program : {"pathtracer", "naive"}) {
    for (const bool floor : {false, true}) {
      SCOPED_TRACE(testing::Message() << program << floor);
      const bool sunny = program == std::string("pathtracer");
      SceneBuilder scene;
      scene.add(level(kHole, 1.0f), glass).add(level(900.0f, 0.5f), window).sky(vec3(1.0f));
      if (floor) scene.add(level(900.0f, 0.0f), lambert(vec3(kAlbedo)));
      if (sunny) scene.light(sun);
      scene.camera(orthographic({0, 2, 0}, {0, 0, 0}, 0.001f));
      ImageOptions options = batches(64, 4);
      options.program = program::loadProgram(program);
      const RenderedImage image = renderImage(scene, options);
      float exact = kTint;
      if (floor) exact *= kAlbedo * kTint * (1.0f + (sunny ? sun.intensity.x * 0.8f / kPi : 0.0f));
      Moments red, green;
      for (std::uint32_t i = 0; i < 16; ++i)
        red.add(image.at(i % 4, i / 4, 0).mean()), green.add(image.at(i % 4, i / 4, 1).mean());
      EXPECT_LT(red.mean(), 0.01 * exact);  // some light comes through the hole
      EXPECT_GE(pValue(green, exact, 2e-5 * exact), 1e-3) << green.mean() << " instead of " << exact;
      EXPECT_LT(green.standardError(), 0.02 * exact) << "too noisy for this test";
    }
  }
}

// A thin wall is one interface (KHR_materials_transmission) with Schlick's reflectance.
TEST(ThinGlass, TransmitsWhatItDoesNotReflect) {
  for (const float degrees : {0.0f, 35.0f}) {
    SCOPED_TRACE(degrees);
    scene::Material glass = clearGlass(1.5f, 0.0f);
    glass.baseColor = {0.8f, 0.6f, 0.4f, 1.0f};
    const float cosine = std::cos(glm::radians(degrees));
    const float reflectance = 0.04f + 0.96f * std::pow(1.0f - cosine, 5.0f);
    const RenderedImage image =
        renderImage(lookingThrough(quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), glass, degrees), batches(32));
    // The tables for the lobe's scale have an error of about 1e-3.
    expectUniform(image, vec4(kBehind * vec3(0.8f, 0.6f, 0.4f) * (1.0f - reflectance), 1.0f),
                  {.error = 0.005, .rounding = 2e-3});
  }
}

scene::Material veil(const vec3& color, float alpha, scene::AlphaMode mode, float cutoff = 0.5f) {
  scene::Material m = unlit(color, alpha);
  m.alphaMode = mode;
  m.alphaCutoff = cutoff;
  return m;
}

const scene::Geometry kSheet = quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});

TEST(Alpha, BlendsByAlpha) {
  const SceneBuilder scene = lookingThrough(kSheet, veil({0.2f, 3.0f, 0.0f}, 0.3f, scene::AlphaMode::blend), 0.0f);
  expectUniform(renderImage(scene, batches(64)), vec4(0.3f * vec3(0.2f, 3.0f, 0.0f) + 0.7f * kBehind, 1.0f),
                {.error = 0.01});
}

TEST(Alpha, MultipliesVertexColors) {
  scene::Geometry sheet = kSheet;
  sheet.colors.assign(4, vec4(0.5f, 1.0f, 1.0f, 0.5f));
  const SceneBuilder scene = lookingThrough(sheet, veil({0.2f, 3.0f, 0.0f}, 0.6f, scene::AlphaMode::blend), 0.0f);
  expectUniform(renderImage(scene, batches(64)), vec4(0.3f * vec3(0.1f, 3.0f, 0.0f) + 0.7f * kBehind, 1.0f),
                {.error = 0.01});
}

// The alpha of each corner counts at this corner.
TEST(Alpha, InterpolatesVertexColors) {
  scene::Geometry sheet = kSheet;
  for (const float alpha : {0.8f, 0.6f, 0.2f, 0.4f}) sheet.colors.emplace_back(1.0f, 1.0f, 1.0f, alpha);
  SceneBuilder scene = lookingThrough(sheet, veil({0.2f, 3.0f, 0.0f}, 1.0f, scene::AlphaMode::blend), 0.0f);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    SCOPED_TRACE(corner);
    scene.scene.cameras.clear();
    const vec3 at = 0.9999f * sheet.positions[corner];
    scene.camera(orthographic(at + vec3(0, 0, 9), at, 0.0001f));
    const float alpha = sheet.colors[corner].a;
    expectUniform(renderImage(scene, batches(64)),
                  vec4(alpha * vec3(0.2f, 3.0f, 0.0f) + (1.0f - alpha) * kBehind, 1.0f),
                  {.error = 0.03, .rounding = 2e-3});
  }
}

// Any-hit shaders also run for opaque materials on an instance without opaque geometry. Their alpha has no effect.
TEST(Alpha, OpaqueMaterialsIgnoreIt) {
  SceneBuilder scene = lookingThrough(kSheet, veil({0.2f, 3.0f, 0.0f}, 0.4f, scene::AlphaMode::opaque), 0.0f);
  scene.scene.instances[0].flags |= scene::kInstanceForceNoOpaque;
  scene.add(quad({90, 0, 0}, {1, 0, 0}, {0, 1, 0}), veil(vec3(1.0f), 0.5f, scene::AlphaMode::blend));
  expectUniform(renderImage(scene, batches(8)), vec4(0.2f, 3.0f, 0.0f, 1.0f));
}

// The surfaces along a ray are tested independently. Here the indices of triangles and geometries are (2,0), (1,8),
// (0,16).
TEST(Alpha, TestsSurfacesOfOneMeshIndependently) {
  SceneBuilder scene = lookingThrough(kSheet, veil({0.2f, 3.0f, 0.0f}, 0.5f, scene::AlphaMode::blend), 0.0f);
  std::vector<scene::Geometry>& geometries = scene.scene.meshes[0].geometries;
  geometries.clear();
  for (std::uint32_t g = 0; g <= 16; ++g) {
    scene::Geometry& sheet = geometries.emplace_back(kSheet);
    sheet.material = 0;
    for (vec3& p : sheet.positions) p += vec3(g % 8 == 0 ? 0.0f : 100.0f, 0.0f, 0.01f * static_cast<float>(g));
    sheet.triangles.assign(3 - g / 8, {0, 0, 0});
    sheet.triangles.back() = {0, 1, 2};
  }
  scene.camera(orthographic({1, -1, 9}, {1, -1, 0}, 0.05f));
  expectUniform(renderImage(scene, batches(64)), vec4(0.875f * vec3(0.2f, 3.0f, 0.0f) + 0.125f * kBehind, 1.0f),
                {.error = 0.03});
}

// The left texel is opaque, the right one is clear. One set of coordinates selects the left one, the other set the right one.
TEST(Alpha, ReadsItsTextureAtTheSetOfCoordinates) {
  for (const scene::AlphaMode mode : {scene::AlphaMode::mask, scene::AlphaMode::blend}) {
    for (const int uvSet : {0, 1}) {
      SCOPED_TRACE(testing::Message() << (mode == scene::AlphaMode::mask ? "mask" : "blend") << ", set " << uvSet);
      scene::Geometry sheet = kSheet;
      sheet.uvs[0].assign(4, vec2(0.25f, 0.5f));
      sheet.uvs[1].assign(4, vec2(0.75f, 0.5f));
      SceneBuilder scene = lookingThrough(sheet, veil({0.2f, 3.0f, 0.0f}, 1.0f, mode), 0.0f);
      scene::TextureUse& texture = scene.scene.materials[0].baseColorTexture;
      texture.texture = addTexel(scene.scene, {255, 255, 255, 255, 255, 255, 255, 0});
      texture.uvSet = uvSet;
      expectUniform(renderImage(scene, batches(2, 4)), vec4(uvSet == 0 ? vec3(0.2f, 3.0f, 0.0f) : kBehind, 1.0f),
                    {.error = 1e-4});
    }
  }
}

TEST(Alpha, MasksBelowTheCutoff) {
  for (const float cutoff : {0.2f, 0.5f}) {
    const SceneBuilder scene =
        lookingThrough(kSheet, veil({0.2f, 3.0f, 0.0f}, 0.3f, scene::AlphaMode::mask, cutoff), 0.0f);
    expectUniform(renderImage(scene, batches(4)), vec4(cutoff < 0.3f ? vec3(0.2f, 3.0f, 0.0f) : kBehind, 1.0f),
                  {.error = 1e-4});
  }
}

// A floor in the shadow of two blended surfaces, seen from below them.
TEST(Alpha, AttenuatesShadowRays) {
  SceneBuilder scene;
  scene.add(quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}), lambert(vec3(0.6f)));
  scene.add(quad({-9, 2, 9}, {18, 0, 0}, {0, 0, -18}), veil(vec3(0.0f), 0.3f, scene::AlphaMode::blend));
  scene.add(quad({-9, 3, 9}, {18, 0, 0}, {0, 0, -18}), veil(vec3(0.0f), 0.5f, scene::AlphaMode::blend));
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = {0.6f, -0.8f, 0.0f};
  sun.intensity = vec3(2.0f);
  scene.light(sun).camera(orthographic({0, 1, 0}, vec3(0.0f), 0.1f));
  expectUniform(renderImage(scene, batches(64)), vec4(vec3(0.6f / kPi * 2.0f * 0.8f * 0.7f * 0.5f), 1.0f),
                {.error = 0.02});
}

// With `transparent` the background has alpha 0, and colors are premultiplied.
TEST(Transparent, WritesCoverageAsAlpha) {
  ImageOptions options = batches(64);
  options.transparent = true;
  SceneBuilder scene;
  scene.add(kSheet, veil({0.2f, 3.0f, 0.0f}, 0.3f, scene::AlphaMode::blend)).sky(vec3(7.0f));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  expectUniform(renderImage(scene, options), vec4(0.06f, 0.9f, 0.0f, 0.3f), {.error = 0.02});
}

// The edge x = 0 goes through the center of column 1 of 3, and between columns 1 and 2 of 4. There the tent of radius
// 0.75 pixels extends a quarter of a pixel beyond the edge, with a weight of (1/3)²/2.
TEST(Transparent, CoversEdgePixelsPartially) {
  SceneBuilder scene;
  scene.add(quad({-3, -3, 0}, {3, 0, 0}, {0, 6, 0}), unlit(vec3(2.0f))).sky(vec3(7.0f));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  for (const std::vector<double>& coverage : {std::vector<double>{1, 0.5, 0}, {1, 17.0 / 18.0, 1.0 / 18.0, 0}}) {
    ImageOptions options = batches(64, static_cast<std::uint32_t>(coverage.size()));
    options.transparent = true;
    const RenderedImage image = renderImage(scene, options);
    for (std::uint32_t y = 0; y < options.height; ++y) {
      for (std::uint32_t x = 0; x < options.width; ++x) {
        EXPECT_NEAR(image.at(x, y, 3).mean(), coverage[x], 0.02);
        EXPECT_NEAR(image.at(x, y, 0).mean(), 2.0 * image.at(x, y, 3).mean(), 1e-5);
      }
    }
  }
}

TEST(Transparent, IsOpaqueByDefault) {
  SceneBuilder scene;
  scene.add(quad({-3, -3, 0}, {1, 0, 0}, {0, 1, 0}), unlit(vec3(2.0f))).sky({7.0f, 1.0f, 0.5f});
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  expectUniform(renderImage(scene, batches(4)), vec4(7.0f, 1.0f, 0.5f, 1.0f), {.error = 1e-4});
}

// Unlit and emissive surfaces show their own color under any light, from both sides.
TEST(Unlit, ShowsItsBaseColor) {
  scene::Light sun;
  sun.type = scene::LightType::directional;
  const std::array materials = {unlit({0.25f, 0.5f, 0.75f}), emitter({25.0f, 50.0f, 75.0f})};
  for (const float z : {9.0f, -9.0f}) {
    for (const scene::Material& m : materials) {
      SceneBuilder scene;
      scene.scene.materials.assign(materials.begin(), materials.end());  // one set of shaders for both
      scene.add(kSheet, m).light(sun).sky(vec3(100.0f)).camera(orthographic({0, 0, z}, vec3(0.0f), 0.05f));
      const vec3 color = m.unlit ? vec3(m.baseColor) : m.emissive;
      expectUniform(renderImage(scene, batches(2, 4)), vec4(color, 1.0f), {.error = 1e-5, .rounding = 1e-6});
    }
  }
}

}  // namespace
}  // namespace quintet::test
