// SPDX-License-Identifier: Apache-2.0
// Alpha masks at the limits of their cutoff: an alpha equal to the cutoff is visible, and above a cutoff of 1 nothing is (glTF 2.0
// section 5.19.12). For rays, shadow rays and the sampling of lights, on triangles, solids and CSG trees.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "harness.h"
#include "pane_scenes.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

struct Mask {
  float alpha, cutoff;
  bool visible;
  float vertexAlpha = 1.0f;
};

const std::vector<Mask> kMasks{{0.5f, 0.5f, true},           {0.5f, 0.50000006f, false},   {1.0f, 1.0f, true},
                               {1.0f, 1.0000001f, false},    {1.0f, 1.01f, false},         {1.0f, 1e30f, false},
                               {0.0f, 0.0f, true},           {1.0f, 0.2499f, true, 0.25f}, {0.5f, 0.1249f, true, 0.25f},
                               {1.0f, 0.2501f, false, 0.25f}};
// Of these only: nothing else in the scene has an alpha below 1.
const std::vector<Mask> kOpaqueAlpha{{1.0f, 1.0f, true}, {1.0f, 1.01f, false}, {1.0f, 2.0f, false}};

enum class Kind { triangles, solids, trees };

scene::Material withMask(scene::Material material, const Mask& mask) {
  material.alphaMode = scene::AlphaMode::mask;
  material.alphaCutoff = mask.cutoff;
  material.baseColor.a = mask.alpha;
  return material;
}

// A square or ball of 1 m at this height over the origin.
void addShield(SceneBuilder& scene, Kind kind, const scene::Material& material, float x, float vertexAlpha) {
  if (kind != Kind::triangles) return addBubble(scene, material, {x, 0, 2}, 0.5f, kind == Kind::trees);
  scene::Geometry square = quad({x - 0.5f, -0.5f, 2}, {1, 0, 0}, {0, 1, 0});
  if (vertexAlpha < 1.0f) square.colors.assign(square.positions.size(), vec4(1, 1, 1, vertexAlpha));
  scene.add(square, material);
}

// A program's views of a scene, with one renderer, since drivers compile each one's pipeline.
class Views {
 public:
  Views(render::DeviceScene& device, const std::string& program)
      : options_(optionsFor(program)),
        renderer_(makeRenderer(device, options_.program, settingsFor(cameraAt({0, 0, 1}), options_))) {}

  // The mean of all pixels, which see the same square millimeter of the surface below.
  vec3 colorSeen(const vec3& from, int batches = 1) {
    renderer_.setCamera(cameraAt(from));
    for (int i = 0; i < batches; ++i) renderer_.renderBatch();
    const io::Image image = renderer_.image();
    glm::dvec3 sum(0.0);
    for (std::uint32_t y = 0; y < kSize; ++y)
      for (std::uint32_t x = 0; x < kSize; ++x) {
        const auto pixel = image.pixel<float>(x, y);
        sum += glm::dvec3(pixel[0], pixel[1], pixel[2]);
      }
    return vec3(sum / double{kSize * kSize});
  }

 private:
  static constexpr std::uint32_t kSize = 16;
  static scene::Camera cameraAt(const vec3& from) { return orthographic(from, {from.x, from.y, 0}, 0.001f); }
  static ImageOptions optionsFor(const std::string& program) {
    ImageOptions options;
    options.program = program::loadProgram(program);
    options.width = options.height = kSize;
    if (program == "pathtracer") options.set = {"bounces=1"};
    return options;
  }
  ImageOptions options_;
  render::Renderer renderer_;
};

vec3 colorSeen(render::DeviceScene& device, const std::string& program, const vec3& from) {
  return Views(device, program).colorSeen(from);
}

constexpr float kDistance = 8.0f;  // between shields, above a white floor

// Each shield is blue and black, and a red lamp shines from above. So the view from above is blue where a shield is visible, and the
// floor below is red where it is not.
void expectMasks(const std::vector<Mask>& masks, Kind kind) {
  SceneBuilder scene;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (kind != Kind::triangles && masks[i].vertexAlpha < 1.0f) continue;
    addShield(scene, kind, withMask(emitter({0, 0, 0.5f}), masks[i]), kDistance * static_cast<float>(i),
              masks[i].vertexAlpha);
  }
  scene.add(quad({-50, -50, 0}, {200, 0, 0}, {0, 100, 0}), lambert(vec3(1.0f)));
  scene::Light lamp;
  lamp.type = scene::LightType::directional;
  lamp.intensity = vec3(kPi, 0, 0);
  scene.light(lamp);
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  Views pathTracer(device, "pathtracer");
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (kind != Kind::triangles && masks[i].vertexAlpha < 1.0f) continue;
    SCOPED_TRACE(testing::Message() << "alpha " << masks[i].alpha << " · " << masks[i].vertexAlpha << ", cutoff "
                                    << masks[i].cutoff);
    const float x = kDistance * static_cast<float>(i);
    // Light sampling selects one of the shields instead of the lamp for 2 of 100 samples. The standard deviation of the mean of
    // 2,048 samples is 0.003.
    const vec3 above = pathTracer.colorSeen({x, 0, 4}, 2);
    const vec3 below = pathTracer.colorSeen({x, 0, 1}, 2);
    const float red = masks[i].visible ? 0.0f : 1.0f, tolerance = masks[i].visible ? 1e-4f : 0.02f;
    EXPECT_NEAR(above.x, red, tolerance);
    EXPECT_NEAR(below.x, red, tolerance);
    if (masks[i].visible) {
      EXPECT_EQ(above.z, 0.5f);
      const float least = kind == Kind::trees ? -1.0f : 0.01f;  // trees are found by chance
      EXPECT_GT(below.z, least);
    } else {
      EXPECT_LT(above.z, 0.02f) << "only the light of others";
      EXPECT_LT(below.z, 0.02f);
    }
  }
  Views naive(device, "naive");
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (kind != Kind::triangles && masks[i].vertexAlpha < 1.0f) continue;
    const bool seen = naive.colorSeen({kDistance * static_cast<float>(i), 0, 4}).z > 0.4f;
    EXPECT_EQ(seen, masks[i].visible) << "naive: alpha " << masks[i].alpha << ", cutoff " << masks[i].cutoff;
  }
}

TEST(AlphaMask, CutsTriangles) {
  expectMasks(kMasks, Kind::triangles);
  expectMasks(kOpaqueAlpha, Kind::triangles);
}

TEST(AlphaMask, CutsSolids) {
  for (const Kind kind : {Kind::solids, Kind::trees}) {
    expectMasks(kMasks, kind);
    expectMasks(kOpaqueAlpha, kind);
  }
}

// The only light: a square of 1 m, 1 m above a white floor. Light sampling brings most of its light.
TEST(AlphaMask, EqualToTheCutoffGivesItsWholeLight) {
  SceneBuilder scene;
  addShield(scene, Kind::triangles, withMask(emitter({0, 0, 0.5f}), {0.5f, 0.5f, true}), 0, 1.0f);
  scene.add(quad({-50, -50, 1}, {100, 0, 0}, {0, 100, 0}), lambert(vec3(1.0f)));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  // The form factor of a rectangle with half sides a = b = 0.5 at the distance 1: 4/π · a/√(1+a²) · atan(b/√(1+a²)).
  const double root = std::sqrt(1.25), exact = 0.5 * 4.0 / glm::pi<double>() * 0.5 / root * std::atan(0.5 / root);
  EXPECT_NEAR(Views(device, "pathtracer").colorSeen({0, 0, 1.5f}, 4).z, exact, 0.04 * exact);
}

// Invisible emitters: no light, also not by light sampling, and none in the table of lights. A visible lamp keeps all samples.
TEST(AlphaMask, InvisibleEmittersAreNoLights) {
  SceneBuilder scene;
  addShield(scene, Kind::triangles, withMask(emitter(vec3(100.0f)), {1.0f, 1.5f, false}), 0, 1.0f);
  addShield(scene, Kind::solids, withMask(emitter(vec3(100.0f)), {0.5f, 0.75f, false}), 0, 1.0f);
  scene::Material clear = emitter(vec3(100.0f));
  clear.alphaMode = scene::AlphaMode::blend;
  clear.baseColor.a = 0.0f;
  addShield(scene, Kind::triangles, clear, 1.0f, 1.0f);
  scene.add(quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), lambert(vec3(1.0f)));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  EXPECT_EQ(device.statistics().lightCount, 0u);
  for (const float z : {1.0f, 4.0f}) EXPECT_EQ(colorSeen(device, "pathtracer", {0.2f, 0, z}), vec3(0.0f));
  // Rays meet all of an instance that is forced to be opaque.
  scene.scene.instances[0].flags = scene::kInstanceForceOpaque;
  render::DeviceScene opaque(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  EXPECT_EQ(colorSeen(opaque, "pathtracer", {0.2f, 0, 4}), vec3(100.0f));
}

// Other programs: ambient occlusion, and the color of the surface.
TEST(AlphaMask, IsKnownToOtherPrograms) {
  SceneBuilder scene;
  addShield(scene, Kind::triangles, withMask(lambert(vec3(0.5f)), {1.0f, 1.01f, false}), 0, 1.0f);
  scene.add(quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), lambert(vec3(1.0f)));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  EXPECT_EQ(colorSeen(device, "ao", {0, 0, 4}), colorSeen(device, "ao", {40, 0, 4}));
}

// A camera in a solid whose surface is missing is in no medium.
TEST(AlphaMask, InvisibleSolidsAreNoMedia) {
  SceneBuilder scene;
  scene::Material glass = clearGlass(1.0f, 1.0f);
  glass.attenuationColor = vec3(0.5f);
  glass.attenuationDistance = 1.0f;
  scene.add(box({-1, -1, 1}, {1, 1, 3}), withMask(glass, {1.0f, 1.01f, false}));
  scene.sky(vec3(1.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  for (const float z : {2.0f, 9.0f}) EXPECT_EQ(colorSeen(device, "pathtracer", {0, 0, z}), vec3(1.0f)) << z;
  glass.alphaMode = scene::AlphaMode::opaque;
  scene.scene.materials[0] = glass;
  render::DeviceScene filled(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  EXPECT_NEAR(colorSeen(filled, "pathtracer", {0, 0, 2}).x, 0.5f, 1e-4f);
}

}  // namespace
}  // namespace quintet::test
