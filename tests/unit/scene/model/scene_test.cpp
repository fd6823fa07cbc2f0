// SPDX-License-Identifier: Apache-2.0
// Bounds, counts, validation and content hash of a scene.
#include "scene/model/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"
#include "scene/model/content_hash.h"
#include "scene/model/mesh_bounds.h"
#include "scene/model/validate.h"

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

TEST(Scene, ComputesBoundsAndCounts) {
  const scene::Scene s = smallScene();
  const Bounds3 bounds = scene::worldBounds(s);
  EXPECT_EQ(bounds.min, vec3(0));
  EXPECT_EQ(bounds.max, vec3(11, 1, 0));
  EXPECT_EQ(scene::countTriangles(s).stored, 1u);
  EXPECT_EQ(scene::countTriangles(s).instanced, 2u);
  EXPECT_TRUE(scene::worldBounds({}).empty());
}

TEST(Scene, ComputesTightBoundsOfRotatedObjects) {
  scene::Scene s = smallScene();
  s.instances.resize(1);
  s.instances[0].worldFromObject = glm::rotate(mat4(1.0f), kPi / 4, vec3(0, 0, 1));
  const Bounds3 bounds = scene::worldBounds(s);
  EXPECT_NEAR(bounds.max.y, std::sqrt(0.5f), 1e-6f);  // the bounds of the rotated box would be 1.41
  EXPECT_NEAR(bounds.min.x, -std::sqrt(0.5f), 1e-6f);
}

// Vertices that are not visible: without a triangle, and of triangles without area.
TEST(Scene, BoundsCountOnlyVerticesOfTrianglesWithArea) {
  scene::Scene s = smallScene();
  scene::Geometry& g = s.meshes[0].geometries[0];
  g.positions.insert(g.positions.end(), {{1000, 0, 0}, {0, 1000, 0}, {0, 0, -1000}, {1, 0, -1000}, {2, 0, -1000}});
  g.triangles.insert(g.triangles.end(), {{4, 4, 0}, {5, 6, 7}});
  g.normals.assign(g.positions.size(), vec3(0, 0, 1));
  EXPECT_EQ(scene::worldBounds(s).min, vec3(0));
  EXPECT_EQ(scene::worldBounds(s).max, vec3(11, 1, 0));
  EXPECT_EQ(scene::meshBounds(s.meshes[0], mat4(2.0f)).max, vec3(2, 2, 0));
  g.triangles.push_back({0, 3, 1});  // on a line with the edge of the triangle
  EXPECT_EQ(scene::worldBounds(s).max.x, 11.0f);
  g.triangles.push_back({0, 3, 2});
  EXPECT_EQ(scene::worldBounds(s).max.x, 1010.0f);
  g.triangles.resize(3);
  g.triangles.erase(g.triangles.begin());
  EXPECT_TRUE(scene::worldBounds(s).empty());
}

TEST(Validate, ReportsTheFirstError) {
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
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).normals.pop_back(); }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].normals", "2 elements"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).colors.resize(1); }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].colors", "1 element for 3 vertices"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).uvs[1].resize(4); }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].uvs", "4 elements"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).triangles[0].y = 3; }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].triangles[0]", "vertex 3"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).material = 1; }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].material", "1 of 1"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).material = -2; }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].material", "-2 of 1"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).fileTriangles.resize(2); }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].fileTriangles", "2 for 1"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).positions[1].y = NAN; }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].positions[1]", "not finite"));
  EXPECT_THAT(faultOf([&](auto& s) { geometry(s).positions[1].y = 1e19f; }),
              IsErrorAt("scene: meshes[0] 'mesh'.geometries[0].positions[1]", "above 1e+18"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[1].worldFromObject[0].x = 1e19f; }),
              IsErrorAt("scene: instances[1] 'b'.worldFromObject", "above 1e+18"));
  EXPECT_THAT(faultOf([](auto& s) { s.lights[0].position.x = -1e30f; }), IsErrorAt("scene: lights[0]", "above 1e+18"));
  EXPECT_THAT(faultOf([](auto& s) { s.lights[0].intensity.x = 1e13f; }), IsErrorAt("scene: lights[0]", "1e+12"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].emissive.x = 1e13f; }),
              IsErrorAt("scene: materials[0].emissive", "1e+12"));
  EXPECT_THAT(faultOf([](auto& s) { s.environment.constant.x = INFINITY; }), IsErrorAt("scene: environment", "1e+12"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[1].mesh = 1; }), IsErrorAt("scene: instances[1] 'b'.mesh", "1 of 1"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[1].worldFromObject[3].x = INFINITY; }),
              IsErrorAt("scene: instances[1] 'b'.worldFromObject", "not finite"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[1].worldFromObject = mat4(0.0f); }),
              IsErrorAt("scene: instances[1] 'b'.worldFromObject", "singular"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[0].mask = 256; }), IsErrorAt("scene: instances[0] 'a'.mask", "8 bits"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[0].flags = 16; }), IsErrorAt("scene: instances[0] 'a'.flags", "16"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[0].customIndex = 1 << 24; }),
              IsErrorAt("scene: instances[0] 'a'.customIndex", "24 bits"));
  EXPECT_THAT(faultOf([](auto& s) { s.instances[0].keyframes.resize(2); }),
              IsErrorAt("scene: instances[0] 'a'.keyframes[1]", "frames"));
  EXPECT_THAT(faultOf([](auto& s) {
                s.instances[0].keyframes.resize(2);
                s.instances[0].keyframes[1].frame = 1;
                s.instances[0].keyframes[1].scale.y = -1;
              }),
              IsErrorAt("scene: instances[0] 'a'.keyframes[1]", "scale"));
  EXPECT_THAT(faultOf([](auto& s) { s.meshes[0].primitiveSets.emplace_back(); }),
              IsErrorAt("scene: meshes[0] 'mesh'", "primitive sets"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].normalTexture.texture = 5; }),
              IsErrorAt("scene: materials[0]", "texture 5"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].baseColorTexture.uvSet = 2; }),
              IsErrorAt("scene: materials[0]", "texture coordinate set 2"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].baseColorTexture.rotation = NAN; }),
              IsErrorAt("scene: materials[0]", "texture 0 is not finite"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].normalScale = INFINITY; }),
              IsErrorAt("scene: materials[0].normalScale", "not finite"));
  EXPECT_THAT(faultOf([](auto& s) { s.materials[0].alphaCutoff = NAN; }),
              IsErrorAt("scene: materials[0].alphaCutoff", "not finite"));
  const auto spot = [](float inner, float outer) {
    return [=](scene::Scene& s) {
      s.lights[0].type = scene::LightType::spot;
      s.lights[0].innerConeAngle = glm::radians(inner);
      s.lights[0].outerConeAngle = glm::radians(outer);
    };
  };
  EXPECT_EQ(faultOf(spot(90, 90)), "none");
  EXPECT_THAT(faultOf(spot(50, 45)), IsErrorAt("scene: lights[0]", "not 50 and 45"));
  EXPECT_THAT(faultOf(spot(-1, 45)), IsErrorAt("scene: lights[0]", "not -1 and 45"));
  EXPECT_THAT(faultOf(spot(0, 91)), IsErrorAt("scene: lights[0]", "not 0 and 91"));
  EXPECT_THAT(faultOf(spot(NAN, 45)), IsErrorAt("scene: lights[0]", "not nan and 45"));
  EXPECT_THAT(faultOf([](auto& s) { s.textures[0].image = -1; }),
              IsErrorAt("scene: textures[0] 'texture'.image", "-1 of 1"));
  EXPECT_THAT(faultOf([](auto& s) { s.images[0].image.width = 2; }), IsErrorAt("scene: images[0]", "3 bytes"));
}

TEST(ContentHash, DependsOnTheContentButNotTheReport) {
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
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].sheenColor.x = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].sheenRoughness = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].diffuseTransmission = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].anisotropy = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].anisotropyRotation = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].iridescence = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].iridescenceIor = 2; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].iridescenceThicknessMinimum = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].iridescenceThicknessMaximum = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].dispersion = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].dielectricPriority = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].multiscatterColor.y = 1; }));
  EXPECT_TRUE(differs([](auto& s) { s.materials[0].scatterAnisotropy = 0.5f; }));
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

TEST(ContentHash, IsIndependentOfTheContainer) {
  GltfBuilder builder;
  builder.addTriangle();
  EXPECT_EQ(scene::contentHash(loadText(builder.gltf())), scene::contentHash(builder.load()));
}

}  // namespace
}  // namespace quintet::test
