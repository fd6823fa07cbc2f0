// SPDX-License-Identifier: Apache-2.0
// Emissive triangles: solid angle, irradiance in closed form, textures, alpha, and densities of BSDF hits.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "lights/light_scene.h"
#include "render/scene_builder.h"

namespace quintet::test {
namespace {

constexpr std::size_t kTriangleSamples = 200'000;
const Defines kWrong{{"QUINTET_WRONG_TRIANGLE_PDF", "1"}};

using glm::dvec3;

// A. van Oosterom & J. Strackee, "The Solid Angle of a Plane Triangle" (1983), equation 8.
double triangleSolidAngle(dvec3 a, dvec3 b, dvec3 c) {
  a = glm::normalize(a), b = glm::normalize(b), c = glm::normalize(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
  return 2.0 * std::atan2(volume, 1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

// Lambert's formula (1760): irradiance of a polygon of radiance 1 that lies above the horizon, seen from the origin.
double polygonIrradiance(const std::vector<dvec3>& corners, const dvec3& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const dvec3 a = glm::normalize(corners[i]), b = glm::normalize(corners[(i + 1) % corners.size()]);
    const dvec3 axis = glm::cross(a, b);
    sum += std::atan2(glm::length(axis), glm::dot(a, b)) * glm::dot(axis / glm::length(axis), normal);
  }
  return std::abs(sum) / 2.0;
}

std::vector<dvec3> cornersFrom(const scene::Scene& scene, const vec3& position) {
  std::vector<dvec3> result;
  for (const vec3& p : scene.meshes[0].geometries[0].positions)
    result.emplace_back(dvec3(vec3(scene.instances[0].worldFromObject * vec4(p, 1.0f))) - dvec3(position));
  return result;
}

// Tilted, stretched and mirrored, floating above y = 0.
mat4 placement(float size) {
  mat4 m = glm::translate(mat4(1.0f), size * vec3(0.3f, 2.0f, -0.4f));
  m = glm::rotate(m, 1.2f, glm::normalize(vec3(1, 0.2f, 0.1f)));
  return glm::scale(m, size * vec3(-2.0f, 1.0f, 1.0f));
}

// The mean of 1/pdf over samples is the solid angle of what is sampled.
TEST(TriangleLight, SolidAngle) {
  const std::vector<vec3> positions{{0, 0, 0}, {0.5f, 1.8f, -0.5f}, {30, 0, 0}};
  for (const float size : {1e-3f, 1.0f, 1e5f}) {
    scene::Scene source = emissiveRectangle(vec3(1.0f), placement(size));
    source.meshes[0].geometries[0].triangles.resize(1);
    const LightScene scene(source, {});
    for (const vec3& p : positions) {
      const std::vector<dvec3> c = cornersFrom(source, size * p);
      const double exact = triangleSolidAngle(c[0], c[1], c[2]);
      const auto measure = [&](const Defines& defines) {
        const auto samples = sampleLights(scene, size * p, kTriangleSamples, defines);
        return estimate(samples, [](const LightOut& s) { return s.valid ? 1.0 / s.pdf : 0.0; });
      };
      EXPECT_GT(pValue(measure({}), exact), sidak(0.01, 9)) << size;
      EXPECT_LT(pValue(measure(kWrong), exact), 1e-9) << size;
    }
  }
}

// Samples are uniform over the area: barycentrics found again on the host, in cells of equal area.
TEST(TriangleLight, UniformOverTheArea) {
  scene::Scene source = emissiveRectangle(vec3(1.0f), placement(1.0f));
  source.meshes[0].geometries[0].triangles = {{1, 2, 0}};
  const LightScene scene(source, {});
  const std::vector<dvec3> c = cornersFrom(source, vec3(0.0f));
  const dvec3 e1 = c[2] - c[1], e2 = c[0] - c[1];
  const double d11 = glm::dot(e1, e1), d12 = glm::dot(e1, e2), d22 = glm::dot(e2, e2);
  constexpr int kCells = 20;
  std::vector<double> observed(kCells * kCells, 0.0);
  for (const LightOut& s : sampleLights(scene, vec3(0.0f), kTriangleSamples)) {
    const dvec3 p = dvec3(s.point) - c[1];
    EXPECT_NEAR(glm::dot(p, glm::normalize(glm::cross(e1, e2))), 0.0, 1e-6);
    const double a = glm::dot(p, e1), b = glm::dot(p, e2), determinant = d11 * d22 - d12 * d12;
    const double b1 = (a * d22 - b * d12) / determinant, b2 = (b * d11 - a * d12) / determinant;
    const double sum = std::max(b1 + b2, 1e-12);
    const int x = std::clamp(static_cast<int>(sum * sum * kCells), 0, kCells - 1);
    observed[x * kCells + std::clamp(static_cast<int>(b2 / sum * kCells), 0, kCells - 1)] += 1.0;
  }
  const std::vector<double> expected(kCells * kCells, static_cast<double>(kTriangleSamples) / (kCells * kCells));
  EXPECT_GT(chiSquareTest(observed, expected).pValue, 0.01);
}

TEST(TriangleLight, RectangleOverAPlane) {
  const scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  const LightScene scene(source, {});
  for (const vec3& p : {vec3(0.0f), vec3(1.0f, 0.5f, -1.0f), vec3(-40.0f, 0.0f, 3.0f)}) {
    const double exact = 3.0 * polygonIrradiance(cornersFrom(source, p), dvec3(0, 1, 0));
    EXPECT_GT(pValue(irradiance(sampleLights(scene, p, kTriangleSamples), vec3(0, 1, 0)), exact), sidak(0.01, 3));
    EXPECT_LT(pValue(irradiance(sampleLights(scene, p, kTriangleSamples, kWrong), vec3(0, 1, 0)), exact), 1e-9);
  }
}

// A 1 m² lamp 0.5 m above the floor: the textbook's factor from a point to a parallel rectangle with a corner
// above it, F = (x/√(1+x²) atan(y/√(1+x²)) + y/√(1+y²) atan(x/√(1+y²))) / 2pi, x = a/h, y = b/h, per quarter.
TEST(TriangleLight, ParallelSquareTextbook) {
  const mat4 above = glm::rotate(glm::translate(mat4(1.0f), vec3(0, 0.5f, 0)), glm::radians(90.0f), vec3(1, 0, 0));
  const LightScene scene(emissiveRectangle(vec3(1.0f), above), {});
  const double r = 1.0 / std::sqrt(2.0);  // x = 0.5/0.5
  const double factor = 4.0 / (2.0 * kPiDouble) * 2.0 * r * std::atan(r);
  const auto samples = sampleLights(scene, vec3(0.0f), kTriangleSamples);
  EXPECT_GT(pValue(irradiance(samples, vec3(0, 1, 0)), kPiDouble * factor), 0.01);
}

io::Image texels(std::uint32_t width, const std::vector<std::uint8_t>& rgba) {
  io::Image image = io::makeImage(width, 1, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
  std::ranges::copy(rgba, image.samples<std::uint8_t>().begin());
  return image;
}

// The left half of the rectangle shines, by a texture with two texels and no filter.
TEST(TriangleLight, EmissiveTexture) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  source.images.push_back({"half", texels(2, {255, 255, 255, 255, 0, 0, 0, 255})});
  source.textures.push_back({"half", 0, {scene::Wrap::clampToEdge, scene::Wrap::clampToEdge, scene::Filter::nearest}});
  source.materials[0].emissiveTexture.texture = 0;
  const LightScene scene(source, {});
  std::vector<dvec3> c = cornersFrom(source, vec3(0.0f));
  c[1] = 0.5 * (c[0] + c[1]);
  c[2] = 0.5 * (c[2] + c[3]);
  const double exact = 3.0 * polygonIrradiance(c, dvec3(0, 1, 0));
  EXPECT_GT(pValue(irradiance(sampleLights(scene, vec3(0.0f), kTriangleSamples), vec3(0, 1, 0)), exact), 0.01);
}

// KHR_materials_clearcoat: the coat lies over the emission. Smooth: Schlick's reflectance at the interpolated normal.
TEST(TriangleLight, CoatOfTheEmitter) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  source.materials[0].clearcoat = 0.8f;
  for (const bool bent : {false, true}) {
    if (bent) source.meshes[0].geometries[0].normals.assign(4, glm::normalize(vec3(0.4f, -0.3f, 1.0f)));
    const vec3 object = bent ? vec3(0.4f, -0.3f, 1.0f) : vec3(0, 0, 1);
    const dvec3 normal = glm::normalize(dvec3(glm::inverse(glm::transpose(glm::mat3(placement(1.0f)))) * object));
    const LightScene scene(source, {});
    for (const LightOut& s : sampleLights(scene, vec3(0.0f), 1000)) {
      if (!s.valid) continue;
      const double fresnel = 0.04 + 0.96 * std::pow(1.0 - std::abs(glm::dot(normal, dvec3(s.wi))), 5.0);
      ASSERT_NEAR(s.radiance.x, 3.0 * (1.0 - 0.8f * fresnel), 1e-4);
    }
  }
}

// Each texture has the value for a smooth coat over opaque emission at one set of coordinates, and the opposite at the other.
TEST(TriangleLight, TexturesOfTheEmitterHaveTheirCoordinates) {
  for (const int uvSet : {0, 1}) {
    scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
    source.meshes[0].geometries[0].uvs[0].assign(4, vec2(0.25f, 0.5f));
    source.meshes[0].geometries[0].uvs[1].assign(4, vec2(0.75f, 0.5f));
    const std::uint8_t left = uvSet == 0 ? 255 : 0, right = 255 - left;
    const auto use = [&](std::uint8_t a, std::uint8_t b) {
      scene::TextureUse result;
      result.texture = addTexel(source, {a, a, a, a, b, b, b, b});
      result.uvSet = uvSet;
      return result;
    };
    scene::Material& m = source.materials[0];
    m.clearcoat = m.clearcoatRoughness = 1.0f;
    m.baseColorTexture = use(left, right);
    m.emissiveTexture = use(left, right);
    m.clearcoatTexture = use(left, right);
    m.clearcoatRoughnessTexture = use(right, left);
    const dvec3 normal =
        glm::normalize(dvec3(glm::inverse(glm::transpose(glm::mat3(placement(1.0f)))) * vec3(0, 0, 1)));
    m.alphaMode = uvSet == 0 ? scene::AlphaMode::blend : scene::AlphaMode::mask;
    const LightScene scene(source, {});
    const std::vector<LightOut> samples = sampleLights(scene, vec3(0.0f), 1000);
    EXPECT_GT(std::ranges::count(samples, 1u, &LightOut::valid), 900) << "set " << uvSet;
    for (const LightOut& s : samples) {
      if (!s.valid) continue;
      const double fresnel = 0.04 + 0.96 * std::pow(1.0 - std::abs(glm::dot(normal, dvec3(s.wi))), 5.0);
      ASSERT_NEAR(s.radiance.x, 3.0 * (1.0 - fresnel), 1e-4) << "set " << uvSet;
    }
  }
}

// Blend: a hit counts with probability alpha, so the light does, too. Mask: below the cut-off there is no surface.
TEST(TriangleLight, AlphaOfTheEmitter) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  const double exact = 3.0 * polygonIrradiance(cornersFrom(source, vec3(0.0f)), dvec3(0, 1, 0));
  const auto measure = [&] {
    const LightScene scene(source, {});
    return irradiance(sampleLights(scene, vec3(0.0f), kTriangleSamples), vec3(0, 1, 0));
  };
  source.materials[0].alphaMode = scene::AlphaMode::blend;
  source.materials[0].baseColor.a = 0.25f;
  EXPECT_GT(pValue(measure(), 0.25 * exact), sidak(0.01, 3));
  source.meshes[0].geometries[0].colors.assign(4, vec4(1, 1, 1, 0.5f));
  EXPECT_GT(pValue(measure(), 0.125 * exact), sidak(0.01, 3));
  source.materials[0].alphaMode = scene::AlphaMode::mask;
  source.materials[0].alphaCutoff = 0.2f;
  EXPECT_EQ(measure().mean, 0.0);
  source.materials[0].alphaCutoff = 0.1f;
  EXPECT_GT(pValue(measure(), exact), sidak(0.01, 3));
}

// Alpha has no effect on an instance that is forced to be opaque: rays meet all of it.
TEST(TriangleLight, ForcedOpaqueEmittersAreWhole) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  const double exact = 3.0 * polygonIrradiance(cornersFrom(source, vec3(0.0f)), dvec3(0, 1, 0));
  source.materials[0].baseColor.a = 0.25f;  // below the cut-off
  source.instances[0].flags = scene::kInstanceForceOpaque;
  for (const scene::AlphaMode mode : {scene::AlphaMode::blend, scene::AlphaMode::mask}) {
    source.materials[0].alphaMode = mode;
    const LightScene scene(source, {});
    EXPECT_GT(pValue(irradiance(sampleLights(scene, vec3(0.0f), kTriangleSamples), vec3(0, 1, 0)), exact),
              sidak(0.01, 2));
  }
}

// Uniform directions against all triangles by brute force: the densities that BSDF hits are weighed with integrate to
// the probability of the triangles, and agree with the sampler's own.
TEST(TriangleLight, DensityOfHitsIntegratesToItsProbability) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), placement(1.0f));
  source.instances.push_back(source.instances[0]);
  source.instances[1].worldFromObject = glm::translate(placement(1.0f), vec3(0, 0, 1.5f));
  source.lights.resize(1);
  const LightScene scene(source, {});
  const std::vector<double> probabilities = scene.probabilities(vec3(0.0f));
  double probability = 0.0;
  for (std::size_t i = 1; i < 5; ++i) probability += probabilities[i];
  const std::string body = R"(
    #include <quintet/lights/lights.glsl>
    #include <quintet/sampling/pcg.glsl>
    #define Out float
    float run(uint i) {
      Sampler rng = makeSampler(uvec2(1u), i, 7u);
      const vec3 d = sampleSphere(next2D(rng));
      float sum = 0.0;
      for (uint k = 0u; k < 4u; ++k) {
        const InstanceData instance = InstanceArray(frame.instances).at[k >> 1];
        const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry];
        const LightTriangle t = fetchLightTriangle(instance, geometry, k & 1u);
        const vec3 p0 = rowsTimesPoint(instance.worldFromObject, t.p0);
        const mat3 m = inverse(mat3(d, p0 - rowsTimesPoint(instance.worldFromObject, t.p1),
                                    p0 - rowsTimesPoint(instance.worldFromObject, t.p2)));
        const vec3 x = m * p0;  // distance and barycentrics
        if (x.x > 0.0 && x.y >= 0.0 && x.z >= 0.0 && x.y + x.z <= 1.0) {
          HitPayload hit;
          hit.t = x.x;
          hit.instance = k >> 1;
          hit.geometry = 0u;
          hit.primitive = k & 1u;
          sum += pdfLightHit(hit, lightSampleContext(vec3(0.0)), x.x, abs(dot(d, t.normal)));
        }
      }
      return sum * 4.0 * kPi;
    }
  )";
  const auto measure = [&](const Defines& defines) {
    return estimate(runCompute<float>(body, 1'000'000, scene.options(defines)), [](float v) { return v; });
  };
  EXPECT_GT(pValue(measure({}), probability), 0.01);
  EXPECT_LT(pValue(measure(kWrong), probability), 1e-9);

  for (const LightOut& s : sampleLights(scene, vec3(0.0f), 1000)) {
    if (!s.valid) continue;  // the point light is at the receiver
    const double cosine = std::abs(glm::dot(s.normal, s.wi));
    bool matches = false;
    for (std::size_t i = 1; i < 5; ++i)
      matches |= std::abs(probabilities[i] * s.distance * s.distance / cosine - s.pdf) < 1e-4 * s.pdf;
    EXPECT_TRUE(matches);  // each triangle has an area of 1 m²
  }
}

// Degenerate and unreachable: nothing, and no NaN.
TEST(TriangleLight, EdgeOnAndDegenerate) {
  scene::Scene source = emissiveRectangle(vec3(3.0f), mat4(1.0f));
  source.meshes[0].geometries[0].triangles.push_back({1, 1, 2});
  const LightScene scene(source, {});
  for (const vec3& p : {vec3(2, 0, 0), vec3(0.1f, 0.05f, 0.0f), vec3(0, 0, 1e-20f)})
    for (const LightOut& s : sampleLights(scene, p, 2000)) {
      if (!s.valid) continue;
      EXPECT_TRUE(std::isfinite(s.pdf) && s.pdf > 0.0f);
      EXPECT_TRUE(isFinite(s.wi));
    }
}

// The end of a shadow ray lies strictly in front of the light, seen from its origin, at any scale and place.
TEST(TriangleLight, ShadowTargetIsInFront) {
  struct TargetOut {
    vec3 target;
    std::uint32_t valid;
  };
  for (const float size : {1e-3f, 1.0f, 1e5f})
    for (const float offset : {0.0f, 1e3f}) {
      const mat4 placed = glm::translate(mat4(1.0f), size * offset * vec3(1, 1, -1)) * placement(size);
      const scene::Scene source = emissiveRectangle(vec3(1.0f), placed);
      const LightScene scene(source, {});
      const vec3 origin = size * offset * vec3(1, 1, -1);
      const auto targets = runCompute<TargetOut>(R"(
        #include <quintet/lights/lights.glsl>
        #include <quintet/sampling/pcg.glsl>
        struct TargetOut { vec3 target; uint valid; };
        #define In vec3
        #define Out TargetOut
        TargetOut run(uint i, vec3 origin) {
          Sampler rng = makeSampler(uvec2(2u), i, 7u);
          LightSample s;
          if (!sampleLight(origin, next1D(rng), next2D(rng), s)) return TargetOut(vec3(0.0), 0u);
          return TargetOut(shadowTarget(s, origin), 1u);
        }
      )",
                                                 std::vector<vec3>{origin}, 20'000, scene.options());
      const std::vector<dvec3> c = cornersFrom(source, origin);
      const dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
      const double side = glm::dot(normal, c[0]) < 0.0 ? 1.0 : -1.0;
      for (const TargetOut& t : targets) {
        if (!t.valid) continue;
        const double gap = side * glm::dot(normal, dvec3(t.target) - dvec3(origin) - c[0]);
        ASSERT_GT(gap, 0.0) << size << " " << offset;
        ASSERT_LT(gap, 1e-4 * size * (1.0 + offset)) << size << " " << offset;
      }
    }
}

}  // namespace
}  // namespace quintet::test
