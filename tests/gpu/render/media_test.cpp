// SPDX-License-Identifier: Apache-2.0
// Solids inside of solids, and cameras inside of solids, against closed forms. Which solids are around the camera:
// camera_media_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "harness.h"
#include "lights/light_scene.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

const vec3 kWall(1.0f, 0.5f, 2.0f);

scene::Material medium(float ior, const vec3& transmittanceOfAMeter, float priority) {
  scene::Material m = clearGlass(ior, 1.0f);
  m.attenuationColor = transmittanceOfAMeter;
  m.attenuationDistance = 1.0f;
  m.dielectricPriority = priority;
  return m;
}

// Reflectance between two indices for unpolarized light; `sine` is n sin θ, the same in all layers.
double interfaceReflectance(double n1, double n2, double sine) {
  const double c1 = std::sqrt(1.0 - sine * sine / (n1 * n1)), c2 = std::sqrt(1.0 - sine * sine / (n2 * n2));
  const double s = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), p = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
  return 0.5 * (s * s + p * p);
}

struct Layer {
  double ior, thickness;
  vec3 transmittanceOfAMeter;
};

// Light that passes layers in air, over all reflections between their surfaces. The layers are added from the back:
// T = (1-r) a T' / (1 - r a² R') and R = r + (1-r)² a² R' / (1 - r a² R') for a surface r in front of a layer with
// transmittance a, in front of the rest.
vec3 passed(const std::vector<Layer>& layers, double sine) {
  vec3 result;
  for (glm::length_t channel = 0; channel < 3; ++channel) {
    double r = interfaceReflectance(layers.back().ior, 1.0, sine), t = 1.0 - r;
    for (std::size_t i = layers.size(); i-- > 0;) {
      const Layer& layer = layers[i];
      const double cosine = std::sqrt(1.0 - sine * sine / (layer.ior * layer.ior));
      const double a = std::pow(static_cast<double>(layer.transmittanceOfAMeter[channel]), layer.thickness / cosine);
      const double front = interfaceReflectance(i == 0 ? 1.0 : layers[i - 1].ior, layer.ior, sine);
      const double multiple = 1.0 / (1.0 - front * a * a * r);
      t *= (1.0 - front) * a * multiple;
      r = front + (1.0 - front) * (1.0 - front) * a * a * r * multiple;
    }
    result[channel] = static_cast<float>(t);
  }
  return result;
}

// Slabs along z, turned about y, in front of an emissive wall, as in transmission_test.cpp.
struct Slab {
  float back, front;  // z
  scene::Material material;
};
SceneBuilder throughSlabs(const std::vector<Slab>& slabs, float degrees) {
  SceneBuilder scene;
  const mat4 turned = glm::rotate(mat4(1.0f), glm::radians(degrees), vec3(0, 1, 0));
  for (const Slab& slab : slabs) scene.add(box({-3, -3, slab.back}, {3, 3, slab.front}), slab.material, turned);
  scene.add(quad({-50, -50, -4}, {100, 0, 0}, {0, 100, 0}), emitter(kWall));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  return scene;
}

ImageOptions nestedOptions(const char* program, std::uint32_t batches = 64) {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.batches = batches;
  options.set = {"bounces=40"};
  return options;
}

// A glass wall and a liquid that reaches into it. The one with the higher priority fills the common space.
TEST(NestedMedia, ThePriorityDecidesWhatFillsTheCommonSpace) {
  const vec3 wall(0.9f, 0.5f, 0.7f), liquid(0.3f, 0.8f, 0.6f);
  constexpr float kDegrees = 30.0f;
  const double sine = std::sin(glm::radians(static_cast<double>(kDegrees)));
  for (const char* program : {"pathtracer", "naive"}) {
    for (const float priority : {1.0f, -2.0f}) {
      SCOPED_TRACE(testing::Message() << program << priority);
      const float common = priority > 0.0f ? 0.2f : 0.4f;  // z at which the glass ends
      const SceneBuilder scene = throughSlabs(
          {{0.2f, 0.6f, medium(1.5f, wall, priority)}, {-0.5f, 0.4f, medium(1.33f, liquid, 0.0f)}}, kDegrees);
      const vec3 exact = passed({{1.5, 0.6 - double{common}, wall}, {1.33, double{common} + 0.5, liquid}}, sine);
      expectUniform(renderImage(scene, nestedOptions(program)), vec4(kWall * exact, 1.0f),
                    {.error = 0.005, .rounding = 3e-4});
    }
  }
}

// A solid inside of a larger one: each surface has the relative index. The order of entering decides among equal
// priorities. The third slab gives the scene a priority and is not in view.
TEST(NestedMedia, SolidsInSolidsHaveTheRelativeIndex) {
  const vec3 outer(0.8f, 0.6f, 0.9f), inner(0.5f, 1.0f, 0.2f);
  for (const float degrees : {0.0f, 35.0f}) {
    for (const float ior : {1.5f, 2.2f, 1.2f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << degrees << " degrees, ior " << ior);
      SceneBuilder scene =
          throughSlabs({{-0.8f, 0.8f, medium(1.5f, outer, 0.0f)}, {-0.3f, 0.1f, medium(ior, inner, 0.0f)}}, degrees);
      scene.add(box({20, 20, 20}, {21, 21, 21}), medium(1.5f, vec3(1.0f), 1.0f));
      const double sine = std::sin(glm::radians(static_cast<double>(degrees)));
      const vec3 exact = passed({{1.5, 0.7, outer}, {double{ior}, 0.4, inner}, {1.5, 0.5, outer}}, sine);
      expectUniform(renderImage(scene, nestedOptions("pathtracer")), vec4(kWall * exact, 1.0f),
                    {.error = 0.005, .rounding = 3e-4});
    }
  }
}

// A path that meets the back of a surface of a solid that it has not entered leaves the solid that fills the space. In air it
// stays in air.
TEST(NestedMedia, TheBackOfAnUnknownSolidEndsTheSolidAround) {
  const vec3 outer(0.8f, 0.6f, 0.9f);
  for (const bool around : {true, false}) {
    SceneBuilder scene =
        throughSlabs(around ? std::vector<Slab>{{-0.8f, 0.8f, medium(1.0f, outer, 0.0f)}} : std::vector<Slab>{}, 0.0f);
    scene.add(quad({-3, -3, 0.1f}, {0, 6, 0}, {6, 0, 0}), medium(1.0f, vec3(0.3f), 1.0f));  // faces -z
    const vec3 exact = around ? glm::pow(outer, vec3(0.7f)) : vec3(1.0f);
    for (const char* program : {"pathtracer", "naive"}) {
      SCOPED_TRACE(testing::Message() << program << around);
      expectUniform(renderImage(scene, nestedOptions(program)), vec4(kWall * exact, 1.0f),
                    {.error = 0.005, .rounding = 3e-4});
    }
  }
}

// Two solids of one material that overlap are one solid: the surfaces inside do not exist.
TEST(NestedMedia, OverlappingSolidsOfOneMaterialAreOne) {
  const vec3 color(0.3f, 0.6f, 0.9f);
  SceneBuilder scene = throughSlabs({{-0.5f, 0.2f, medium(1.7f, color, 1.0f)}}, 25.0f);
  scene.scene.instances.push_back(scene.scene.instances[0]);
  scene.scene.instances.back().worldFromObject *= glm::translate(mat4(1.0f), vec3(0, 0, 0.4f));
  const vec3 exact = passed({{1.7, 1.1, color}}, std::sin(glm::radians(25.0)));
  expectUniform(renderImage(scene, nestedOptions("pathtracer")), vec4(kWall * exact, 1.0f),
                {.error = 0.005, .rounding = 3e-4});
}

// Balls of glass, of liquid, of a bubble (ior 1 with the highest priority) and of rough glass, which overlap, do not change a
// white sky. The camera is outside, in the liquid, in the bubble and in the common space.
TEST(NestedMedia, ClearSolidsAreInvisibleInAFurnace) {
  SceneBuilder scene;
  scene.add(sphere({0, 0, 0}, 1.0f, 3), medium(1.33f, vec3(1.0f), 0.0f))
      .add(sphere({0.7f, 0, 0}, 0.6f, 3), medium(1.6f, vec3(1.0f), 1.0f))
      .add(sphere({-0.5f, 0.3f, 0}, 0.4f, 3), medium(1.0f, vec3(1.0f), 2.0f))
      .add(sphere({0.4f, -0.2f, 0.3f}, 0.5f, 3), medium(1.5f, vec3(1.0f), -1.0f));
  scene.sky(vec3(1.0f));
  for (const char* program : {"pathtracer", "naive"}) {
    for (const vec3& eye : {vec3(0, 0, 3), vec3(0, -0.6f, 0.3f), vec3(-0.5f, 0.3f, 0), vec3(0.4f, 0, 0.1f)}) {
      SCOPED_TRACE(testing::Message() << program << " from " << eye.x << ' ' << eye.y << ' ' << eye.z);
      scene.camera(perspective(eye, eye + vec3(0.1f, 0.05f, -1.0f), 30.0f));
      ImageOptions options = nestedOptions(program, 16);
      options.set = {"bounces=200"};
      expectUniform(renderImage(scene, options), vec4(1.0f), {.error = 0.02, .rounding = 2e-3});
    }
  }
}

// The set of solids, and the index of a material relative to the solid outside, which can have dispersion.
TEST(NestedMedia, SetsOfSolidsAndIndicesFollowTheRules) {
  SceneBuilder builder;
  scene::Material dispersive = clearGlass(1.5f, 1.0f);
  dispersive.dispersion = 1.0f;
  builder.add(box(vec3(-1.0f), vec3(1.0f)), dispersive).add(box(vec3(-2.0f), vec3(2.0f)), clearGlass(1.25f, 1.0f));
  const LightScene device(builder.scene, {});
  const std::string prelude = "#include <quintet/media.glsl>\n";
  const std::vector<std::uint32_t> media{1, 2, 3, 4, 5};
  const auto left = runCompute<uvec4>(prelude + R"(
    #define In uint
    #define Out uvec4
    Out run(uint index, In medium) { return medium == 5u ? mediaEntered(uvec4(1u, 2u, 3u, 4u), 5u) : mediaLeft(uvec4(1u, 2u, 3u, 4u), medium); }
  )",
                                      media, media.size(), device.options());
  EXPECT_EQ(left[0], uvec4(2, 3, 4, 0));
  EXPECT_EQ(left[1], uvec4(1, 3, 4, 0));
  EXPECT_EQ(left[2], uvec4(1, 2, 4, 0));
  EXPECT_EQ(left[3], uvec4(1, 2, 3, 0));
  EXPECT_EQ(left[4], uvec4(5, 1, 2, 3));

  struct Query {
    std::uint32_t outside;  // 1: with dispersion, 2: without
    float transmission, dispersion;
    std::uint32_t thin = 0;
    std::uint32_t only = 0;  // the path has only this channel left
  };
  struct Answer {
    float ior, dispersion;
    vec3 transmitted;
  };
  const std::vector<Query> queries{{1, 1, 0},      {1, 0, 0},    {2, 1, 0},    {1, 1, 0.5f}, {0, 1, 0},
                                   {1, 1, 0, 1},   {1, 0, 0, 1}, {2, 0, 0, 1},  // only panes keep their index
                                   {1, 1, 0, 0, 1}};
  const auto answers = runCompute<Answer>(prelude + R"(
    struct Query { uint outside; float transmission; float dispersion; uint thin; uint only; };
    struct Answer { float ior; float dispersion; vec3 transmitted; };
    #define In Query
    #define Out Answer
    Out run(uint index, In q) {
      BsdfParameters p = BsdfParameters(vec3(0.8), 0.0, 0.1, q.transmission, 1.8, true, q.thin != 0u, 1.0, vec3(1.0), 0.0, 0.01,
                                        vec3(0.0, 0.0, 1.0), vec3(0.0), 0.25, 0.0, vec3(0.5), 0.0, 0.0, 1.3, 400.0,
                                        q.dispersion, vec3(1.0));
      setOutside(p, q.outside, q.only != 0u ? 2u | kChannelOnly : 2u);
      return Answer(p.ior, p.dispersion, p.transmitted);
    }
  )",
                                          queries, queries.size(), device.options());
  const float ofDispersive = 1.5f + 0.025f * 0.5f;  // of channel 2
  const float iors[] = {1.8f / ofDispersive, 1.8f / ofDispersive, 1.8f / 1.25f,       1.8f / ofDispersive, 1.8f, 1.8f,
                        1.8f / ofDispersive, 1.8f / 1.25f,        1.8f / ofDispersive};
  const float dispersions[] = {1, 0, 0, 0.5f, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < queries.size(); ++i) {
    EXPECT_NEAR(answers[i].ior, iors[i], 1e-6f) << i;
    EXPECT_EQ(answers[i].dispersion, dispersions[i]) << i;
    EXPECT_EQ(answers[i].transmitted, i == 0 ? vec3(0, 0, 3) : vec3(1.0f))
        << i << ": disperse() chooses the channel of others";
  }
}

// The highest priority fills the space, wherever it is in the set. Of equal ones, the solid that was entered last does.
TEST(NestedMedia, TheHighestPriorityOfASetFillsTheSpace) {
  SceneBuilder builder;
  for (const float priority : {0.0f, 1.0f, 2.0f, 2.0f, -1.0f})
    builder.add(box(vec3(-1.0f), vec3(1.0f)), medium(1.5f, vec3(1.0f), priority));
  const LightScene device(builder.scene, {});
  struct MediaSet {
    uvec4 media;
    std::uint32_t filling;
  };
  const std::vector<MediaSet> sets{{{3, 1, 2, 5}, 3}, {{1, 3, 2, 5}, 3}, {{1, 2, 3, 5}, 3}, {{1, 2, 5, 3}, 3},
                                   {{3, 4, 1, 2}, 3}, {{1, 4, 5, 3}, 4}, {{2, 1, 3, 4}, 3}, {{5, 1, 0, 0}, 1},
                                   {{1, 5, 0, 0}, 1}, {{5, 0, 0, 0}, 5}, {{0, 0, 0, 0}, 0}};
  const auto filling = runCompute<std::uint32_t>(R"(
    #include <quintet/media.glsl>
    struct MediaSet { uvec4 media; uint filling; };
    #define In MediaSet
    #define Out uint
    Out run(uint index, In value) { return fillingMedium(value.media); }
  )",
                                                 sets, sets.size(), device.options());
  for (std::size_t i = 0; i < sets.size(); ++i) EXPECT_EQ(filling[i], sets[i].filling) << i;
}

// In a slab of index n with transmittance a, at the distance d from its back: L = a^d (1-R) / (1 - R² a²), with the
// reflections between both sides. The radiance in the slab is n² L; the camera measures L.
TEST(CameraInMedium, SeesTheAbsorptionFromTheStart) {
  const vec3 color(0.2f, 0.6f, 0.9f);
  for (const char* program : {"pathtracer", "naive"}) {
    for (const float priority : {0.0f, 1.0f}) {  // without and with nested media
      for (const float ior : {1.0f, 1.5f}) {
        SCOPED_TRACE(testing::Message() << program << priority << ior);
        SceneBuilder scene = throughSlabs({{-1.0f, 1.0f, medium(ior, color, priority)}}, 0.0f);
        scene.camera(orthographic({0, 0, 0.3f}, {0, 0, -1}, 0.05f));
        const double r = interfaceReflectance(1.0, double{ior}, 0.0);
        vec4 exact(0, 0, 0, 1);
        for (glm::length_t c = 0; c < 3; ++c) {
          const double a = static_cast<double>(color[c]);
          exact[c] = kWall[c] * static_cast<float>(std::pow(a, 1.3) * (1.0 - r) / (1.0 - r * r * std::pow(a, 4.0)));
        }
        // In 512 samples, each pixel has paths that the surface reflects.
        expectUniform(renderImage(scene, nestedOptions(program, ior > 1.0f ? 128 : 4)), exact,
                      {.error = 0.005, .rounding = 3e-4});
      }
    }
  }
}

// A camera in a liquid with a glass slab: the relative index counts from the first surface on.
TEST(CameraInMedium, KnowsTheIndexAtTheFirstSurface) {
  const vec3 liquid(0.7f, 0.4f, 0.9f);
  SceneBuilder scene =
      throughSlabs({{-0.6f, 2.0f, medium(1.5f, liquid, 0.0f)}, {-0.2f, 0.2f, medium(1.5f, vec3(1.0f), 1.0f)}}, 0.0f);
  scene.camera(orthographic({0, 0, 0.5f}, {0, 0, -1}, 0.05f));
  const double r = interfaceReflectance(1.0, 1.5, 0.0);
  vec4 exact(0, 0, 0, 1);
  for (glm::length_t c = 0; c < 3; ++c) {
    const double a = static_cast<double>(liquid[c]);
    // 0.3 m and 0.4 m of liquid on the way to the back, and 2.2 m between its sides.
    exact[c] = kWall[c] * static_cast<float>(std::pow(a, 0.7) * (1.0 - r) / (1.0 - r * r * std::pow(a, 4.4)));
  }
  expectUniform(renderImage(scene, nestedOptions("pathtracer")), exact, {.error = 0.005, .rounding = 3e-4});
}

// The medium changes with the camera, and with a moving solid.
TEST(CameraInMedium, FollowsTheCameraAndTheScene) {
  SceneBuilder scene = throughSlabs({{-1.0f, 1.0f, medium(1.0f, vec3(0.25f), 0.0f)}}, 0.0f);
  scene.scene.instances[0].keyframes = {{.frame = 0.0f}, {.frame = 1.0f, .translation = {0, 0, -2}}};
  scene.scene.instances[0].worldFromObject = mat4(1.0f);
  const scene::Camera outside = orthographic({0, 0, 1.5f}, {0, 0, -1}, 0.05f);
  const scene::Camera inside = orthographic({0, 0, 0.0f}, {0, 0, -1}, 0.05f);
  const SceneBuilder built = scene.camera(outside);
  render::DeviceScene device(testContext(), scene::Scene(built.scene), built.environment);
  const ImageOptions options = nestedOptions("pathtracer", 4);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(outside, options));
  const auto green = [&] {
    renderer.renderBatch();
    return renderer.image().pixel<float>(4, 4)[1] / kWall.y;
  };
  EXPECT_NEAR(green(), 0.0625f, 1e-4f);
  renderer.setCamera(inside);
  EXPECT_NEAR(green(), 0.25f, 1e-4f);
  device.setFrame(1.0);
  renderer.restart();
  EXPECT_NEAR(green(), 0.0625f, 1e-4f);
}

}  // namespace
}  // namespace quintet::test
