// SPDX-License-Identifier: Apache-2.0
// fetchSurface and shadeSurface against the host: one triangle with all attributes and textures, at random points and
// from random directions, under transforms that stretch and mirror.
#include <gtest/gtest.h>

#include <random>

#include "lights/light_scene.h"
#include "scene_builder.h"

namespace quintet::test {
namespace {

using glm::dvec3;

struct Query {
  vec2 barycentric;
  vec3 wo;
};
struct Answer {
  vec3 position, geometricNormal, normal;
  std::uint32_t frontFace;
  vec3 baseColor;
  float metallic, alpha, clearcoat, clearcoatAlpha;
  vec3 emission;
  float transmission, diffuseTransmission, sheenAlpha;
  vec3 diffuseTransmissionColor, sheenColor;
};

const std::string kShade = R"(
  #include <quintet/material.glsl>
  struct Query { vec2 barycentric; vec3 wo; };
  struct Answer {
    vec3 position, geometricNormal, normal; uint frontFace; vec3 baseColor; float metallic, alpha, clearcoat, clearcoatAlpha;
    vec3 emission; float transmission, diffuseTransmission, sheenAlpha; vec3 diffuseTransmissionColor, sheenColor;
  };
  #define In Query
  #define Out Answer
  Answer run(uint index, Query q) {
    HitPayload hit;
    hit.t = 1.0;
    hit.instance = hit.geometry = hit.primitive = 0u;
    hit.barycentric = q.barycentric;
    Surface s = fetchSurface(hit, q.wo);
    Shading r = shadeSurface(s, q.wo);
    return Answer(s.position, s.geometricNormal, r.normal, uint(s.frontFace), r.bsdf.baseColor, r.bsdf.metallic, r.bsdf.alpha,
                  r.bsdf.clearcoat, r.bsdf.clearcoatAlpha, r.emission, r.bsdf.transmission, r.bsdf.diffuseTransmission,
                  r.bsdf.sheenAlpha, r.bsdf.diffuseTransmissionColor, r.bsdf.sheenColor);
  }
)";

int addFloatTexel(scene::Scene& scene, const vec4& rgba) {
  const int texture = addTexel(scene, {0, 0, 0, 0}, io::ColorEncoding::linear);
  io::Image image = io::makeImage(1, 1, 4, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::size_t i = 0; i < 4; ++i) image.samples<float>()[i] = rgba[static_cast<glm::length_t>(i)];
  scene.images.back().image = std::move(image);
  return texture;
}

scene::TextureUse use(int texture, int uvSet = 0) {
  scene::TextureUse u;
  u.texture = texture;
  u.uvSet = uvSet;
  return u;
}

struct Case {
  const char* name;
  mat4 worldFromObject;
};

std::vector<Case> transforms() {
  const mat4 turned = glm::rotate(mat4(1.0f), 0.8f, glm::normalize(vec3(1, 2, -1)));
  return {{"as it is", mat4(1.0f)},
          {"stretched",
           glm::translate(mat4(1.0f), vec3(1, 2, 3)) * turned * glm::scale(mat4(1.0f), vec3(1.0f, 3.0f, 0.4f))},
          {"mirrored", turned * glm::scale(mat4(1.0f), vec3(-1.0f, 2.0f, 0.7f))}};
}

scene::Scene triangle(const mat4& worldFromObject) {
  SceneBuilder builder;
  scene::Geometry g;
  g.positions = {{0, 0, 0}, {2, 0, 0.1f}, {0.3f, 1, -0.2f}};
  g.triangles = {{0, 1, 2}};
  g.normals = {glm::normalize(vec3(-0.2f, -0.1f, 1)), glm::normalize(vec3(0.3f, 0, 1)),
               glm::normalize(vec3(0, 0.3f, 1))};
  for (const vec3& n : g.normals)
    g.tangents.emplace_back(glm::normalize(vec3(1, 0.2f, 0) - n * glm::dot(n, vec3(1, 0.2f, 0))), -1.0f);
  g.uvs[0] = {{0, 0}, {1, 0}, {0, 1}};
  g.uvs[1] = {{0.1f, 0.9f}, {0.2f, 0.3f}, {0.8f, 0.4f}};
  g.colors = {{1, 0.5f, 0.2f, 1}, {0.3f, 1, 0.6f, 1}, {0.9f, 0.4f, 1, 1}};
  builder.add(g, {}, worldFromObject);
  return builder.scene;
}

std::vector<Query> queries() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<Query> result;
  while (result.size() < 500) {
    const vec2 b(uniform(random), uniform(random));
    const vec3 d(uniform(random) - 0.5f, uniform(random) - 0.5f, uniform(random) - 0.5f);
    if (b.x + b.y < 1.0f && glm::length(d) > 0.1f) result.push_back({b, glm::normalize(d)});
  }
  return result;
}

std::vector<Answer> shade(const scene::Scene& scene, const std::vector<Query>& points) {
  const LightScene device(scene, {});
  return runCompute<Answer>(kShade, points, points.size(), device.options());
}

// The surface as the host computes it in double precision.
struct Expected {
  dvec3 position, face, normal, tangent, bitangent;
  double side;
};
Expected expectAt(const scene::Scene& scene, const Query& q) {
  const scene::Geometry& g = scene.meshes[0].geometries[0];
  const glm::dmat4 m(scene.instances[0].worldFromObject);
  const glm::dmat3 linear(m), forNormals = glm::transpose(glm::inverse(linear));
  const dvec3 b(1.0 - q.barycentric.x - q.barycentric.y, q.barycentric.x, q.barycentric.y);
  dvec3 p(0.0), n(0.0), t(0.0);
  for (glm::length_t i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    p += b[i] * dvec3(g.positions[at]), n += b[i] * dvec3(g.normals[at]), t += b[i] * dvec3(g.tangents[at]);
  }
  Expected e;
  e.position = dvec3(m * glm::dvec4(p, 1.0));
  // The front face has counterclockwise vertices in object space. Normals follow it under mirroring.
  e.face = glm::normalize(forNormals *
                          glm::cross(dvec3(g.positions[1] - g.positions[0]), dvec3(g.positions[2] - g.positions[0])));
  e.side = glm::dot(e.face, dvec3(q.wo)) >= 0.0 ? 1.0 : -1.0;
  e.normal = glm::normalize(forNormals * n);
  const dvec3 along = linear * t;
  e.tangent = glm::normalize(along - e.normal * glm::dot(e.normal, along));
  // glTF: bitangent = w cross(normal, tangent) in object space, with w = -1 here. Mirroring flips its sign in world
  // space.
  e.bitangent = -(glm::determinant(linear) < 0.0 ? -1.0 : 1.0) * glm::cross(e.normal, e.tangent);
  return e;
}

// Returns whether normal and mirror direction are far enough from the horizon that the normal is not bent
// (consistentNormal in material.glsl).
bool isUnbent(const Expected& e, const dvec3& normal, const dvec3& wo) {
  const double facing = glm::dot(normal, wo);
  return facing > 0.02 && glm::dot(2.0 * facing * normal - wo, e.side * e.face) > 0.02;
}

TEST(SurfaceShading, TransformsNormalsByTheInverseTranspose) {
  for (const Case& c : transforms()) {
    SCOPED_TRACE(c.name);
    const scene::Scene scene = triangle(c.worldFromObject);
    const std::vector<Query> points = queries();
    const std::vector<Answer> answers = shade(scene, points);
    int compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Expected e = expectAt(scene, points[i]);
      const dvec3 wo = points[i].wo;
      if (std::abs(glm::dot(e.face, wo)) < 1e-3) continue;
      ASSERT_LT(glm::length(dvec3(answers[i].position) - e.position), 1e-5);
      ASSERT_EQ(answers[i].frontFace, e.side > 0.0 ? 1u : 0u);
      ASSERT_LT(glm::length(dvec3(answers[i].geometricNormal) - e.side * e.face), 1e-5);
      ASSERT_GT(glm::dot(dvec3(answers[i].normal), wo), 0.0);
      if (!isUnbent(e, e.side * e.normal, wo)) continue;
      ASSERT_LT(glm::length(dvec3(answers[i].normal) - e.side * e.normal), 1e-5);
      ++compared;
    }
    EXPECT_GT(compared, 200);
  }
}

TEST(SurfaceShading, AppliesNormalMapsInTheTangentFrame) {
  for (const Case& c : transforms()) {
    SCOPED_TRACE(c.name);
    scene::Scene scene = triangle(c.worldFromObject);
    scene.materials[0].normalTexture = use(addTexel(scene, {160, 90, 240, 255}, io::ColorEncoding::linear));
    scene.materials[0].normalScale = 0.8f;
    const dvec3 map =
        glm::normalize(dvec3(0.8 * (2.0 * 160 / 255 - 1.0), 0.8 * (2.0 * 90 / 255 - 1.0), 2.0 * 240 / 255 - 1.0));
    const std::vector<Query> points = queries();
    const std::vector<Answer> answers = shade(scene, points);
    int compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Expected e = expectAt(scene, points[i]);
      const dvec3 normal = e.side * glm::normalize(map.x * e.tangent + map.y * e.bitangent + map.z * e.normal);
      if (!isUnbent(e, normal, points[i].wo)) continue;
      ASSERT_LT(glm::length(dvec3(answers[i].normal) - normal), 2e-5);
      ++compared;
    }
    EXPECT_GT(compared, 150);
  }
}

struct TangentFrame {
  vec3 normal, tangent, bitangent;  // of the front side
  vec2 uv;
};

std::vector<TangentFrame> framesOf(const scene::Scene& scene, const std::vector<Query>& points) {
  const LightScene device(scene, {});
  return runCompute<TangentFrame>(R"(
    #include <quintet/surface.glsl>
    struct Query { vec2 barycentric; vec3 wo; };
    struct Answer { vec3 normal, tangent, bitangent; vec2 uv; };
    #define In Query
    #define Out Answer
    Answer run(uint index, Query q) {
      HitPayload hit;
      hit.t = 1.0;
      hit.instance = hit.geometry = hit.primitive = 0u;
      hit.barycentric = q.barycentric;
      const Surface s = fetchSurface(hit, q.wo);
      return Answer(s.frontFace ? s.shadingNormal : -s.shadingNormal, s.tangent, s.bitangent, s.uvs[0] + s.uvs[1]);
    }
  )",
                                  points, points.size(), device.options());
}

// Without tangents, and with tangents along the normal: the frame is orthonormal, right-handed, and the same from both sides.
// Missing texture coordinates are 0.
TEST(SurfaceShading, MakesFramesWithoutTangents) {
  const mat4 turned = glm::rotate(mat4(1.0f), kPi, vec3(1, 0, 0));
  std::vector<Case> cases = transforms();
  cases.push_back({"axes", mat4(1.0f)});
  cases.push_back({"mirrored axes", glm::scale(mat4(1.0f), vec3(-1, 1, 1))});
  cases.push_back({"turned", turned});
  cases.push_back({"turned and mirrored", turned * glm::scale(mat4(1.0f), vec3(1, -1, 1))});
  std::vector<Query> points = queries();
  const std::size_t count = points.size();
  for (std::size_t i = 0; i < count; ++i) points.push_back({points[i].barycentric, -points[i].wo});
  for (const Case& c : cases)
    for (const char* kind : {"smooth", "flat", "tangents along the normal"}) {
      SCOPED_TRACE(testing::Message() << c.name << ", " << kind);
      const bool along = kind == std::string("tangents along the normal");
      if (along && std::string(c.name).find("axes") == std::string::npos) continue;  // rounding would leave a direction
      scene::Scene scene = triangle(mat4(1.0f));
      scene.instances[0].worldFromObject = c.worldFromObject;
      scene::Geometry& g = scene.meshes[0].geometries[0];
      g.uvs = {};
      if (kind == std::string("flat")) {
        g.positions = {{0, 0, 0}, {2, 0, 0}, {0.3f, 1, 0}};  // the normal is along z
        g.normals.clear();
      }
      if (along) {
        g.normals.assign(3, vec3(0, 0, 1));
        g.tangents.assign(3, vec4(0, 0, 1, 1));
      } else {
        g.tangents.clear();
      }
      const std::vector<TangentFrame> frames = framesOf(scene, points);
      for (std::size_t i = 0; i < count; ++i) {
        const TangentFrame& f = frames[i];
        ASSERT_NEAR(glm::length(f.tangent), 1.0f, 1e-5f);
        ASSERT_NEAR(glm::dot(f.tangent, f.normal), 0.0f, 1e-5f);
        const bool right = !along || glm::determinant(mat3(c.worldFromObject)) > 0.0f;
        ASSERT_LT(glm::length(f.bitangent - (right ? 1.0f : -1.0f) * glm::cross(f.normal, f.tangent)), 1e-5f);
        ASSERT_EQ(f.uv, vec2(0.0f));
        ASSERT_LT(glm::length(frames[count + i].normal - f.normal), 1e-5f) << "from behind";
        ASSERT_LT(glm::length(frames[count + i].tangent - f.tangent), 1e-5f) << "from behind";
        ASSERT_LT(glm::length(frames[count + i].bitangent - f.bitangent), 1e-5f) << "from behind";
      }
    }
}

double fromSrgb(int byte) {
  const double x = byte / 255.0;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

TEST(SurfaceShading, MultipliesTexturesByFactors) {
  scene::Scene scene = triangle(mat4(1.0f));
  scene::Material& m = scene.materials[0];
  m.baseColor = {0.5f, 0.6f, 0.7f, 1.0f};
  m.baseColorTexture = use(addTexel(scene, {200, 100, 50, 255}, io::ColorEncoding::sRgb));
  m.roughness = 0.8f, m.metallic = 0.9f;
  m.metallicRoughnessTexture = use(addTexel(scene, {10, 150, 60, 255}, io::ColorEncoding::linear));
  m.emissive = {1, 2, 3};
  m.emissiveTexture = use(addTexel(scene, {255, 128, 64, 255}, io::ColorEncoding::sRgb));
  m.diffuseTransmission = 0.9f, m.diffuseTransmissionColor = {0.8f, 0.6f, 0.4f};
  m.diffuseTransmissionTexture = use(addTexel(scene, {10, 20, 30, 170}, io::ColorEncoding::linear));
  m.diffuseTransmissionColorTexture = use(addTexel(scene, {220, 110, 70, 40}, io::ColorEncoding::sRgb));
  const dvec3 transmitted = dvec3(0.8, 0.6, 0.4) * dvec3(fromSrgb(220), fromSrgb(110), fromSrgb(70));
  const std::vector<Query> points = queries();
  const std::vector<Answer> answers = shade(scene, points);
  const double roughness = 0.8f * 150 / 255.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const vec3 b(1.0f - points[i].barycentric.x - points[i].barycentric.y, points[i].barycentric);
    const auto& colors = scene.meshes[0].geometries[0].colors;
    const dvec3 vertex = dvec3(b.x * vec3(colors[0]) + b.y * vec3(colors[1]) + b.z * vec3(colors[2]));
    const dvec3 base = dvec3(0.5, 0.6, 0.7) * dvec3(fromSrgb(200), fromSrgb(100), fromSrgb(50)) * vertex;
    ASSERT_LT(glm::length(dvec3(answers[i].baseColor) - base), 1e-3);
    ASSERT_NEAR(answers[i].alpha, roughness * roughness, 1e-4);
    ASSERT_NEAR(answers[i].metallic, 0.9 * 60 / 255.0, 1e-4);
    ASSERT_LT(glm::length(dvec3(answers[i].emission) - dvec3(1.0, 2.0 * fromSrgb(128), 3.0 * fromSrgb(64))), 1e-2);
    ASSERT_NEAR(answers[i].diffuseTransmission, 0.9 * 170 / 255.0, 1e-4);
    ASSERT_LT(glm::length(dvec3(answers[i].diffuseTransmissionColor) - transmitted), 2e-3);
  }
}

// Textures with float values can leave the range of the parameters.
TEST(SurfaceShading, LimitsFloatTextures) {
  scene::Scene scene = triangle(mat4(1.0f));
  scene::Material& m = scene.materials[0];
  m.transmission = m.diffuseTransmission = 1.0f;
  m.sheenColor = {0.5f, 1.0f, 0.5f};
  m.sheenRoughness = 1.0f;
  m.transmissionTexture = m.sheenColorTexture = use(addFloatTexel(scene, {4.0f, -2.0f, 0.5f, 1.0f}));
  m.diffuseTransmissionTexture = m.sheenRoughnessTexture = use(addFloatTexel(scene, {0.0f, 0.0f, 0.0f, 3.0f}));
  const Answer above = shade(scene, {queries()[0]})[0];
  EXPECT_EQ(above.transmission, 1.0f);
  EXPECT_EQ(above.diffuseTransmission, 1.0f);
  EXPECT_EQ(above.sheenAlpha, 1.0f);
  EXPECT_EQ(above.sheenColor, vec3(1.0f, 0.0f, 0.25f));
  m.transmissionTexture = m.diffuseTransmissionTexture = use(addFloatTexel(scene, vec4(-1.0f)));
  const Answer below = shade(scene, {queries()[0]})[0];
  EXPECT_EQ(below.transmission, 0.0f);
  EXPECT_EQ(below.diffuseTransmission, 0.0f);
}

// A texture with a black and a white texel reveals the coordinate of its lookup: either UV set, translated, rotated and
// scaled.
TEST(SurfaceShading, AppliesUvSetAndTextureTransform) {
  for (const int uvSet : {0, 1}) {
    SCOPED_TRACE(uvSet);
    scene::Scene scene = triangle(mat4(1.0f));
    scene::TextureUse t = use(addTexel(scene, {0, 0, 0, 255, 255, 255, 255, 255}, io::ColorEncoding::linear), uvSet);
    t.offset = {0.13f, 0.2f};
    t.scale = {1.5f, 0.7f};
    t.rotation = 0.6f;
    scene.materials[0].metallicRoughnessTexture = t;
    const std::vector<Query> points = queries();
    const std::vector<Answer> answers = shade(scene, points);
    const auto& uvs = scene.meshes[0].geometries[0].uvs[static_cast<std::size_t>(uvSet)];
    int white = 0, compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec2 q = points[i].barycentric;
      const glm::dvec2 uv((1.0f - q.x - q.y) * uvs[0] + q.x * uvs[1] + q.y * uvs[2]);
      // KHR_texture_transform: translation * rotation * scale, with counterclockwise rotation for v pointing down.
      const double x = 0.13 + std::cos(0.6) * 1.5 * uv.x + std::sin(0.6) * 0.7 * uv.y;
      const double turns = x - std::floor(x);
      if (std::min({std::abs(turns - 0.5), turns, 1.0 - turns}) < 0.01) continue;
      ++compared;
      white += turns > 0.5;
      ASSERT_NEAR(answers[i].metallic, turns > 0.5 ? 1.0f : 0.0f, 1e-5f) << x;
    }
    EXPECT_GT(compared, 400);
    EXPECT_TRUE(white > 50 && white < compared - 50);
  }
}

}  // namespace
}  // namespace quintet::test
