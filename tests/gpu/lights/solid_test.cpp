// SPDX-License-Identifier: Apache-2.0
// Emissive solids: solid angles in closed form, irradiance of balls, power of the table.
#include <array>

#include <gtest/gtest.h>

#include "lights/light_scene.h"

namespace quintet::test {
namespace {

using glm::dvec3;
using scene::PrimitiveType;

constexpr std::size_t kSolidSamples = 200'000;
constexpr std::array kLightTypes{PrimitiveType::sphere, PrimitiveType::box, PrimitiveType::cylinder,
                                 PrimitiveType::cone, PrimitiveType::torus};

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
  return estimate(sampleLights(scene, position, kSolidSamples),
                  [](const LightOut& s) { return s.valid ? 1.0 / s.pdf : 0.0; });
}

// From inside, a closed convex surface is all around.
TEST(SolidLamp, FillsTheSphereFromInside) {
  for (const PrimitiveType type : kLightTypes) {
    if (type == PrimitiveType::torus) continue;
    for (const mat4& m : {mat4(1.0f), stretched()}) {
      const LightScene scene(emissiveSolid(type, m, glm::translate(mat4(1.0f), vec3(5, 0, 0))), {});
      const vec3 inside = vec3(m * vec4(0.1f, -0.2f, 0.05f, 1.0f)) + vec3(5, 0, 0);
      EXPECT_GT(pValue(solidAngle(scene, inside), 4.0 * kPiDouble), sidak(0.01, 8)) << static_cast<int>(type);
    }
  }
}

// A solid, seen from one place: one uniform direction against all its crossings, and one light sample of it.
struct LightSolid {
  vec3 from;
  std::uint32_t light;
};
struct Seen {
  float density;    // over the chance of the direction: of hits at the crossings, as they are weighed, summed
  float crossings;  // over that chance: how many the sampler can draw
  float drawn;      // 1/pdf of the light sample
};

const std::string kSee = R"(
  #include <quintet/lights/lights.glsl>
  #include <quintet/procedural/crossings.glsl>
  #include <quintet/sampling/pcg.glsl>
  struct In { vec3 from; uint light; };
  struct Out { float density; float crossings; float drawn; };
  Out run(uint i, In value) {
    Sampler rng = makeSampler(uvec2(5u), i, 3u);
    const LightData light = LightArray(frame.lights).at[value.light];
    const InstanceData instance = InstanceArray(frame.instances).at[light.instance];
    const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + light.geometry];
    const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[light.primitive];
    const mat3 m = worldFromPrimitive(instance, primitive);
    const vec3 direction = sampleSphere(next2D(rng));
    const vec3 origin = rowsTimesPoint(instance.objectFromWorld, value.from);
    const vec3 along = rowsTimesVector(instance.objectFromWorld, direction);
    const vec4 crossings = primitiveCrossings(primitive, origin, along);
    const vec3 d = primitiveVector(primitive.primitiveFromObject, along);
    Out sum = Out(0.0, 0.0, 0.0);
    for (int k = 0; k < 4; ++k) {
      if (crossings[k] <= 0.0 || crossings[k] >= kInfinity) continue;
      const bool front = k % 2 == 0;
      const vec3 p = primitivePoint(primitive.primitiveFromObject, origin) + crossings[k] * d;
      const uint face = nearestFace(primitive.type, p, d, front);
      HitPayload hit;
      hit.instance = light.instance;
      hit.geometry = light.geometry;
      hit.primitive = light.primitive;
      hit.barycentric = pointCoordinates(primitive.type, face, p);
      hit.part = light.primitive | face << kPartFaceShift | (front ? kPartFront : 0u);
      const vec3 n = areaVector(m, solidPoint(primitive.type, primitive.parameter, face, hit.barycentric).normal);
      const float pdf = pdfLightPoint(hit, value.from, crossings[k], abs(dot(direction, normalize(n))));
      sum.density += 4.0 * kPi * pdf;
      sum.crossings += pdf > 0.0 ? 4.0 * kPi : 0.0;
    }
    LightSample s;
    if (sampleSolidLight(light, value.from, next2D(rng), s)) sum.drawn = 1.0 / s.pdf;
    return sum;
  }
)";

// Every shape, also where no solid angle is known in closed form: what hits are weighed with integrates to 1, and so do
// the light samples' own densities over the directions in which there is something, as often as there is.
TEST(SolidLamp, DensitiesIntegrateToOne) {
  scene::Scene source = emissiveSolid(PrimitiveType::sphere, mat4(1.0f));
  source.meshes.clear();
  source.instances.clear();
  std::vector<LightSolid> cases;
  for (const PrimitiveType type : kLightTypes) {
    for (const mat4& m : {stretched(), glm::scale(mat4(1.0f), vec3(0.7f))}) {
      const mat4 place = glm::translate(mat4(1.0f), vec3(source.instances.size(), 0, 0));
      const scene::Scene one = emissiveSolid(type, m, place);
      source.meshes.push_back(one.meshes[0]);
      source.instances.push_back(one.instances[0]);
      source.instances.back().mesh = static_cast<int>(source.meshes.size()) - 1;
      // Outside, inside (of a torus: in its tube), and close above.
      const float torusX = type == PrimitiveType::torus ? 1.0f : 0.1f;
      for (const vec3& p : {vec3(-2.0f, 0.8f, 1.5f), vec3(torusX, -0.1f, 0.05f), vec3(0.2f, 1.3f, -0.3f)})
        cases.push_back({vec3(place * m * vec4(p, 1.0f)), static_cast<std::uint32_t>(source.instances.size()) - 1});
    }
  }
  const LightScene scene(source, {});
  for (LightSolid& c : cases) {  // the second solid of the instance: the first is dark
    const auto first = std::ranges::find(scene.table.lights, c.light, &shared::LightData::instance);
    c.light = static_cast<std::uint32_t>(first - scene.table.lights.begin()) + 1;
  }

  const std::vector<Seen> seen = runCompute<Seen>(kSee, cases, kSolidSamples * cases.size(), scene.options());
  const auto tests = 2 * cases.size();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "type " << i / 6 << (i % 6 < 3 ? ", stretched, " : ", round, ") << "case "
                                    << i % 3);
    std::vector<Seen> own;
    for (std::size_t k = i; k < seen.size(); k += cases.size()) own.push_back(seen[k]);
    const Estimate density = estimate(own, [](const Seen& s) { return s.density; });
    EXPECT_GT(pValue(density, 1.0), sidak(0.01, tests)) << density.mean;
    const Estimate angle = estimate(own, [](const Seen& s) { return s.crossings; });
    Estimate drawn = estimate(own, [](const Seen& s) { return s.drawn; });
    drawn.error = std::hypot(drawn.error, angle.error);
    EXPECT_GT(angle.mean, 0.1);
    EXPECT_GT(pValue(drawn, angle.mean), sidak(0.01, tests)) << drawn.mean << " instead of " << angle.mean;
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
