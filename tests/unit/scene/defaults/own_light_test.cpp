// SPDX-License-Identifier: Apache-2.0
// Whether a scene lights itself, so that it needs no environment.
#include "scene/defaults/own_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace quintet::test {
namespace {

using scene::OwnLight;

class OwnLightOf : public testing::Test {
 protected:
  OwnLightOf() {
    scene_.materials.resize(2);
    lamp().emissive = vec3(5.0f);
  }
  scene::Material& wall() { return scene_.materials[0]; }
  scene::Material& lamp() { return scene_.materials[1]; }

  // A rectangle with these three corners, and its front where they are counter-clockwise.
  void addQuad(const vec3& corner, const vec3& edge1, const vec3& edge2, int material) {
    scene::Geometry geometry;
    geometry.positions = {corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
    geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
    geometry.material = material;
    scene::Mesh mesh;
    mesh.geometries.push_back(std::move(geometry));
    scene_.meshes.push_back(std::move(mesh));
    scene::Instance instance;
    instance.mesh = static_cast<int>(scene_.meshes.size()) - 1;
    scene_.instances.push_back(instance);
  }
  // The faces of a cube with edges of length 2 around the origin, whose fronts are inside, or outside.
  void addCube(bool inward, int material, float half = 1.0f) {
    for (int axis = 0; axis < 3; ++axis)
      for (const float side : {-half, half}) {
        vec3 corner(-half), u(0), v(0);
        corner[axis] = side;
        u[(axis + 1) % 3] = 2 * half;
        v[(axis + 2) % 3] = 2 * half;
        if ((side < 0) == inward)
          addQuad(corner, u, v, material);
        else
          addQuad(corner, v, u, material);
      }
  }
  // At the height 0, 64 m² by default.
  void addFloor(float size = 8.0f) {
    wall().metallic = 0.0f;
    addQuad({-size / 2, 0, -size / 2}, {0, 0, size}, {size, 0, 0}, 0);
  }
  // A quad of 1 m x `width` that faces up and has the material `lit`, beside one of the rest of 1 m² that faces down.
  void addTwoSides(float width, int lit) {
    wall().metallic = 0.0f;
    addQuad({0, 0, 0}, {0, 0, 1}, {width, 0, 0}, lit);
    addQuad({2, 0, 0}, {1 - width, 0, 0}, {0, 0, 1}, 0);
  }
  void addLight(const vec3& position, float intensity) {
    scene::Light& light = scene_.lights.emplace_back();
    light.position = position;
    light.intensity = vec3(intensity);
  }
  void addSun(const vec3& direction, float irradiance) {
    scene::Light& light = scene_.lights.emplace_back();
    light.type = scene::LightType::directional;
    light.direction = direction;
    light.intensity = vec3(irradiance);
  }
  void addLamp(float y, float size) { addQuad({-size / 2, y, -size / 2}, {size, 0, 0}, {0, 0, size}, 1); }

  scene::Scene scene_;
};

TEST_F(OwnLightOf, SceneWithoutLightsIsNone) {
  lamp().emissive = vec3(0);
  addCube(true, 0);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::none);
}

TEST_F(OwnLightOf, RoomWithALampIsEmission) {
  addCube(true, 0);
  addLamp(0.9f, 0.5f);
  lamp().emissive = vec3(20.0f);            // with 5, the edges of the room are darker than kLitRadiance
  EXPECT_GT(scene::litShare(scene_), 0.7);  // not most of the ceiling, which is behind the lamp
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::emission);
}

TEST_F(OwnLightOf, ModelWithAnEmissivePartIsFaint) {
  addCube(false, 0);
  addLamp(1.01f, 1.9f);  // a display of a twelfth of the surface, which lights nothing else
  EXPECT_NEAR(scene::litShare(scene_), 1.9 * 1.9 / (1.9 * 1.9 + 24.0), 0.03);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
}

TEST_F(OwnLightOf, WeakLampOfARoomIsFaint) {
  addCube(true, 0);
  addLamp(0.9f, 0.5f);
  lamp().emissive = vec3(0.1f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
}

// The irradiance below a small lamp is L·A·cos⁴/h². A white surface has a radiance of 0.05 where it is 0.05π.
TEST_F(OwnLightOf, ShareIsThatOfTheClosedForm) {
  addQuad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, 0);
  addLamp(1.0f, 0.1f);
  lamp().emissive = vec3(100.0f);
  // cos⁴ = 0.05π at the distance r with 1/(1 + r²)² = 0.05π; the disk has the area πr².
  const double square = 1.0 / std::sqrt(0.05 * glm::pi<double>()) - 1.0;
  EXPECT_NEAR(scene::litShare(scene_), glm::pi<double>() * square / 64.0, 0.02);
}

TEST_F(OwnLightOf, LampInAClosedShadeLightsOnlyTheInside) {
  addCube(false, 0);        // the outside of the shade
  addCube(true, 0, 0.99f);  // its inside
  addLamp(0.0f, 0.5f);
  lamp().emissive = vec3(20.0f);  // enough for the walls beside its edge
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.05);
  wall().transmission = 1.0f;  // glass casts no shadow, but the outside is on the other side of the faces
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.05);
}

TEST_F(OwnLightOf, ShadowsCount) {
  const auto share = [&] { return scene::litShare(scene_); };
  addQuad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  addLamp(1.0f, 1.0f);
  lamp().emissive = vec3(200.0f);
  EXPECT_GT(share(), 0.95);
  addQuad({-2, 0.5f, -2}, {0, 0, 4}, {4, 0, 0}, 0);  // a table of four times the area below the lamp
  const double lit = (16.0 + 1.0) / (16.0 + 4.0 + 1.0);
  EXPECT_NEAR(share(), lit, 0.03);
  scene_.instances[2].mask = 0;
  EXPECT_GT(share(), 0.95) << "hidden";
}

TEST_F(OwnLightOf, TransformsCount) {
  addCube(false, 0);
  addLamp(0.0f, 0.5f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
  for (std::size_t i = 0; i < 6; ++i) scene_.instances[i].worldFromObject = glm::scale(mat4(1.0f), vec3(1, 1, -1));
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint) << "a mirrored model has its front outside, too";
  for (std::size_t i = 0; i < 6; ++i) scene_.instances[i].worldFromObject = glm::translate(mat4(1.0f), vec3(0, 2, 0));
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
}

TEST_F(OwnLightOf, EmissionWithATextureDoesNotCount) {
  addCube(true, 0);
  addLamp(0.9f, 0.5f);
  lamp().emissive = vec3(20.0f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::emission);
  lamp().emissiveTexture.texture = 0;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
  lamp().emissiveTexture = {};
  lamp().unlit = true;  // shows its base color only
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
}

TEST_F(OwnLightOf, SurfacesCountFromARadianceOfATwentieth) {
  addFloor();
  addSun({0, -1, 0}, 0.0499f * glm::pi<float>());
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  scene_.lights[0].intensity = vec3(0.0501f * glm::pi<float>());
  EXPECT_EQ(scene::litShare(scene_), 1.0);
  scene_.lights.clear();
  wall().emissive = vec3(0.0499f);
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  wall().emissive = vec3(0.0501f);
  EXPECT_EQ(scene::litShare(scene_), 1.0);
}

// The points of the estimate are equidistant in the area, so the share is exact to 1/256.
TEST_F(OwnLightOf, EmissionMustLightHalfOfTheScene) {
  for (const float lit : {0.49f, 0.5f, 0.51f}) {
    scene_.meshes.clear(), scene_.instances.clear();
    addTwoSides(lit, 1);
    EXPECT_NEAR(scene::litShare(scene_), lit, 1.0 / 256.0);
    EXPECT_EQ(scene::ownLight(scene_), lit < 0.5f ? OwnLight::faint : OwnLight::emission) << lit;
  }
}

TEST_F(OwnLightOf, PunctualLightsMustLightAFifthOfTheScene) {
  addSun({0, -1, 0}, 1.0f);
  for (const float lit : {0.19f, 0.21f}) {
    scene_.meshes.clear(), scene_.instances.clear();
    addTwoSides(lit, 0);
    EXPECT_NEAR(scene::litShare(scene_), lit, 1.0 / 256.0);
    EXPECT_EQ(scene::ownLight(scene_), lit < 0.2f ? OwnLight::faint : OwnLight::punctual) << lit;
  }
}

TEST_F(OwnLightOf, PunctualLightCountsIfItShines) {
  addFloor();
  addLight({0, 1, 0}, 0.0f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::none);
  scene_.lights[0].intensity = vec3(0.1f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint) << "the floor below it has a radiance of 0.03";
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  scene_.lights[0].intensity = vec3(10.0f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
}

// The sun lights three of six faces. The default environment would flood what its author has left dark.
TEST_F(OwnLightOf, SunOnOneSideLightsAModel) {
  addCube(false, 0);
  addSun(glm::normalize(vec3(-1, -1, -1)), 1.0f);
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.03);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
  addCube(false, 0, 20.0f);  // a hall that shuts the sun out: 1,600 times the area of the model
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.03) << "the outside of the hall";
  scene_.lights[0].direction = -scene_.lights[0].direction;
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.03);
}

// The irradiance of I/(h² + r²) · cos is I·h/(h² + r²)^1.5, and the radiance ρ/π of it.
TEST_F(OwnLightOf, ShareOfAPointLightIsThatOfTheClosedForm) {
  addFloor();
  addLight({0, 1, 0}, 3.0f);
  const auto lit = [](double intensity, double reflectance) {
    const double square = std::pow(reflectance * intensity / (0.05 * glm::pi<double>()), 2.0 / 3.0) - 1.0;
    return square > 0.0 ? glm::pi<double>() * square / 64.0 : 0.0;
  };
  EXPECT_NEAR(scene::litShare(scene_), lit(3.0, 1.0), 0.02);
  wall().baseColor = vec4(0.2f, 0.2f, 0.2f, 1);
  EXPECT_NEAR(scene::litShare(scene_), lit(3.0, 0.2), 0.02);
  scene_.lights[0].range = 1.2f;
  wall().baseColor = vec4(1);
  EXPECT_NEAR(scene::litShare(scene_), glm::pi<double>() * 0.44 / 64.0, 0.01) << "a disk within the range";
  scene_.lights[0].range = std::numeric_limits<float>::infinity();
  scene_.lights[0].type = scene::LightType::spot;
  scene_.lights[0].direction = {0, -1, 0};
  scene_.lights[0].outerConeAngle = scene_.lights[0].innerConeAngle = glm::radians(45.0f);
  EXPECT_NEAR(scene::litShare(scene_), glm::pi<double>() / 64.0, 0.01) << "the disk of the cone";
  addLight({0, -1, 0}, 1000.0f);
  EXPECT_NEAR(scene::litShare(scene_), glm::pi<double>() / 64.0, 0.01) << "a light behind the floor";
}

// A lamp at the height 1 whose intensity falls from the axis of the cone to 60°, by the square of 2 · cos - 1. At a cosine of 3/4,
// this is 1/4, and the irradiance I/4 · cos³.
TEST_F(OwnLightOf, SpotLightsFadeTowardTheEdgeOfTheirCone) {
  addFloor(2.5f);
  addLight({0, 1, 0}, static_cast<float>(0.05 * glm::pi<double>() * 4.0 / std::pow(0.75, 3.0)));
  scene_.lights[0].type = scene::LightType::spot;
  scene_.lights[0].direction = {0, -1, 0};
  scene_.lights[0].innerConeAngle = 0.0f;
  scene_.lights[0].outerConeAngle = glm::radians(60.0f);
  const double square = 1.0 / (0.75 * 0.75) - 1.0;  // of the radius of the lit disk
  EXPECT_NEAR(scene::litShare(scene_), glm::pi<double>() * square / 6.25, 0.03);
}

TEST_F(OwnLightOf, TheStrongestOfManyPunctualLightsCount) {
  addFloor();
  for (int i = 0; i < 40; ++i) addSun({0, -1, 0}, i == 20 ? 1.0f : 1e-4f);
  EXPECT_EQ(scene::litShare(scene_), 1.0);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
  const auto shareBy = [&](double count) {  // if a radiance of 0.05 needs this number of the 40 equal lights
    for (scene::Light& light : scene_.lights)
      light.intensity = vec3(static_cast<float>(0.05 * glm::pi<double>() / count));
    return scene::litShare(scene_);
  };
  EXPECT_EQ(shareBy(15.5), 1.0) << "16 lights are more";
  EXPECT_EQ(shareBy(16.5), 0.0) << "16 lights are less";
}

// 25 lamps, each of which lights a disk with a radius of 0.5. Everywhere else, they are behind the edge of their cone.
TEST_F(OwnLightOf, TheStrongestPunctualLightsAreThoseOfEachPoint) {
  addFloor();
  for (int i = 0; i < 25; ++i) {
    const int column = i % 5 - 2, row = i / 5 - 2;
    addLight({1.6f * static_cast<float>(column), 0.5f, 1.6f * static_cast<float>(row)}, 100.0f + static_cast<float>(i));
    scene_.lights.back().type = scene::LightType::spot;
    scene_.lights.back().direction = {0, -1, 0};
    scene_.lights.back().outerConeAngle = scene_.lights.back().innerConeAngle = glm::radians(45.0f);
  }
  EXPECT_NEAR(scene::litShare(scene_), 25.0 * glm::pi<double>() * 0.25 / 64.0, 0.04);  // with 16 of them, 0.11 less
}

// Whether a double-sided surface shows its front or its back is random.
TEST_F(OwnLightOf, DoubleSidedSurfacesCountOnARandomSide) {
  addFloor();
  addSun({0, -1, 0}, 1.0f);
  wall().doubleSided = true;
  EXPECT_EQ(scene::litShare(scene_), 0.5);
  scene_.lights[0].direction = {0, 1, 0};
  EXPECT_EQ(scene::litShare(scene_), 0.5);
  scene_.lights.clear();
  addLamp(1.0f, 1.0f);
  lamp().emissive = vec3(1000.0f);
  EXPECT_NEAR(scene::litShare(scene_), (0.5 * 64.0 + 1.0) / 65.0, 0.01);
}

// A mirror shows nothing of a point; the rougher it is, the more.
TEST_F(OwnLightOf, MetalsAndGlassNeedMoreThanAPunctualLight) {
  addFloor();
  addSun({0, -1, 0}, 3.0f);
  const auto light = [&] { return scene::ownLight(scene_); };
  EXPECT_EQ(light(), OwnLight::punctual);
  wall().metallic = 1.0f;
  wall().roughness = 0.1f;
  EXPECT_EQ(light(), OwnLight::faint);
  wall().roughness = 0.8f;
  EXPECT_EQ(light(), OwnLight::punctual);
  wall().roughness = 0.1f;
  wall().metallicRoughnessTexture.texture = 0;
  EXPECT_EQ(light(), OwnLight::punctual) << "unknown, so that it is not taken for a metal";
  wall() = scene::Material{};
  wall().metallic = 0.0f;
  wall().transmission = 1.0f;
  EXPECT_EQ(light(), OwnLight::faint);
  wall().transmissionTexture.texture = 0;
  EXPECT_EQ(light(), OwnLight::punctual) << "unknown, so that it is not taken for glass";
}

TEST_F(OwnLightOf, ShadowsOfPunctualLightsCount) {
  addFloor();
  addSun({0, -1, 0}, 3.0f);
  addQuad({-4, 1, -4}, {8, 0, 0}, {0, 0, 8}, 0);  // a ceiling that faces the floor
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
  scene_.instances[1].mask = 0;
  EXPECT_EQ(scene::litShare(scene_), 1.0) << "hidden";
}

TEST_F(OwnLightOf, PunctualLightsAddToEachOtherAndToEmission) {
  addFloor();
  addSun({0, -1, 0}, 0.12f);  // a radiance of 0.038
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  addSun(glm::normalize(vec3(0.2f, -1, 0)), 0.12f);
  EXPECT_EQ(scene::litShare(scene_), 1.0) << "two suns";
  scene_.lights.resize(1);
  addQuad({-4, 1, -4}, {8, 0, 0}, {0, 0, 8}, 1);  // a ceiling of clear foil, which faces the floor
  lamp().alphaMode = scene::AlphaMode::blend;
  lamp().emissive = vec3(0.03f);  // less than 0.05 on the floor below
  EXPECT_NEAR(scene::litShare(scene_), 0.5, 0.1) << "the floor without its edge, by the sun and the ceiling";
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
  scene_.lights.clear();
  EXPECT_LT(scene::litShare(scene_), 0.01) << "the ceiling alone";
}

TEST_F(OwnLightOf, AnimatedLightsAndThoseOfSolidsCountWithoutAnEstimate) {
  addFloor();
  addLight({0, 1000, 0}, 1.0f);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
  scene_.lights[0].node = 0;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
  scene_.lights[0].node = scene::kNone;
  scene_.meshes[0].primitiveSets.emplace_back();
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::punctual);
}

TEST_F(OwnLightOf, EmissiveSolidCounts) {
  scene::PrimitiveSet set;
  set.primitives.emplace_back().material = 1;
  scene::Mesh mesh;
  mesh.primitiveSets.push_back(set);
  scene_.meshes.push_back(mesh);
  scene_.instances.emplace_back().mesh = 0;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::emission);
  scene_.instances[0].mask = 0;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::none) << "hidden";
  scene_.instances[0].mask = 0xFF;
  scene_.meshes[0].primitiveSets[0].primitives[0].material = 0;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::none);
  scene_.meshes[0].primitiveSets[0].material = 1;
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::emission) << "the material of the set";
}

TEST_F(OwnLightOf, DegenerateSurfacesAreNotCounted) {
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  addLamp(0.0f, 0.0f);
  EXPECT_EQ(scene::litShare(scene_), 0.0);
  EXPECT_EQ(scene::ownLight(scene_), OwnLight::faint);
}

}  // namespace
}  // namespace quintet::test
