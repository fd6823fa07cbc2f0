// The scene's own functions: sums over it, validation, hash, default sky.
#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "scene/content_hash.h"
#include "scene/default_environment.h"
#include "scene/gltf_builder.h"
#include "scene/validate.h"

namespace quintet::test {
namespace {

scene::Scene smallScene() {
  scene::Scene s;
  scene::Geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  g.normals.assign(3, vec3(0, 0, 1));
  g.triangles = {{0, 1, 2}};
  g.material = 0;
  s.meshes.push_back({"mesh", {g}});
  s.instances.push_back({"a", 0, mat4(1.0f)});
  s.instances.push_back({"b", 0, glm::translate(mat4(1.0f), vec3(10, 0, 0))});
  s.materials.emplace_back();
  s.materials[0].baseColorTexture.texture = 0;
  s.textures.push_back({"texture", 0, {}});
  s.images.push_back({"image", io::makeImage(1, 1, 3, io::PixelType::u8, io::ColorEncoding::sRgb)});
  s.cameras.emplace_back();
  s.lights.emplace_back();
  return s;
}

TEST(Scene, BoundsAndCounts) {
  const scene::Scene s = smallScene();
  const Bounds3 bounds = scene::worldBounds(s);
  EXPECT_EQ(bounds.min, vec3(0));
  EXPECT_EQ(bounds.max, vec3(11, 1, 0));
  EXPECT_EQ(scene::countTriangles(s).stored, 1u);
  EXPECT_EQ(scene::countTriangles(s).instanced, 2u);
  EXPECT_TRUE(scene::worldBounds({}).empty());
}

TEST(Scene, BoundsOfTurnedObjectsAreTight) {
  scene::Scene s = smallScene();
  s.instances.resize(1);
  s.instances[0].worldFromObject = glm::rotate(mat4(1.0f), kPi / 4, vec3(0, 0, 1));
  const Bounds3 bounds = scene::worldBounds(s);
  EXPECT_NEAR(bounds.max.y, std::sqrt(0.5f), 1e-6f);  // the turned box would reach 1.41
  EXPECT_NEAR(bounds.min.x, -std::sqrt(0.5f), 1e-6f);
}

TEST(Validate, NamesTheFirstFault) {
  EXPECT_NO_THROW(scene::validate(smallScene()));
  EXPECT_NO_THROW(scene::validate({}));
  const auto faultOf = [](const std::function<void(scene::Scene&)>& change) -> std::string {
    scene::Scene s = smallScene();
    change(s);
    try {
      scene::validate(s);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  const auto geometry = [](scene::Scene& s) -> scene::Geometry& { return s.meshes[0].geometries[0]; };
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).normals.pop_back(); }),
            "scene: meshes[0].geometries[0].normals: 2 elements for 3 vertices");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).uvs[1].resize(4); }),
            "scene: meshes[0].geometries[0].uvs: 4 elements for 3 vertices");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).triangles[0].y = 3; }),
            "scene: meshes[0].geometries[0].triangles[0]: vertex 3 of 3");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).material = 1; }), "scene: meshes[0].geometries[0].material: 1 of 1");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).material = -2; }), "scene: meshes[0].geometries[0].material: -2 of 1");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).fileTriangles.resize(2); }),
            "scene: meshes[0].geometries[0].fileTriangles: 2 for 1 triangles");
  EXPECT_EQ(faultOf([&](auto& s) { geometry(s).positions[1].y = NAN; }),
            "scene: meshes[0].geometries[0].positions[1]: not finite");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[1].mesh = 1; }), "scene: instances[1].mesh: 1 of 1");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[1].worldFromObject[3].x = INFINITY; }),
            "scene: instances[1].worldFromObject: not finite");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[1].worldFromObject = mat4(0.0f); }),
            "scene: instances[1].worldFromObject: no inverse");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[0].mask = 256; }), "scene: instances[0].mask: 256 has more than 8 bits");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[0].flags = 16; }), "scene: instances[0].flags: 16 is unknown");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[0].customIndex = 1 << 24; }),
            "scene: instances[0].customIndex: 16777216 has more than 24 bits");
  EXPECT_EQ(faultOf([](auto& s) { s.instances[0].keyframes.resize(2); }),
            "scene: instances[0].keyframes[1]: frames must ascend");
  EXPECT_EQ(faultOf([](auto& s) {
              s.instances[0].keyframes.resize(2);
              s.instances[0].keyframes[1].frame = 1;
              s.instances[0].keyframes[1].scale.y = -1;
            }),
            "scene: instances[0].keyframes[1]: a scale is 0 or changes its sign");
  EXPECT_EQ(faultOf([](auto& s) { s.meshes[0].primitiveSets.emplace_back(); }),
            "scene: meshes[0]: triangles and primitive sets in one mesh");
  EXPECT_EQ(faultOf([](auto& s) { s.materials[0].normalTexture.texture = 5; }), "scene: materials[0]: texture 5 of 1");
  EXPECT_EQ(faultOf([](auto& s) { s.materials[0].baseColorTexture.uvSet = 2; }),
            "scene: materials[0]: texture coordinate set 2 of 2");
  EXPECT_EQ(faultOf([](auto& s) { s.textures[0].image = -1; }), "scene: textures[0].image: -1 of 1");
  EXPECT_EQ(faultOf([](auto& s) { s.images[0].image.width = 2; }),
            "scene: images[0]: 3 bytes for 2 x 1 pixels of 3 channels");
}

TEST(ContentHash, SeesEveryChangeButNotTheReport) {
  const Hash hash = scene::contentHash(smallScene());
  EXPECT_EQ(hash, scene::contentHash(smallScene()));
  const auto differs = [&](const std::function<void(scene::Scene&)>& change) {
    scene::Scene s = smallScene();
    change(s);
    return scene::contentHash(s) != hash;
  };
  EXPECT_TRUE(differs([](auto& s) { s.meshes[0].geometries[0].positions[0].x = 1e-20f; }));
  EXPECT_TRUE(differs([](auto& s) { s.meshes[0].geometries[0].triangles[0].z = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.instances[0].worldFromObject[1].x = 1e-20f; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].clearcoatNormalScale = 2; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].baseColorTexture.rotation = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.textures[0].sampler.wrapV = scene::Wrap::clampToEdge; }));
  EXPECT_TRUE(differs([](auto& s) { s.images[0].image.data[2] = std::byte{1}; }));
  EXPECT_TRUE(differs([](auto& s) { s.cameras[0].aspect = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.lights[0].range = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.environment.rotation = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.instances.pop_back(); }));
  EXPECT_TRUE(differs([](auto& s) { s.instances[0].mask = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.instances[0].flags = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.instances[0].customIndex = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.instances[0].keyframes.resize(1); }));
  EXPECT_TRUE(differs([](auto& s) { s.meshes[0].primitiveSets.emplace_back(); }));
  EXPECT_FALSE(differs([](auto& s) { s.report.ignored.push_back("x"); }));
  EXPECT_FALSE(differs([](auto& s) { s.name = "other"; }));
  EXPECT_FALSE(differs([](auto& s) { s.images[0].name = "other"; }));
}

TEST(ContentHash, DoesNotDependOnTheContainer) {
  GltfBuilder builder;
  builder.addTriangle();
  EXPECT_EQ(scene::contentHash(loadText(builder.gltf())), scene::contentHash(builder.load()));
}

TEST(DefaultEnvironment, IsNeutralBrightFromAboveAndNotFlat) {
  const scene::Environment sky = scene::defaultEnvironment();
  EXPECT_TRUE(sky.present);
  ASSERT_EQ(sky.image.width, 512u);
  ASSERT_EQ(sky.image.height, 256u);
  ASSERT_EQ(sky.image.channels, 3u);
  glm::dvec3 mean(0), up(0), down(0);
  float highest = 0, lowest = 1e9f;
  glm::uvec2 brightest(0);
  for (std::uint32_t y = 0; y < 256; ++y)
    for (std::uint32_t x = 0; x < 512; ++x) {
      const auto pixel = sky.image.pixel<float>(x, y);
      const double theta = kPi * (y + 0.5) / 256, solidAngle = std::sin(theta) * (kPi / 256) * (2 * kPi / 512);
      const glm::dvec3 radiance(pixel[0], pixel[1], pixel[2]);
      mean += radiance * solidAngle / (4 * glm::pi<double>());
      (y < 128 ? up : down) += radiance * solidAngle * std::abs(std::cos(theta)) / glm::pi<double>();
      lowest = std::min({lowest, pixel[0], pixel[1], pixel[2]});
      if (pixel[1] > highest) highest = pixel[1], brightest = {x, y};
    }
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 1.0, 1e-3);
  EXPECT_GT(up.y, 2.0 * down.y);
  EXPECT_GT(lowest, 0.1f);
  EXPECT_GT(highest, 5.0f);
  // u = atan2(z, x)/2π + 0.5, v = acos(y)/π of the key light's direction
  const vec3 key = glm::normalize(vec3(0.5f, 0.75f, 0.55f));
  EXPECT_NEAR(static_cast<float>(brightest.x) / 512.0f, std::atan2(key.z, key.x) / (2 * kPi) + 0.5f, 0.01f);
  EXPECT_NEAR(static_cast<float>(brightest.y) / 256.0f, std::acos(key.y) / kPi, 0.01f);
}

}  // namespace
}  // namespace quintet::test
