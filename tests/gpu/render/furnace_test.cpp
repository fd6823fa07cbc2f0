// SPDX-License-Identifier: Apache-2.0
// Lambert surfaces under uniform light, whose radiance is known in closed form.
#include <gtest/gtest.h>

#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

const vec3 kFurnaceAlbedo(0.8f, 0.5f, 0.2f);

ImageOptions with(const std::string& program, std::vector<std::string> set = {}) {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.set = std::move(set);
  return options;
}

// A sphere of this size whose center fills the image.
SceneBuilder furnace(float size, const vec3& center, const mat4& worldFromObject = mat4(1.0f)) {
  SceneBuilder scene;
  const vec3 middle = worldFromObject * vec4(center, 1.0f);
  scene.add(sphere(center, size, 3), lambert(kFurnaceAlbedo), worldFromObject).sky(vec3(1.0f));
  scene.camera(orthographic(middle + vec3(0.3f, 0.2f, 1.0f) * 2.0f * size, middle, 0.55f * size));
  return scene;
}

TEST(Furnace, ShowsTheAlbedoOfASphere) {
  expectUniform(renderImage(furnace(1.0f, vec3(0.0f))), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.003});
}

TEST(Furnace, AgreesWithNaive) {
  expectUniform(renderImage(furnace(1.0f, vec3(0.0f)), with("naive")), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.003});
}

// A ray that hits the surface it starts from would give albedo² instead of albedo.
TEST(Furnace, HasNoAcneAtAnyScale) {
  ImageOptions options;
  options.batches = 8;
  for (const float size : {1e-3f, 1e-1f, 10.0f, 1e3f, 1e5f}) {
    SCOPED_TRACE(size);
    expectUniform(renderImage(furnace(size, vec3(0.0f)), options), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.005});
  }
}

TEST(Furnace, HasNoAcneFarFromTheOrigin) {
  ImageOptions options;
  options.batches = 8;
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    SCOPED_TRACE(size);
    const vec3 far = vec3(700.0f, -500.0f, 510.0f) * size;  // 1000 times the size of the sphere
    expectUniform(renderImage(furnace(size, far), options), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.005});
    const mat4 moved = glm::translate(mat4(1.0f), far);
    expectUniform(renderImage(furnace(size, vec3(0.0f), moved), options), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.005});
  }
}

TEST(Furnace, HasNoAcneUnderNonuniformAndMirroredScale) {
  const mat4 turned = glm::rotate(mat4(1.0f), 0.7f, glm::normalize(vec3(1, 2, 3)));
  for (const vec3 scale : {vec3(1.0f, 0.02f, 1.0f), vec3(-1.0f, 1.0f, 1.0f)}) {
    SceneBuilder scene;
    scene
        .add(sphere(vec3(0.0f), 1.0f, 3), lambert(kFurnaceAlbedo),
             turned * glm::scale(mat4(1.0f), scale) * glm::inverse(turned))
        .sky(vec3(1.0f));
    const vec3 side = turned * vec4(0, 1, 0, 0);  // from here the flat ellipsoid fills the image, too
    scene.camera(orthographic(4.0f * side, vec3(0.0f), 0.4f));
    ImageOptions options;
    options.batches = 8;
    expectUniform(renderImage(scene, options), vec4(kFurnaceAlbedo, 1.0f), {.error = 0.005});
  }
}

// The radiance inside a closed surface that emits L everywhere is L · (1 + a + a² + … + a^bounces).
SceneBuilder inside(const scene::Geometry& geometry, float size) {
  scene::Material m = lambert(kFurnaceAlbedo);
  m.emissive = {0.5f, 1.0f, 2.0f};
  SceneBuilder scene;
  scene.add(geometry, m);
  scene.camera(perspective(vec3(0.1f, -0.2f, 0.05f) * size, vec3(1, 1, 1) * size, 90.0f));
  return scene;
}

vec4 series(int bounces) {
  vec3 sum(0.0f), power(0.5f, 1.0f, 2.0f);
  for (int i = 0; i <= bounces; ++i) sum += power, power *= kFurnaceAlbedo;
  return vec4(sum, 1.0f);
}

TEST(AlbedoSeries, MatchesInsideASphere) {
  for (const int bounces : {0, 1, 3, 12}) {
    SCOPED_TRACE(bounces);
    ImageOptions options = with("pathtracer", {"bounces=" + std::to_string(bounces)});
    options.batches = bounces == 12 ? 64 : 16;  // Russian roulette begins at 3
    expectUniform(renderImage(inside(sphere(vec3(0.0f), 1.0f, 2), 1.0f), options), series(bounces), {.error = 0.01});
  }
}

TEST(AlbedoSeries, MatchesInsideABox) {
  ImageOptions options = with("pathtracer", {"bounces=3"});
  options.batches = 32;
  expectUniform(renderImage(inside(box(vec3(-1.0f), vec3(1.0f)), 1.0f), options), series(3), {.error = 0.01});
}

// Contributions with at most one scattering event are never clamped, and all others are at most `clamp`.
TEST(AlbedoSeries, ClampsLightAfterTwoScatterings) {
  const auto image = [](const char* clamp) {
    ImageOptions options = with("pathtracer", {"bounces=6", "roulette_start=64", std::string("clamp=") + clamp});
    options.batches = 16;
    return renderImage(inside(sphere(vec3(0.0f), 1.0f, 2), 1.0f), options);
  };
  expectUniform(image("0.000001"), series(1), {.error = 0.02, .rounding = 1e-4});
  expectUniform(image("1000000"), series(6), {.error = 0.02});
  // Five further scattering events, each with a sample of the light and a hit.
  const RenderedImage clamped = image("0.01");
  const vec4 unclamped = series(1);
  for (std::uint32_t y = 0; y < clamped.height(); ++y)
    for (std::uint32_t x = 0; x < clamped.width(); ++x) {
      const double added = clamped.at(x, y, 2).mean() - unclamped.b, error = 4 * clamped.at(x, y, 2).standardError();
      EXPECT_LT(added, 10 * 0.01 + error);
      EXPECT_GT(added, 0.01 - error);
    }
}

TEST(AlbedoSeries, AgreesWithNaive) {
  expectUniform(renderImage(inside(sphere(vec3(0.0f), 1.0f, 2), 1.0f), with("naive", {"bounces=12"})), series(12),
                {.error = 0.01});
}

// Russian roulette from the first bounce on does not change the mean. The surface has two lobes with very different
// weights, to expose a roulette that reuses the random number of the lobe.
TEST(AlbedoSeries, KeepsItsMeanWithRoulette) {
  scene::Material m;
  m.baseColor = {0.3f, 0.3f, 0.3f, 1.0f};
  m.metallic = 0.0f;
  m.ior = 3.0f;
  m.roughness = 0.5f;
  m.emissive = vec3(1.0f);
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 1.0f, 2), m).camera(perspective({0.1f, -0.2f, 0.05f}, {1, 1, 1}, 90.0f));
  const auto meanWith = [&](const char* start) {
    ImageOptions options = with("pathtracer", {"bounces=6", std::string("roulette_start=") + start});
    options.batches = 32;
    const RenderedImage image = renderImage(scene, options);
    Moments mean;  // the variation between pixels is larger than the error
    for (std::uint32_t y = 0; y < image.height(); ++y)
      for (std::uint32_t x = 0; x < image.width(); ++x) mean.add(image.at(x, y, 0).mean());
    return mean;
  };
  const Moments without = meanWith("64"), always = meanWith("1");
  EXPECT_GT(pValue(without, always, 1e-5), 0.001) << without.mean() << " and " << always.mean();
  EXPECT_LT(always.standardError(), 0.02 * always.mean());
}

// Light sampling chooses between 1280 triangles and the environment.
TEST(AlbedoSeries, AddsEmissionAndSky) {
  scene::Material m = lambert(kFurnaceAlbedo);
  m.emissive = vec3(0.25f);
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 1.0f, 3), m).sky({2.0f, 1.0f, 0.5f}).camera(perspective({0, 0, 6}, vec3(0.0f), 12.0f));
  expectUniform(renderImage(scene), vec4(vec3(0.25f) + kFurnaceAlbedo * vec3(2.0f, 1.0f, 0.5f), 1.0f),
                {.error = 0.005});
}

// Kirchhoff's law: a coated black body at the temperature of its surroundings is invisible. The coat removes as much of
// the emission as it adds by reflection.
TEST(Furnace, HidesACoatedBlackBody) {
  for (const float roughness : {0.0f, 0.5f, 1.0f}) {
    SCOPED_TRACE(roughness);
    scene::Material m = emitter(vec3(1.0f));
    m.clearcoat = 1.0f;
    m.clearcoatRoughness = roughness;
    SceneBuilder scene;
    scene.add(sphere(vec3(0.0f), 1.0f, 3), m).sky(vec3(1.0f));
    scene.camera(orthographic({0.6f, 0.4f, 2.0f}, vec3(0.0f), 0.9f));
    ImageOptions options = with("pathtracer", {"bounces=1"});
    expectUniform(renderImage(scene, options), vec4(1.0f), {.error = 0.005, .rounding = 3e-3});
  }
}

// No light enters a closed box through its edges and corners from a bright environment.
TEST(ClosedBox, IsBlackInsideAtAnyScale) {
  for (const float size : {1e-3f, 1.0f, 1e3f, 1e5f}) {
    SCOPED_TRACE(size);
    SceneBuilder scene;
    scene.add(box(vec3(-size), vec3(size)), lambert(vec3(0.9f))).sky(vec3(1000.0f));
    scene.camera(perspective(vec3(0.2f, 0.1f, 0.3f) * size, vec3(-1.0f) * size, 110.0f));
    ImageOptions options;
    options.width = options.height = 16;
    expectBlack(renderImage(scene, options));
  }
}

}  // namespace
}  // namespace quintet::test
