// Solids and trees under light: furnaces, closed rooms, glass, lamps, alpha. What comes back is known without any
// integral, or comes from triangles of the same shape.
#include <gtest/gtest.h>

#include "probe.h"
#include "render/picture.h"

namespace quintet::test {
namespace {

using scene::CsgOperation;
using scene::Primitive;
using scene::PrimitiveSet;
using scene::PrimitiveSetKind;
using scene::PrimitiveType;

const vec3 kAlbedo(0.8f, 0.5f, 0.2f);

Primitive solid(PrimitiveType type, const mat4& objectFromPrimitive = mat4(1.0f), float parameter = 0.4f) {
  Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = objectFromPrimitive;
  primitive.parameter = parameter;
  return primitive;
}

mat4 scaled(float x, float y, float z) { return glm::scale(mat4(1.0f), vec3(x, y, z)); }
mat4 moved(float x, float y, float z) { return glm::translate(mat4(1.0f), vec3(x, y, z)); }

// first minus all the others, in one tree.
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

// One instance of a set that is all of one material.
void add(SceneBuilder& scene, PrimitiveSet set, const scene::Material& material,
         const mat4& worldFromObject = mat4(1.0f)) {
  for (Primitive& primitive : set.primitives) primitive.material = static_cast<int>(scene.scene.materials.size());
  scene.scene.materials.push_back(material);
  scene::Instance& instance = scene.scene.instances.emplace_back();
  instance.mesh = static_cast<int>(scene.scene.meshes.size());
  instance.worldFromObject = worldFromObject;
  scene.scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
}

PictureOptions with(std::vector<std::string> set, std::uint32_t batches = 16,
                    const std::string& program = "pathtracer") {
  PictureOptions options;
  options.program = program::loadProgram(program);
  options.set = std::move(set);
  options.batches = batches;
  return options;
}

constexpr std::array kConvex{PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder, PrimitiveType::cone};

void expectSame(const Picture& a, const Picture& b, double part) {
  const std::size_t tests = std::size_t{3} * a.width() * a.height();
  for (std::uint32_t y = 0; y < a.height(); ++y)
    for (std::uint32_t x = 0; x < a.width(); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_GE(pValue(a.at(x, y, c), b.at(x, y, c), part * b.at(x, y, c).mean()), sidak(0.01, tests))
            << x << "," << y << ": " << a.at(x, y, c).mean() << " instead of " << b.at(x, y, c).mean();
}

// All convex solids side by side, and what shows of them fills the image.
PrimitiveSet convexSolids() {
  return solidsOf({solid(PrimitiveType::sphere, moved(-1, 0, 1)), solid(PrimitiveType::box, moved(1, 0, 1)),
                   solid(PrimitiveType::cylinder, moved(-1, 0, -1)), solid(PrimitiveType::cone, moved(1, 0, -1))});
}

TEST(SolidLight, ConvexSolidsInAUniformSkyShowTheirAlbedo) {
  const std::array<mat4, 4> places{mat4(1.0f), scaled(1e-3f, 1e-3f, 1e-3f), moved(700, -500, 510),
                                   scaled(-2e4f, 1e4f, 1e4f)};
  for (std::size_t k = 0; k < 2; ++k) {
    for (const PrimitiveType type : kConvex) {
      const mat4& m = places[(static_cast<std::size_t>(type) + 3 * k) % 4];  // not all pairs: each compiles for seconds
      SCOPED_TRACE(testing::Message() << static_cast<int>(type) << " " << k);
      SceneBuilder scene;
      add(scene, solidsOf({solid(type)}), lambert(kAlbedo), m);
      const float size = glm::length(vec3(m[1]));
      const vec3 middle = m[3];
      scene.sky(vec3(1.0f)).camera(orthographic(middle + vec3(0.3f, 0.2f, 1.0f) * 4.0f * size, middle, 0.3f * size));
      expectUniform(renderPicture(scene, with({}, 6)), vec4(kAlbedo, 1.0f), {.error = 0.005});
    }
  }
}

// White and concave: every path leaves at last and brings the sky's light, wherever it went before.
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
      PictureOptions options = with({"bounces=10000"}, 16, program);
      if (options.program.name == "pathtracer") options.set.push_back("roulette_start=10000");
      expectUniform(renderPicture(scene, options), vec4(0.5f, 1.0f, 2.0f, 1.0f), {.error = 0.01});
    }
  }
}

// Inside closed surfaces with a bright world outside: nothing comes in, at any scale, also through the rims.
TEST(SolidLight, IsDarkInside) {
  constexpr std::array kSizes{1e-3f, 1.0f, 1e4f};
  const auto look = [](PrimitiveSet set, float size) {
    SceneBuilder scene;
    add(scene, std::move(set), lambert(vec3(0.9f)), scaled(size, size, size));
    scene.sky(vec3(1000.0f)).camera(perspective(vec3(0.05f, -0.3f, 0.1f) * size, vec3(-1.0f) * size, 110.0f));
    PictureOptions options = with({}, 8);
    options.width = options.height = 16;
    expectBlack(renderPicture(scene, options));
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
  for (int i = 0; i <= 3; ++i) sum += power, power *= kAlbedo;
  for (const PrimitiveType type : {PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cone}) {
    SCOPED_TRACE(static_cast<int>(type));
    scene::Material m = lambert(kAlbedo);
    m.emissive = {0.5f, 1.0f, 2.0f};
    SceneBuilder scene;
    add(scene, solidsOf({solid(type)}), m);
    scene.camera(perspective(vec3(0.1f, -0.2f, 0.05f), vec3(1, 1, 1), 90.0f));
    expectUniform(renderPicture(scene, with({"bounces=3"}, 16)), vec4(sum, 1.0f), {.error = 0.01});
  }
}

// A lamp in the shape of a ball, above a plane: E = π L sin²α cos θ, as long as all of it is above the horizon.
TEST(SolidLight, BallsLightAPlane) {
  const float radius = 0.5f;
  const vec3 center(0.6f, 2.0f, -0.3f), radiance(4.0f, 2.0f, 1.0f);
  for (const mat4& turn : {mat4(1.0f), glm::rotate(mat4(1.0f), 1.0f, vec3(1, 2, 3)) * scaled(-1, 1, 1)}) {
    SceneBuilder scene;
    add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(1, 1, 1))}), lambert(kAlbedo));
    add(scene, solidsOf({solid(PrimitiveType::sphere, scaled(radius, radius, radius))}), emitter(radiance),
        glm::translate(mat4(1.0f), center) * turn);
    scene.camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 1e-3f));
    const float squared = glm::dot(center, center);
    const float irradiance = kPi * radius * radius / squared * center.y / std::sqrt(squared);
    expectUniform(renderPicture(scene, with({"bounces=1"}, 64)), vec4(irradiance / kPi * kAlbedo * radiance, 1.0f),
                  {.error = 0.02});
  }
}

// Lamps of every shape, stretched, over a plane and beside a mirror: light samples and BSDF samples, weighted, against
// BSDF samples alone.
TEST(SolidLight, LampsOfEveryShapeAgreeWithBruteForce) {
  const mat4 turn = glm::rotate(mat4(1.0f), 0.8f, glm::normalize(vec3(1, 2, 0.5f)));
  for (const PrimitiveType type : {PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder,
                                   PrimitiveType::cone, PrimitiveType::torus}) {
    SCOPED_TRACE(static_cast<int>(type));
    SceneBuilder scene;
    scene::Material floor = lambert(kAlbedo);
    floor.specular = 1.0f;
    floor.roughness = 0.3f;
    add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(3, 1, 3))}), floor);
    add(scene, solidsOf({solid(type, turn * scaled(0.9f, 0.4f, 0.6f))}), emitter({4.0f, 2.0f, 1.0f}),
        moved(0, 1.2f, 0) * scaled(1, 1, -1));
    scene.camera(perspective({0, 1.5f, 4.0f}, {0, 0.2f, 0}, 30.0f));
    const Picture direct = renderPicture(scene, with({"bounces=2"}, 32));
    const Picture naive = renderPicture(scene, with({"bounces=2"}, 192, "naive"));
    expectSame(direct, naive, 1e-4);
  }
}

// A lamp behind a solid gives no light: the umbra of a point light is black.
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
    expectBlack(renderPicture(scene, with({}, 4)));
  }
}

// ---- glass ----

scene::Material glass() {
  scene::Material m = clearGlass(1.5f, 1.0f);
  m.attenuationColor = {0.3f, 0.7f, 0.9f};
  m.attenuationDistance = 2.0f;
  return m;
}

// A body of glass before a wall of two colours and under a sky.
SceneBuilder showcase() {
  SceneBuilder scene;
  scene.add(quad({-4, -4, -2}, {4, 0, 0}, {0, 8, 0}), emitter({2.0f, 0.5f, 0.1f}));
  scene.add(quad({0, -4, -2}, {4, 0, 0}, {0, 8, 0}), emitter({0.2f, 0.4f, 3.0f}));
  scene.sky(vec3(0.3f)).camera(perspective({1.0f, 0.8f, 5.0f}, vec3(0.0f), 26.0f));
  return scene;
}

TEST(SolidGlass, TheBoxIsTheBoxOfTriangles) {
  const mat4 turn = glm::rotate(mat4(1.0f), 0.6f, glm::normalize(vec3(1, 2, 0.5f)));
  SceneBuilder triangles = showcase(), analytic = showcase(), tree = showcase();
  triangles.add(box(vec3(-1), vec3(1)), glass(), turn);
  add(analytic, solidsOf({solid(PrimitiveType::box, turn)}), glass());
  // As the common part of a larger box and itself.
  PrimitiveSet common = difference(
      {solid(PrimitiveType::box, turn * scaled(1, 1, 1.3f)), solid(PrimitiveType::box, turn * scaled(1.2f, 1.0f, 1))});
  common.nodes.back().operation = CsgOperation::intersect;
  add(tree, common, glass());
  const PictureOptions options = with({}, 64);
  const Picture reference = renderPicture(triangles, options);
  expectSame(renderPicture(analytic, options), reference, 1e-3);
  expectSame(renderPicture(tree, options), reference, 1e-3);
}

TEST(SolidGlass, TheBallIsTheBallOfManyTriangles) {
  SceneBuilder triangles = showcase(), analytic = showcase();
  scene::Geometry mesh = sphere(vec3(0.0f), 1.0f, 6);
  mesh.normals = mesh.positions;
  triangles.add(mesh, glass());
  add(analytic, solidsOf({solid(PrimitiveType::sphere)}), glass());
  const PictureOptions options = with({}, 64);
  expectSame(renderPicture(analytic, options), renderPicture(triangles, options), 0.01);
}

// A hollow ball, as a tree and as two spheres of triangles of which one is turned inside out.
TEST(SolidGlass, TheHollowBallIsTheOneOfTriangles) {
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
  const PictureOptions options = with({}, 64);
  expectSame(renderPicture(tree, options), renderPicture(triangles, options), 0.015);
}

// ---- alpha ----

// Crossings along the view are there by chance, each for itself.
TEST(SolidAlpha, EachCrossingCountsForItself) {
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
      expectUniform(renderPicture(scene, with({}, 64, program)), vec4(exact, 1.0f), {.error = 0.02});
  }
}

TEST(SolidAlpha, ShadowsAreAsThinAsTheSurface) {
  scene::Light lamp;
  lamp.type = scene::LightType::directional;
  lamp.direction = {0, -1, 0};
  lamp.intensity = vec3(kPi);
  for (const scene::AlphaMode mode : {scene::AlphaMode::blend, scene::AlphaMode::mask, scene::AlphaMode::opaque}) {
    for (const bool tree : {false, true}) {
      SceneBuilder scene;
      add(scene, solidsOf({solid(PrimitiveType::box, moved(0, -1, 0) * scaled(3, 1, 3))}), lambert(kAlbedo));
      scene::Material m = lambert(vec3(0.0f));
      m.alphaMode = mode;
      m.baseColor.a = 0.4f;
      const Primitive ball = solid(PrimitiveType::sphere, moved(0, 2, 0));
      add(scene, tree ? difference({ball, solid(PrimitiveType::box, moved(5, 0, 0))}) : solidsOf({ball}), m);
      scene.light(lamp).camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 0.1f));
      const float through = mode == scene::AlphaMode::blend ? 0.36f : mode == scene::AlphaMode::mask ? 1.0f : 0.0f;
      expectUniform(renderPicture(scene, with({"bounces=1"}, 64)), vec4(through * kAlbedo, 1.0f), {.error = 0.02});
    }
  }
}

}  // namespace
}  // namespace quintet::test
