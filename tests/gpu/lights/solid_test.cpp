// Emissive solids: solid angles in closed form, irradiance of balls, power of the table.
#include <array>

#include <gtest/gtest.h>

#include "lights/light_scene.h"

namespace quintet::test {
namespace {

using glm::dvec3;
using scene::PrimitiveType;

constexpr std::size_t kSamples = 200'000;
constexpr std::array kTypes{PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder, PrimitiveType::cone,
                            PrimitiveType::torus};

scene::Scene emissiveSolid(PrimitiveType type, const mat4& objectFromPrimitive,
                           const mat4& worldFromObject = mat4(1.0f)) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emissive = vec3(1.0f);
  scene::PrimitiveSet set;
  scene::Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = objectFromPrimitive;
  primitive.parameter = 0.3f;
  set.primitives.push_back(primitive);  // dark: one that is never drawn
  primitive.material = 0;
  set.primitives.push_back(primitive);
  scene.meshes.emplace_back().primitiveSets = {set};
  scene.instances.resize(1);
  scene.instances[0].mesh = 0;
  scene.instances[0].worldFromObject = worldFromObject;
  return scene;
}

mat4 stretched() {
  const mat4 turn = glm::rotate(mat4(1.0f), 1.1f, glm::normalize(vec3(1, 0.4f, -0.3f)));
  return glm::translate(mat4(1.0f), vec3(0.3f, 2.0f, -0.4f)) * turn * glm::scale(mat4(1.0f), vec3(-1.5f, 0.5f, 0.8f)) *
         glm::transpose(turn);
}

// Mean of 1/pdf: the solid angle of all of the surface, near and far side each for itself.
Estimate solidAngle(const LightScene& scene, const vec3& position) {
  return estimate(sampleLights(scene, position, kSamples),
                  [](const LightOut& s) { return s.valid ? 1.0 / s.pdf : 0.0; });
}

// From inside, a closed convex surface is all around.
TEST(SolidLamp, FillsTheSphereFromInside) {
  for (const PrimitiveType type : kTypes) {
    if (type == PrimitiveType::torus) continue;
    for (const mat4& m : {mat4(1.0f), stretched()}) {
      const LightScene scene(emissiveSolid(type, m, glm::translate(mat4(1.0f), vec3(5, 0, 0))), {});
      const vec3 inside = vec3(m * vec4(0.1f, -0.2f, 0.05f, 1.0f)) + vec3(5, 0, 0);
      EXPECT_GT(pValue(solidAngle(scene, inside), 4.0 * kPiDouble), sidak(0.01, 8)) << static_cast<int>(type);
    }
  }
}

// From outside a box shows three faces, and hides as many: 2 Ω, by van Oosterom & Strackee (1983) for each triangle.
TEST(SolidLamp, BoxesFromOutside) {
  const mat4 m = stretched();
  const LightScene scene(emissiveSolid(PrimitiveType::box, m), {});
  for (const vec3& p : {vec3(0.0f), vec3(3, 1, 2), vec3(-30, 4, 1)}) {
    double exact = 0.0;
    for (int face = 0; face < 6; ++face) {
      std::array<dvec3, 4> corners;
      for (int k = 0; k < 4; ++k) {
        vec3 c;
        c[face / 2] = face % 2 ? 1.0f : -1.0f;
        c[(face / 2 + 1) % 3] = k == 0 || k == 3 ? -1.0f : 1.0f;
        c[(face / 2 + 2) % 3] = k < 2 ? -1.0f : 1.0f;
        corners[static_cast<std::size_t>(k)] = glm::normalize(dvec3(vec3(m * vec4(c, 1.0f))) - dvec3(p));
      }
      for (const auto& [a, b, c] :
           {std::array{corners[0], corners[1], corners[2]}, std::array{corners[0], corners[2], corners[3]}})
        exact += 2.0 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                                  1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    }
    EXPECT_GT(pValue(solidAngle(scene, p), exact), sidak(0.01, 3));
  }
}

// A ball is drawn in its cone: every sample has the density 1/Ω, is on the near side, and lies on the ball.
TEST(SolidLamp, BallsFromOutside) {
  const float radius = 0.5f;
  const vec3 center(5, 1, -2);
  const mat4 turn = glm::rotate(mat4(1.0f), 1.1f, glm::normalize(vec3(1, 0.4f, -0.3f)));
  const LightScene scene(
      emissiveSolid(PrimitiveType::sphere,
                    glm::translate(mat4(1.0f), vec3(0, 1, 0)) * turn * glm::scale(mat4(1.0f), vec3(radius)),
                    glm::translate(mat4(1.0f), vec3(5, 0, -2)) * glm::scale(mat4(1.0f), vec3(1, 1, -1))),
      {});
  for (const vec3& p : {vec3(0.0f), center + vec3(0, 0.5001f, 0), center + vec3(0, -0.7f, 0.2f), vec3(4000, 100, 50)}) {
    const double distance = glm::length(dvec3(p) - dvec3(center)), sine = radius / distance;
    const double exact = 2.0 * kPiDouble * sine * sine / (1.0 + std::sqrt(1.0 - sine * sine));
    dvec3 mean(0.0);
    for (const LightOut& s : sampleLights(scene, p, 20'000)) {
      ASSERT_TRUE(s.valid);
      EXPECT_NEAR(s.pdf * exact, 1.0, 2e-3);
      EXPECT_NEAR(glm::length(dvec3(s.point) - dvec3(center)), radius, 1e-5);
      EXPECT_LE(s.distance, std::sqrt(distance * distance - radius * radius) * 1.0001 + 1e-4);
      mean += dvec3(s.wi) / 20'000.0;
    }
    const dvec3 axis = glm::normalize(dvec3(center) - dvec3(p));
    EXPECT_NEAR(glm::dot(mean, axis), 0.5 * (1.0 + std::sqrt(1.0 - sine * sine)), 5e-3);
    EXPECT_NEAR(glm::length(mean - axis * glm::dot(mean, axis)), 0.0, 0.02);
  }
}

// Alpha dims what it leaves open, but not on an instance that is forced to be opaque.
TEST(SolidLamp, AlphaOfTheEmitter) {
  scene::Scene source = emissiveSolid(PrimitiveType::cylinder, stretched());
  source.materials[0].alphaMode = scene::AlphaMode::blend;
  source.materials[0].baseColor.a = 0.25f;
  for (const std::uint32_t flags : {0u, scene::kInstanceForceOpaque}) {
    source.instances[0].flags = flags;
    const LightScene scene(source, {});
    for (const LightOut& s : sampleLights(scene, vec3(0.0f), 1000)) {
      ASSERT_TRUE(s.valid);
      EXPECT_EQ(s.radiance, vec3(flags == 0 ? 0.25f : 1.0f));
    }
  }
}

}  // namespace
}  // namespace quintet::test
