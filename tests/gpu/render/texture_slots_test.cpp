// SPDX-License-Identifier: Apache-2.0
// The texture of every slot of a material: a grid of 4x4 different texels with its own translation, rotation and scale
// (KHR_texture_transform) and UV set, the channel that the slot reads, and the factor that multiplies it.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "lights/light_scene.h"
#include "scene_builder.h"

namespace quintet::test {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

constexpr std::uint32_t kGrid = 4;

struct SlotValues {
  vec3 baseColor, emission, specularColor, sheenColor, diffuseTransmissionColor;
  float metallic, alpha, transmission, specular, clearcoat, clearcoatAlpha, sheenAlpha, diffuseTransmission, anisotropy,
      iridescence, iridescenceThickness;
};

const std::string kShadeSlots = R"(
  #include <quintet/material.glsl>
  struct SlotValues {
    vec3 baseColor, emission, specularColor, sheenColor, diffuseTransmissionColor;
    float metallic, alpha, transmission, specular, clearcoat, clearcoatAlpha, sheenAlpha, diffuseTransmission, anisotropy,
        iridescence, iridescenceThickness;
  };
  #define In vec2
  #define Out SlotValues
  SlotValues run(uint index, vec2 barycentric) {
    HitPayload hit;
    hit.t = 1.0;
    hit.instance = hit.geometry = hit.primitive = 0u;
    hit.barycentric = barycentric;
    const vec3 wo = vec3(0.0, 0.0, 1.0);
    const Shading r = shadeSurface(fetchSurface(hit, wo), wo);
    return SlotValues(r.bsdf.baseColor, r.emission, r.bsdf.specularColor, r.bsdf.sheenColor, r.bsdf.diffuseTransmissionColor,
                      r.bsdf.metallic, r.bsdf.alpha, r.bsdf.transmission, r.bsdf.specular, r.bsdf.clearcoat, r.bsdf.clearcoatAlpha,
                      r.bsdf.sheenAlpha, r.bsdf.diffuseTransmission, r.bsdf.anisotropy, r.bsdf.iridescence,
                      r.bsdf.iridescenceThickness);
  }
)";

// Texels with values in [0.1, 0.9], different in each channel.
int addGrid(scene::Scene& scene, unsigned seed) {
  const int texture = addTexel(scene, {0, 0, 0, 0}, io::ColorEncoding::linear);
  io::Image image = io::makeImage(kGrid, kGrid, 4, io::PixelType::f32, io::ColorEncoding::linear);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.1f, 0.9f);
  for (float& value : image.samples<float>()) value = uniform(random);
  scene.images.back().image = std::move(image);
  return texture;
}

// A triangle in z = 0, seen from +z.
scene::Scene texturedTriangle() {
  SceneBuilder builder;
  scene::Geometry g;
  g.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  g.triangles = {{0, 1, 2}};
  g.uvs[0] = {{0.1f, 0.2f}, {1.3f, 0.1f}, {0.3f, 1.4f}};
  g.uvs[1] = {{0.9f, -0.2f}, {0.2f, 0.8f}, {-0.6f, 0.4f}};
  builder.add(g, {}, mat4(1.0f));
  return builder.scene;
}

// The texel at a point of the triangle in double precision. Clears `decided` close to the border of a texel.
dvec4 texelAt(const scene::Scene& scene, const scene::TextureUse& use, const vec2& barycentric, bool& decided) {
  const auto& uvs = scene.meshes[0].geometries[0].uvs[static_cast<std::size_t>(use.uvSet)];
  const dvec2 uv = (1.0 - barycentric.x - barycentric.y) * dvec2(uvs[0]) + double(barycentric.x) * dvec2(uvs[1]) +
                   double(barycentric.y) * dvec2(uvs[2]);
  const dvec2 scaled = dvec2(use.scale) * uv;
  const double c = std::cos(double(use.rotation)), s = std::sin(double(use.rotation));
  const dvec2 p =
      double(kGrid) * (dvec2(use.offset) + dvec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y));
  const dvec2 part = p - glm::floor(p);
  if (std::min({part.x, part.y, 1 - part.x, 1 - part.y}) < 5e-3) decided = false;
  const auto wrapped = [](double v) {
    return static_cast<std::uint32_t>(((static_cast<int>(std::floor(v)) % 4) + 4) % 4);
  };
  const scene::Texture& texture = scene.textures[static_cast<std::size_t>(use.texture)];
  const auto texel =
      scene.images[static_cast<std::size_t>(texture.image)].image.pixel<float>(wrapped(p.x), wrapped(p.y));
  return {texel[0], texel[1], texel[2], texel[3]};
}

TEST(TextureSlots, ReadTheirChannelsAtTheTransformedCoordinates) {
  scene::Scene scene = texturedTriangle();
  scene.materials.insert(scene.materials.begin(), scene::Material{});
  scene.meshes[0].geometries[0].material = 1;
  scene::Material& m = scene.materials[1];
  unsigned slots = 0;
  const auto use = [&] {
    scene::TextureUse u;
    u.texture = addGrid(scene, 100 + slots);
    u.uvSet = static_cast<int>(slots % 2);
    u.offset = {0.11f + 0.07f * float(slots), 0.5f - 0.03f * float(slots)};
    u.scale = {0.8f + 0.05f * float(slots), 1.3f - 0.04f * float(slots)};
    u.rotation = 0.4f + 0.3f * float(slots);
    slots++;
    return u;
  };
  m.baseColor = {0.9f, 0.8f, 0.7f, 1.0f}, m.baseColorTexture = use();
  m.metallic = 0.9f, m.roughness = 0.8f, m.metallicRoughnessTexture = use();
  m.transmission = 0.85f, m.transmissionTexture = use();
  m.specular = 0.95f, m.specularTexture = use();
  m.specularColor = {0.7f, 1.2f, 0.9f}, m.specularColorTexture = use();
  m.clearcoat = 0.9f, m.clearcoatTexture = use();
  m.clearcoatRoughness = 0.8f, m.clearcoatRoughnessTexture = use();
  m.sheenColor = {0.5f, 0.9f, 0.7f}, m.sheenColorTexture = use();
  m.sheenRoughness = 0.9f, m.sheenRoughnessTexture = use();
  m.diffuseTransmission = 0.8f, m.diffuseTransmissionTexture = use();
  m.diffuseTransmissionColor = {0.6f, 0.7f, 0.9f}, m.diffuseTransmissionColorTexture = use();
  m.anisotropy = 0.9f, m.anisotropyTexture = use();
  m.iridescence = 0.9f, m.iridescenceTexture = use();
  m.iridescenceThicknessMinimum = 150, m.iridescenceThicknessMaximum = 650, m.iridescenceThicknessTexture = use();

  // Emission alone, because a coat changes it.
  scene::Scene emitter = texturedTriangle();
  scene::Material& e = emitter.materials[0];
  e.emissive = {1, 2, 3};
  e.emissiveTexture.texture = addGrid(emitter, 7);
  e.emissiveTexture.offset = {0.3f, 0.1f};
  e.emissiveTexture.scale = {1.2f, 0.6f};
  e.emissiveTexture.rotation = -0.7f;

  std::vector<vec2> points;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  while (points.size() < 400) {
    const vec2 b(uniform(random), uniform(random));
    if (b.x + b.y < 1.0f) points.push_back(b);
  }
  const LightScene device(scene, {}), emitterDevice(emitter, {});
  const auto values = runCompute<SlotValues>(kShadeSlots, points, points.size(), device.options());
  const auto emitted = runCompute<SlotValues>(kShadeSlots, points, points.size(), emitterDevice.options());

  const auto color = [](const vec3& got, const vec3& factor, const dvec4& texel, const char* name) {
    EXPECT_LT(glm::length(dvec3(got) - dvec3(factor) * dvec3(texel)), 2e-3) << name;
  };
  int compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool decided = true;
    const auto texel = [&](const scene::TextureUse& u) { return texelAt(scene, u, points[i], decided); };
    const dvec4 base = texel(m.baseColorTexture), metal = texel(m.metallicRoughnessTexture),
                through = texel(m.transmissionTexture), specular = texel(m.specularTexture),
                tint = texel(m.specularColorTexture), coat = texel(m.clearcoatTexture),
                coatRough = texel(m.clearcoatRoughnessTexture), sheen = texel(m.sheenColorTexture),
                sheenRough = texel(m.sheenRoughnessTexture), behind = texel(m.diffuseTransmissionTexture),
                behindColor = texel(m.diffuseTransmissionColorTexture), grain = texel(m.anisotropyTexture),
                film = texel(m.iridescenceTexture), thickness = texel(m.iridescenceThicknessTexture),
                light = texelAt(emitter, e.emissiveTexture, points[i], decided);
    if (!decided) continue;
    compared++;
    const SlotValues& v = values[i];
    color(v.baseColor, m.baseColor, base, "base color");
    color(v.specularColor, m.specularColor, tint, "specular color");
    color(v.sheenColor, m.sheenColor, sheen, "sheen color");
    color(v.diffuseTransmissionColor, m.diffuseTransmissionColor, behindColor, "diffuse transmission color");
    color(emitted[i].emission, e.emissive, light, "emission");
    EXPECT_NEAR(v.metallic, 0.9 * metal.b, 1e-3) << "metallic";
    EXPECT_NEAR(v.alpha, std::pow(0.8 * metal.g, 2), 1e-3) << "roughness";
    EXPECT_NEAR(v.transmission, 0.85 * through.r, 1e-3) << "transmission";
    EXPECT_NEAR(v.specular, 0.95 * specular.a, 1e-3) << "specular";
    EXPECT_NEAR(v.clearcoat, 0.9 * coat.r, 1e-3) << "clearcoat";
    EXPECT_NEAR(v.clearcoatAlpha, std::pow(0.8 * coatRough.g, 2), 1e-3) << "clearcoat roughness";
    EXPECT_NEAR(v.sheenAlpha, std::pow(0.9 * sheenRough.a, 2), 1e-3) << "sheen roughness";
    EXPECT_NEAR(v.diffuseTransmission, 0.8 * behind.a, 1e-3) << "diffuse transmission";
    EXPECT_NEAR(v.anisotropy, 0.9 * grain.b, 1e-3) << "anisotropy";
    EXPECT_NEAR(v.iridescence, 0.9 * film.r, 1e-3) << "iridescence";
    EXPECT_NEAR(v.iridescenceThickness, 150 + 500 * thickness.g, 1.0) << "iridescence thickness";
    if (HasFailure()) break;
  }
  EXPECT_GT(compared, 150);
}

// Two normal maps with their own scales, in the tangent frame: that of the surface and that of the clearcoat. From behind, both
// normals are reversed.
TEST(TextureSlots, NormalMapsHaveTheirOwnScales) {
  scene::Scene scene = texturedTriangle();
  scene::Geometry& g = scene.meshes[0].geometries[0];
  g.normals.assign(3, vec3(0, 0, 1));
  g.tangents.assign(3, vec4(0, 1, 0, 1));  // the bitangent is -x
  scene::Material& m = scene.materials[0];
  m.clearcoat = 1.0f;
  const auto use = [&](std::uint8_t x, std::uint8_t y, std::uint8_t z) {
    scene::TextureUse u;
    u.texture = addTexel(scene, {x, y, z, 255});
    return u;
  };
  m.normalTexture = use(160, 90, 230), m.normalScale = 0.7f;
  m.clearcoatNormalTexture = use(100, 150, 240), m.clearcoatNormalScale = 0.4f;
  struct Out {
    vec3 normal, coat;
  };
  const LightScene device(scene, {});
  const std::vector<vec3> directions{{0, 0, 1}, {0, 0, -1}};
  const auto found = runCompute<Out>(R"(
    #include <quintet/material.glsl>
    struct Out_ { vec3 normal; vec3 coat; };
    #define In vec3
    #define Out Out_
    Out run(uint index, vec3 wo) {
      HitPayload hit;
      hit.t = 1.0;
      hit.instance = hit.geometry = hit.primitive = 0u;
      hit.barycentric = vec2(0.3, 0.3);
      const Shading r = shadeSurface(fetchSurface(hit, wo), wo);
      return Out(r.normal, toWorld(r, r.bsdf.clearcoatNormal));
    }
  )",
                                     directions, directions.size(), device.options());
  const auto expected = [](const dvec3& bytes, double scale) {
    const dvec3 t = 2.0 / 255.0 * bytes - 1.0;
    return glm::normalize(dvec3(-scale * t.y, scale * t.x, t.z));
  };
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double side = directions[i].z;
    EXPECT_LT(glm::length(dvec3(found[i].normal) - side * expected({160, 90, 230}, 0.7)), 1e-5) << i;
    EXPECT_LT(glm::length(dvec3(found[i].coat) - side * expected({100, 150, 240}, 0.4)), 1e-5) << i;
  }
}

// The texture turns the tangent, counterclockwise from that of the surface, and the rotation of the material adds to it.
TEST(TextureSlots, AnisotropyTurnsTheTangent) {
  scene::Scene scene = texturedTriangle();
  scene::Geometry& g = scene.meshes[0].geometries[0];
  g.normals.assign(3, vec3(0, 0, 1));
  g.tangents.assign(3, vec4(0, 1, 0, 1));  // the bitangent is -x
  scene::Material& m = scene.materials[0];
  m.anisotropy = 0.8f, m.anisotropyRotation = 0.3f;
  m.anisotropyTexture.texture = addTexel(scene, {230, 170, 200, 255});
  const LightScene device(scene, {});
  const auto found = runCompute<vec3>(R"(
    #include <quintet/material.glsl>
    #define Out vec3
    Out run(uint index) {
      HitPayload hit;
      hit.t = 1.0;
      hit.instance = hit.geometry = hit.primitive = 0u;
      hit.barycentric = vec2(0.3, 0.3);
      const vec3 wo = vec3(0.0, 0.0, 1.0);
      return shadeSurface(fetchSurface(hit, wo), wo).tangent;
    }
  )",
                                      1, device.options());
  const double angle = std::atan2(170 / 127.5 - 1, 230 / 127.5 - 1) + 0.3;
  EXPECT_LT(glm::length(dvec3(found[0]) - dvec3(-std::sin(angle), std::cos(angle), 0)), 1e-5);
}

}  // namespace
}  // namespace quintet::test
