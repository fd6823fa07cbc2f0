// SPDX-License-Identifier: Apache-2.0
// Light transport on solids and CSG trees: furnaces, closed rooms, glass, lamps, alpha. Expected values are closed
// forms, or images of triangle meshes of the same shape.
#include <gtest/gtest.h>

#include "probe.h"
#include "program/load.h"
#include "render/rendered_image.h"

namespace quintet::test {
namespace {

using scene::CsgOperation;
using scene::Primitive;
using scene::PrimitiveSet;
using scene::PrimitiveSetKind;
using scene::PrimitiveType;

const vec3 kFloorAlbedo(0.8f, 0.5f, 0.2f);

Primitive solid(PrimitiveType type, const mat4& objectFromPrimitive = mat4(1.0f), float parameter = 0.4f) {
  Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = objectFromPrimitive;
  primitive.parameter = parameter;
  return primitive;
}

// One tree: the first solid minus all others.
PrimitiveSet difference(const std::vector<Primitive>& primitives) {
  PrimitiveSet set;
  set.kind = PrimitiveSetKind::csg;
  set.primitives = primitives;
  for (std::uint32_t i = 0; i < primitives.size(); ++i) {
    set.nodes.push_back({CsgOperation::leaf, i});
    if (i > 0) set.nodes.push_back({CsgOperation::subtract, 0});
  }
  set.trees = {{0, static_cast<std::uint32_t>(set.nodes.size())}};
  return set;
}

// One instance of a set in which all solids have one material.
void add(SceneBuilder& scene, PrimitiveSet set, const scene::Material& material,
         const mat4& worldFromObject = mat4(1.0f)) {
  for (Primitive& primitive : set.primitives) primitive.material = static_cast<int>(scene.scene.materials.size());
  scene.scene.materials.push_back(material);
  scene::Instance& instance = scene.scene.instances.emplace_back();
  instance.mesh = static_cast<int>(scene.scene.meshes.size());
  instance.worldFromObject = worldFromObject;
  scene.scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
}

ImageOptions withParameters(std::vector<std::string> set, std::uint32_t batches = 16,
                            const std::string& program = "pathtracer") {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.set = std::move(set);
  options.batches = batches;
  return options;
}

constexpr std::array kConvex{PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder, PrimitiveType::cone};

void expectSameMean(const RenderedImage& a, const RenderedImage& b, double part) {
  const std::size_t tests = std::size_t{3} * a.width() * a.height();
  for (std::uint32_t y = 0; y < a.height(); ++y)
    for (std::uint32_t x = 0; x < a.width(); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_GE(pValue(a.at(x, y, c), b.at(x, y, c), part * b.at(x, y, c).mean()), sidak(0.01, tests))
            << x << "," << y << ": " << a.at(x, y, c).mean() << " instead of " << b.at(x, y, c).mean();
}

// All convex solids side by side. They fill the image.
PrimitiveSet convexSolids() {
  return solidsOf({solid(PrimitiveType::sphere, moved(-1, 0, 1)), solid(PrimitiveType::box, moved(1, 0, 1)),
                   solid(PrimitiveType::cylinder, moved(-1, 0, -1)), solid(PrimitiveType::cone, moved(1, 0, -1))});
}

TEST(SolidLight, ConvexSolidsInAUniformSkyShowTheirAlbedo) {
  const std::array<mat4, 4> places{mat4(1.0f), scaled(1e-3f, 1e-3f, 1e-3f), moved(700, -500, 510),
                                   scaled(-2e4f, 1e4f, 1e4f)};
  for (std::size_t k = 0; k < 2; ++k) {
    for (const PrimitiveType type : kConvex) {
      // Not all pairs, because each takes seconds to compile.
      const mat4& m = places[(static_cast<std::size_t>(type) + 3 * k) % 4];
      SCOPED_TRACE(testing::Message() << static_cast<int>(type) << " " << k);
      SceneBuilder scene;
      add(scene, solidsOf({solid(type)}), lambert(kFloorAlbedo), m);
      const float size = glm::length(vec3(m[1]));
      const vec3 middle = m[3];
      scene.sky(vec3(1.0f)).camera(orthographic(middle + vec3(0.3f, 0.2f, 1.0f) * 4.0f * size, middle, 0.3f * size));
      expectUniform(renderImage(scene, withParameters({}, 6)), vec4(kFloorAlbedo, 1.0f), {.error = 0.005});
    }
  }
}

// White concave solids: every path finally reaches the sky, with weight 1.
TEST(SolidLight, WhiteBodiesAreInvisibleInAUniformSky) {
  const PrimitiveSet drilled =
      difference({solid(PrimitiveType::box), solid(PrimitiveType::cylinder, scaled(0.6f, 2, 0.6f)),
                  solid(PrimitiveType::sphere, moved(0, 0, 1) * scaled(0.7f, 0.7f, 0.7f)),
                  solid(PrimitiveType::torus, moved(-1, 0, 0)),
                  solid(PrimitiveType::cone, moved(1, 0, 0) * scaled(0.5f, 1.4f, 0.5f))});
  for (const PrimitiveSet& set : {drilled, solidsOf({solid(PrimitiveType::torus)}), convexSolids()}) {
    SceneBuilder scene;
    add(scene, set, lambert(vec3(1.0f)), glm::rotate(mat4(1.0f), 0.3f, vec3(0, 1, 0)));
    scene.sky(vec3(0.5f, 1.0f, 2.0f)).camera(perspective({1.5f, 2.0f, 4.0f}, vec3(0.0f), 30.0f));
    for (const char* program : {"pathtracer", "naive"}) {
      SCOPED_TRACE(program);
      ImageOptions options = withParameters({"bounces=10000"}, 16, program);
      if (options.program.name == "pathtracer") options.set.push_back("roulette_start=10000");
      expectUniform(renderImage(scene, options), vec4(0.5f, 1.0f, 2.0f, 1.0f), {.error = 0.01});
    }
  }
}

// No light enters closed surfaces from a bright environment, at any scale, including edges.
TEST(SolidLight, IsBlackInside) {
  constexpr std::array kSizes{1e-3f, 1.0f, 1e4f};
  const auto look = [](PrimitiveSet set, float size) {
    SceneBuilder scene;
    add(scene, std::move(set), lambert(vec3(0.9f)), scaled(size, size, size));
    scene.sky(vec3(1000.0f)).camera(perspective(vec3(0.05f, -0.3f, 0.1f) * size, vec3(-1.0f) * size, 110.0f));
    ImageOptions options = withParameters({}, 8);
    options.width = options.height = 16;
    expectBlack(renderImage(scene, options));
  };
  for (const PrimitiveType type : kConvex) {
    SCOPED_TRACE(static_cast<int>(type));
    look(solidsOf({solid(type)}), kSizes[static_cast<std::size_t>(type) % 3]);
  }
  for (const float size : kSizes) {
    SCOPED_TRACE(size);
    look(difference({solid(PrimitiveType::box), solid(PrimitiveType::sphere, scaled(0.9f, 0.9f, 0.9f)),
                     solid(PrimitiveType::cylinder, scaled(0.3f, 0.95f, 0.3f))}),
         size);
  }
}

// Inside a closed surface that emits L everywhere: L · (1 + a + a² + … + a^bounces).
TEST(SolidLight, AlbedoSeriesInside) {
  vec3 sum(0.0f), power(0.5f, 1.0f, 2.0f);
  for (int i = 0; i <= 3; ++i) sum += power, power *= kFloorAlbedo;
  for (const PrimitiveType type : {PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cone}) {
    SCOPED_TRACE(static_cast<int>(type));
    scene::Material m = lambert(kFloorAlbedo);
    m.emissive = {0.5f, 1.0f, 2.0f};
    SceneBuilder scene;
    add(scene, solidsOf({solid(type)}), m);
    scene.camera(perspective(vec3(0.1f, -0.2f, 0.05f), vec3(1, 1, 1), 90.0f));
    expectUniform(renderImage(scene, withParameters({"bounces=3"}, 16)), vec4(sum, 1.0f), {.error = 0.01});
  }
}

// A spherical lamp above a plane: E = π L sin²α cos θ, if the whole lamp is above the horizon.
TEST(SolidLight, SphereLampsMatchTheirFormula) {
  const float radius = 0.5f;
  const vec3 center(0.6f, 2.0f, -0.3f), radiance(4.0f, 2.0f, 1.0f);
  for (const mat4& turn : {mat4(1.0f), glm::rotate(mat4(1.0f), 1.0f, vec3(1, 2, 3)) * scaled(-1, 1, 1)}) {
    SceneBuilder scene;
    add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(1, 1, 1))}), lambert(kFloorAlbedo));
    add(scene, solidsOf({solid(PrimitiveType::sphere, scaled(radius, radius, radius))}), emitter(radiance),
        glm::translate(mat4(1.0f), center) * turn);
    scene.camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 1e-3f));
    const float squared = glm::dot(center, center);
    const float irradiance = kPi * radius * radius / squared * center.y / std::sqrt(squared);
    expectUniform(renderImage(scene, withParameters({"bounces=1"}, 64)),
                  vec4(irradiance / kPi * kFloorAlbedo * radiance, 1.0f), {.error = 0.02});
  }
}

// Stretched lamps of every shape above a plane and beside a mirror: light samples and BSDF samples with MIS weights,
// compared with BSDF samples alone.
TEST(SolidLight, LampsOfEveryShapeAgreeWithBruteForce) {
  const mat4 turn = glm::rotate(mat4(1.0f), 0.8f, glm::normalize(vec3(1, 2, 0.5f)));
  for (const PrimitiveType type : {PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder,
                                   PrimitiveType::cone, PrimitiveType::torus}) {
    SCOPED_TRACE(static_cast<int>(type));
    SceneBuilder scene;
    scene::Material floor = lambert(kFloorAlbedo);
    floor.specular = 1.0f;
    floor.roughness = 0.3f;
    add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(3, 1, 3))}), floor);
    add(scene, solidsOf({solid(type, turn * scaled(0.9f, 0.4f, 0.6f))}), emitter({4.0f, 2.0f, 1.0f}),
        moved(0, 1.2f, 0) * scaled(1, 1, -1));
    scene.camera(perspective({0, 1.5f, 4.0f}, {0, 0.2f, 0}, 30.0f));
    const RenderedImage direct = renderImage(scene, withParameters({"bounces=2"}, 32));
    const RenderedImage naive = renderImage(scene, withParameters({"bounces=2"}, 192, "naive"));
    expectSameMean(direct, naive, 1e-4);
  }
}

// The umbra of a point light behind a solid is black.
TEST(SolidLight, SolidsAndTreesCastShadows) {
  scene::Light lamp;
  lamp.position = {0, 5, 0};
  lamp.intensity = vec3(100.0f);
  const mat4 place = moved(0, 1, 0) * scaled(0.6f, 0.2f, 0.6f);
  std::vector<PrimitiveSet> sets{difference(
      {solid(PrimitiveType::box, place), solid(PrimitiveType::sphere, moved(0, 1.2f, 0) * scaled(0.5f, 0.15f, 0.5f))})};
  for (const PrimitiveType type :
       {PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder, PrimitiveType::cone})
    sets.push_back(solidsOf({solid(type, place)}));
  for (const PrimitiveSet& set : sets) {
    SceneBuilder scene;
    add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(3, 1, 3))}), lambert(vec3(0.5f)));
    add(scene, set, lambert(vec3(0.0f)));
    scene.light(lamp).camera(perspective({1.5f, 0.3f, 0}, vec3(0.0f), 3.0f));
    expectBlack(renderImage(scene, withParameters({}, 4)));
  }
}

// ---- glass ----

scene::Material glass() {
  scene::Material m = clearGlass(1.5f, 1.0f);
  m.attenuationColor = {0.3f, 0.7f, 0.9f};
  m.attenuationDistance = 2.0f;
  return m;
}

// A glass solid in front of a wall of two colors, under a sky.
SceneBuilder showcase() {
  SceneBuilder scene;
  scene.add(quad({-4, -4, -2}, {4, 0, 0}, {0, 8, 0}), emitter({2.0f, 0.5f, 0.1f}));
  scene.add(quad({0, -4, -2}, {4, 0, 0}, {0, 8, 0}), emitter({0.2f, 0.4f, 3.0f}));
  scene.sky(vec3(0.3f)).camera(perspective({1.0f, 0.8f, 5.0f}, vec3(0.0f), 26.0f));
  return scene;
}

TEST(SolidGlass, BoxMatchesTheTriangleMesh) {
  const mat4 turn = glm::rotate(mat4(1.0f), 0.6f, glm::normalize(vec3(1, 2, 0.5f)));
  SceneBuilder triangles = showcase(), analytic = showcase(), tree = showcase();
  triangles.add(box(vec3(-1), vec3(1)), glass(), turn);
  add(analytic, solidsOf({solid(PrimitiveType::box, turn)}), glass());
  // As the intersection of itself and a larger box.
  PrimitiveSet common = difference(
      {solid(PrimitiveType::box, turn * scaled(1, 1, 1.3f)), solid(PrimitiveType::box, turn * scaled(1.2f, 1.0f, 1))});
  common.nodes.back().operation = CsgOperation::intersect;
  add(tree, common, glass());
  const ImageOptions options = withParameters({}, 64);
  const RenderedImage reference = renderImage(triangles, options);
  expectSameMean(renderImage(analytic, options), reference, 1e-3);
  expectSameMean(renderImage(tree, options), reference, 1e-3);
}

TEST(SolidGlass, SphereMatchesTheTriangleMesh) {
  SceneBuilder triangles = showcase(), analytic = showcase();
  scene::Geometry mesh = sphere(vec3(0.0f), 1.0f, 6);
  mesh.normals = mesh.positions;
  triangles.add(mesh, glass());
  add(analytic, solidsOf({solid(PrimitiveType::sphere)}), glass());
  const ImageOptions options = withParameters({}, 64);
  expectSameMean(renderImage(analytic, options), renderImage(triangles, options), 0.01);
}

// A hollow sphere, as a tree and as two triangle meshes, one of them inside out.
TEST(SolidGlass, HollowSphereMatchesTheTriangleMesh) {
  SceneBuilder triangles = showcase(), tree = showcase();
  for (const float radius : {1.0f, 0.7f}) {
    scene::Geometry mesh = sphere(vec3(0.0f), radius, 6);
    for (const vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(p) * (radius < 1.0f ? -1.0f : 1.0f));
    if (radius < 1.0f)
      for (uvec3& t : mesh.triangles) std::swap(t.x, t.y);
    triangles.add(mesh, glass());
  }
  add(tree, difference({solid(PrimitiveType::sphere), solid(PrimitiveType::sphere, scaled(0.7f, 0.7f, 0.7f))}),
      glass());
  const ImageOptions options = withParameters({}, 64);
  expectSameMean(renderImage(tree, options), renderImage(triangles, options), 0.015);
}

// ---- alpha ----

// The alpha test is independent for each crossing of the ray.
TEST(SolidAlpha, TestsEachCrossingIndependently) {
  struct Case {
    const char* name;
    PrimitiveSet set;
    int crossings;
  };
  const mat4 small = scaled(0.5f, 0.5f, 0.5f);
  for (const Case& c :
       {Case{"ball", solidsOf({solid(PrimitiveType::sphere)}), 2},
        Case{"torus", solidsOf({solid(PrimitiveType::torus)}), 4},
        Case{"shell", difference({solid(PrimitiveType::sphere), solid(PrimitiveType::sphere, small)}), 4}}) {
    SCOPED_TRACE(c.name);
    SceneBuilder scene;
    scene::Material m = unlit({2.0f, 1.0f, 0.5f}, 0.4f);
    m.alphaMode = scene::AlphaMode::blend;
    add(scene, c.set, m);
    scene.sky({0.5f, 0.25f, 4.0f}).camera(orthographic({0, 0, 5}, vec3(0.0f), 0.1f));
    const float through = std::pow(0.6f, static_cast<float>(c.crossings));
    const vec3 exact = (1.0f - through) * vec3(2.0f, 1.0f, 0.5f) + through * vec3(0.5f, 0.25f, 4.0f);
    for (const char* program : {"pathtracer", "naive"})
      expectUniform(renderImage(scene, withParameters({}, 64, program)), vec4(exact, 1.0f), {.error = 0.02});
  }
}

// Two balls of one set: the material of the first one is opaque, so its alpha has no effect. Solids have no vertex colors, in
// contrast to the mesh beside them.
TEST(SolidAlpha, OpaqueMaterialsIgnoreIt) {
  SceneBuilder scene;
  scene::Material m = unlit({2.0f, 1.0f, 0.5f}, 0.4f);
  PrimitiveSet balls = solidsOf({solid(PrimitiveType::sphere), solid(PrimitiveType::sphere, moved(9, 0, 0))});
  add(scene, balls, m);
  m.alphaMode = scene::AlphaMode::blend;
  scene.scene.meshes[0].primitiveSets[0].primitives[1].material = 1;
  scene.scene.materials.push_back(m);
  scene::Geometry colored = quad({20, 0, 0}, {1, 0, 0}, {0, 1, 0});
  colored.colors.assign(4, vec4(0.5f));
  scene.add(colored, lambert(vec3(0.5f)));
  scene.sky({0.5f, 0.25f, 4.0f}).camera(orthographic({0, 0, 5}, vec3(0.0f), 0.1f));
  expectUniform(renderImage(scene, withParameters({}, 8)), vec4(2.0f, 1.0f, 0.5f, 1.0f));
}

TEST(SolidAlpha, AttenuatesShadowRays) {
  scene::Light lamp;
  lamp.type = scene::LightType::directional;
  lamp.direction = {0, -1, 0};
  lamp.intensity = vec3(kPi);
  for (const scene::AlphaMode mode : {scene::AlphaMode::blend, scene::AlphaMode::mask, scene::AlphaMode::opaque}) {
    for (const bool tree : {false, true}) {
      SceneBuilder scene;
      add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(3, 1, 3))}), lambert(kFloorAlbedo));
      scene::Material m = lambert(vec3(0.0f));
      m.alphaMode = mode;
      m.baseColor.a = 0.4f;
      const Primitive ball = solid(PrimitiveType::sphere, moved(0, 2, 0));
      add(scene, tree ? difference({ball, solid(PrimitiveType::box, moved(5, 0, 0))}) : solidsOf({ball}), m);
      scene.light(lamp).camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 0.1f));
      const float through = mode == scene::AlphaMode::blend ? 0.36f : mode == scene::AlphaMode::mask ? 1.0f : 0.0f;
      expectUniform(renderImage(scene, withParameters({"bounces=1"}, 64)), vec4(through * kFloorAlbedo, 1.0f),
                    {.error = 0.02});
    }
  }
}

}  // namespace
}  // namespace quintet::test
