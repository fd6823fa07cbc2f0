// Lambert surfaces under uniform light: what comes back is known without any integral.
#include <gtest/gtest.h>

#include "picture.h"

namespace quintet::test {
namespace {

const vec3 kAlbedo(0.8f, 0.5f, 0.2f);

PictureOptions with(const std::string& program, std::vector<std::string> set = {}) {
  PictureOptions options;
  options.program = program::loadProgram(program);
  options.set = std::move(set);
  return options;
}

// A sphere of this size whose middle fills the image.
SceneBuilder furnace(float size, const vec3& center, const mat4& worldFromObject = mat4(1.0f)) {
  SceneBuilder scene;
  const vec3 middle = worldFromObject * vec4(center, 1.0f);
  scene.add(sphere(center, size, 3), lambert(kAlbedo), worldFromObject).sky(vec3(1.0f));
  scene.camera(orthographic(middle + vec3(0.3f, 0.2f, 1.0f) * 2.0f * size, middle, 0.55f * size));
  return scene;
}

TEST(Furnace, ASphereInAUniformSkyShowsItsAlbedo) {
  expectUniform(renderPicture(furnace(1.0f, vec3(0.0f))), vec4(kAlbedo, 1.0f), {.error = 0.003});
}

TEST(Furnace, NaiveAgrees) {
  expectUniform(renderPicture(furnace(1.0f, vec3(0.0f)), with("naive")), vec4(kAlbedo, 1.0f), {.error = 0.003});
}

// A ray that meets the surface it starts from would find albedo² instead of albedo.
TEST(Furnace, HasNoAcneAtAnyScale) {
  PictureOptions options;
  options.batches = 8;
  for (const float size : {1e-3f, 1e-1f, 10.0f, 1e3f, 1e5f}) {
    SCOPED_TRACE(size);
    expectUniform(renderPicture(furnace(size, vec3(0.0f)), options), vec4(kAlbedo, 1.0f), {.error = 0.005});
  }
}

TEST(Furnace, HasNoAcneFarFromTheOrigin) {
  PictureOptions options;
  options.batches = 8;
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    SCOPED_TRACE(size);
    const vec3 far = vec3(700.0f, -500.0f, 510.0f) * size;  // 1000 times its size
    expectUniform(renderPicture(furnace(size, far), options), vec4(kAlbedo, 1.0f), {.error = 0.005});
    const mat4 moved = glm::translate(mat4(1.0f), far);
    expectUniform(renderPicture(furnace(size, vec3(0.0f), moved), options), vec4(kAlbedo, 1.0f), {.error = 0.005});
  }
}

TEST(Furnace, HasNoAcneUnderUnevenAndMirroredScale) {
  const mat4 turned = glm::rotate(mat4(1.0f), 0.7f, glm::normalize(vec3(1, 2, 3)));
  for (const vec3 scale : {vec3(1.0f, 0.02f, 1.0f), vec3(-1.0f, 1.0f, 1.0f)}) {
    SceneBuilder scene;
    scene
        .add(sphere(vec3(0.0f), 1.0f, 3), lambert(kAlbedo),
             turned * glm::scale(mat4(1.0f), scale) * glm::inverse(turned))
        .sky(vec3(1.0f));
    const vec3 side = turned * vec4(0, 1, 0, 0);  // where even the flat one fills the image
    scene.camera(orthographic(4.0f * side, vec3(0.0f), 0.4f));
    PictureOptions options;
    options.batches = 8;
    expectUniform(renderPicture(scene, options), vec4(kAlbedo, 1.0f), {.error = 0.005});
  }
}

// Inside a closed surface that emits L everywhere: L · (1 + a + a² + … + a^bounces).
SceneBuilder inside(const scene::Geometry& geometry, float size) {
  scene::Material m = lambert(kAlbedo);
  m.emissive = {0.5f, 1.0f, 2.0f};
  SceneBuilder scene;
  scene.add(geometry, m);
  scene.camera(perspective(vec3(0.1f, -0.2f, 0.05f) * size, vec3(1, 1, 1) * size, 90.0f));
  return scene;
}

vec4 series(int bounces) {
  vec3 sum(0.0f), power(0.5f, 1.0f, 2.0f);
  for (int i = 0; i <= bounces; ++i) sum += power, power *= kAlbedo;
  return vec4(sum, 1.0f);
}

TEST(AlbedoSeries, InsideASphere) {
  for (const int bounces : {0, 1, 3, 12}) {
    SCOPED_TRACE(bounces);
    PictureOptions options = with("pathtracer", {"bounces=" + std::to_string(bounces)});
    options.batches = bounces == 12 ? 64 : 16;  // Russian roulette begins at 5
    expectUniform(renderPicture(inside(sphere(vec3(0.0f), 1.0f, 2), 1.0f), options), series(bounces), {.error = 0.01});
  }
}

TEST(AlbedoSeries, InsideABox) {
  PictureOptions options = with("pathtracer", {"bounces=3"});
  options.batches = 32;
  expectUniform(renderPicture(inside(box(vec3(-1.0f), vec3(1.0f)), 1.0f), options), series(3), {.error = 0.01});
}

TEST(AlbedoSeries, NaiveAgrees) {
  expectUniform(renderPicture(inside(sphere(vec3(0.0f), 1.0f, 2), 1.0f), with("naive", {"bounces=12"})), series(12),
                {.error = 0.01});
}

// Russian roulette from the first event on changes no mean. The surface has two lobes of very different weight, so that
// a roulette that used the lobe's number would show.
TEST(AlbedoSeries, RouletteChangesNoMean) {
  scene::Material m;
  m.baseColor = {0.3f, 0.3f, 0.3f, 1.0f};
  m.metallic = 0.0f;
  m.ior = 3.0f;
  m.roughness = 0.5f;
  m.emissive = vec3(1.0f);
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 1.0f, 2), m).camera(perspective({0.1f, -0.2f, 0.05f}, {1, 1, 1}, 90.0f));
  const auto meanWith = [&](const char* start) {
    PictureOptions options = with("pathtracer", {"bounces=6", std::string("roulette_start=") + start});
    options.batches = 32;
    const Picture picture = renderPicture(scene, options);
    Moments mean;  // the pixels' scatter is more than the error
    for (std::uint32_t y = 0; y < picture.height(); ++y)
      for (std::uint32_t x = 0; x < picture.width(); ++x) mean.add(picture.at(x, y, 0).mean());
    return mean;
  };
  const Moments without = meanWith("64"), always = meanWith("1");
  EXPECT_GT(pValue(without, always, 1e-5), 0.001) << without.mean() << " and " << always.mean();
  EXPECT_LT(always.standardError(), 0.02 * always.mean());
}

// Light sampling has to choose between 1280 triangles and the environment.
TEST(AlbedoSeries, EmissionAddsToTheSky) {
  scene::Material m = lambert(kAlbedo);
  m.emissive = vec3(0.25f);
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 1.0f, 3), m).sky({2.0f, 1.0f, 0.5f}).camera(perspective({0, 0, 6}, vec3(0.0f), 12.0f));
  expectUniform(renderPicture(scene), vec4(vec3(0.25f) + kAlbedo * vec3(2.0f, 1.0f, 0.5f), 1.0f), {.error = 0.005});
}

// Kirchhoff's law: a lacquered black body as hot as its surroundings looks like them. The coat takes from the emission
// what it adds by reflection.
TEST(Furnace, ALacqueredBlackBodyIsNotSeen) {
  for (const float roughness : {0.0f, 0.5f, 1.0f}) {
    SCOPED_TRACE(roughness);
    scene::Material m = emitter(vec3(1.0f));
    m.clearcoat = 1.0f;
    m.clearcoatRoughness = roughness;
    SceneBuilder scene;
    scene.add(sphere(vec3(0.0f), 1.0f, 3), m).sky(vec3(1.0f));
    scene.camera(orthographic({0.6f, 0.4f, 2.0f}, vec3(0.0f), 0.9f));
    PictureOptions options = with("pathtracer", {"bounces=1"});
    expectUniform(renderPicture(scene, options), vec4(1.0f), {.error = 0.005, .rounding = 3e-3});
  }
}

// From inside a closed box, with a bright world outside: nothing comes in through edges and corners.
TEST(ClosedBox, IsBlackInsideAtAnyScale) {
  for (const float size : {1e-3f, 1.0f, 1e3f, 1e5f}) {
    SCOPED_TRACE(size);
    SceneBuilder scene;
    scene.add(box(vec3(-size), vec3(size)), lambert(vec3(0.9f))).sky(vec3(1000.0f));
    scene.camera(perspective(vec3(0.2f, 0.1f, 0.3f) * size, vec3(-1.0f) * size, 110.0f));
    PictureOptions options;
    options.width = options.height = 16;
    expectBlack(renderPicture(scene, options));
  }
}

}  // namespace
}  // namespace quintet::test
