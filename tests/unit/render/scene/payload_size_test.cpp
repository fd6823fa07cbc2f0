// SPDX-License-Identifier: Apache-2.0
// Payload sizes of the path tracer: at most 64 bytes for all scenes. The sizes are those of the compiled shaders, for
// each feature of scene_features.h alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "program/compile.h"
#include "program/load.h"
#include "render/scene/scene_features.h"
#include "scene/model/material_textures.h"

namespace quintet::render {
namespace {

using Change = void (*)(scene::Scene&, scene::Environment&);

constexpr std::uint64_t kMaxBytes = 64;

scene::Material& addMaterial(scene::Scene& scene) { return scene.materials.emplace_back(); }

// Triangles of the last material.
scene::Geometry& addTriangles(scene::Scene& scene) {
  scene::Geometry& geometry = scene.meshes.emplace_back().geometries.emplace_back();
  geometry.material = static_cast<int>(scene.materials.size()) - 1;
  return geometry;
}

// A solid of the last material.
scene::PrimitiveSet& addSolid(scene::Scene& scene, scene::PrimitiveType type = scene::PrimitiveType::sphere) {
  scene::PrimitiveSet& set = scene.meshes.emplace_back().primitiveSets.emplace_back();
  set.primitives.push_back({.type = type, .material = static_cast<int>(scene.materials.size()) - 1});
  return set;
}

scene::Material& addPane(scene::Scene& scene) {
  scene::Material& pane = addMaterial(scene);
  pane.transmission = 1.0f;
  pane.roughness = 0.0f;
  pane.metallic = 0.0f;
  return pane;
}

scene::Material& addVeil(scene::Scene& scene) {
  scene::Material& veil = addMaterial(scene);
  veil.alphaMode = scene::AlphaMode::blend;
  veil.baseColor.a = 0.5f;
  return veil;
}

// Returns changes to a scene that add one feature each, and as little else as possible.
const std::map<std::string, Change>& features() {
  static const std::map<std::string, Change> kFeatures{
      {"glass", [](scene::Scene& s, scene::Environment&) { (addPane(s).thickness = 1.0f, addTriangles(s)); }},
      {"rough thin walls",
       [](scene::Scene& s, scene::Environment&) { (addPane(s).roughness = 0.5f, addTriangles(s)); }},
      {"panes", [](scene::Scene& s, scene::Environment&) { (addPane(s), addTriangles(s)); }},
      {"veils", [](scene::Scene& s, scene::Environment&) { (addVeil(s), addTriangles(s)); }},
      {"cut-outs",
       [](scene::Scene& s, scene::Environment&) { (addVeil(s).alphaMode = scene::AlphaMode::mask, addTriangles(s)); }},
      {"clearcoat", [](scene::Scene& s, scene::Environment&) { (addMaterial(s).clearcoat = 1.0f, addTriangles(s)); }},
      {"sheen",
       [](scene::Scene& s, scene::Environment&) { (addMaterial(s).sheenColor = vec3(1.0f), addTriangles(s)); }},
      {"diffuse transmission",
       [](scene::Scene& s, scene::Environment&) { (addMaterial(s).diffuseTransmission = 1.0f, addTriangles(s)); }},
      {"anisotropy", [](scene::Scene& s, scene::Environment&) { (addMaterial(s).anisotropy = 1.0f, addTriangles(s)); }},
      {"iridescence",
       [](scene::Scene& s, scene::Environment&) { (addMaterial(s).iridescence = 1.0f, addTriangles(s)); }},
      {"dispersion",
       [](scene::Scene& s, scene::Environment&) {
         scene::Material& glass = addPane(s);
         glass.thickness = glass.dispersion = 1.0f;
         addTriangles(s);
       }},
      {"milk",
       [](scene::Scene& s, scene::Environment&) {
         scene::Material& milk = addPane(s);
         milk.thickness = milk.attenuationDistance = 1.0f;
         milk.attenuationColor = milk.multiscatterColor = vec3(0.5f);
         addTriangles(s);
       }},
      {"nested solids",
       [](scene::Scene& s, scene::Environment&) {
         scene::Material& glass = addPane(s);
         glass.thickness = glass.dielectricPriority = 1.0f;
         addTriangles(s);
       }},
      {"triangle lights",
       [](scene::Scene& s, scene::Environment&) { (addMaterial(s).emissive = vec3(1.0f), addTriangles(s)); }},
      {"lamps", [](scene::Scene& s, scene::Environment&) { s.lights.emplace_back(); }},
      {"sky", [](scene::Scene&, scene::Environment& e) { e.constant = vec3(1.0f); }},
      {"solids", [](scene::Scene& s, scene::Environment&) { addSolid(s); }},
      {"trees", [](scene::Scene& s, scene::Environment&) { addSolid(s).kind = scene::PrimitiveSetKind::csg; }},
      {"tori", [](scene::Scene& s, scene::Environment&) { addSolid(s, scene::PrimitiveType::torus); }},
      {"solid lights",
       [](scene::Scene& s, scene::Environment&) { (addMaterial(s).emissive = vec3(1.0f), addSolid(s)); }},
      {"solid panes", [](scene::Scene& s, scene::Environment&) { (addPane(s), addSolid(s)); }},
      {"solid veils", [](scene::Scene& s, scene::Environment&) { (addVeil(s), addSolid(s)); }},
      {"solid cut-outs",
       [](scene::Scene& s, scene::Environment&) { (addVeil(s).alphaMode = scene::AlphaMode::mask, addSolid(s)); }},
      {"vertex colors", [](scene::Scene& s, scene::Environment&) { addTriangles(s).colors.assign(3, vec4(1.0f)); }},
      {"textures", [](scene::Scene& s, scene::Environment&) {
         scene::Material& m = addMaterial(s);
         for (const scene::MaterialTexture& texture : scene::kMaterialTextures) (m.*texture.use).texture = 0;
         addTriangles(s);
       }}};
  return kFeatures;
}

Defines definesOf(const std::vector<Change>& changes, bool quirks = false) {
  scene::Scene scene;
  scene::Environment environment;
  for (const Change change : changes) change(scene, environment);
  gpu::Quirks device{};
  device.corruptsHitAttributes = quirks;
  return shaderDefines(sceneFeatures(scene, environment), device);
}

std::vector<Change> allFeatures() {
  std::vector<Change> all;
  for (const auto& [name, change] : features()) all.push_back(change);
  return all;
}

// Returns the QUINTET_NO_… names.
std::set<std::string> absent(const Defines& defines) {
  std::set<std::string> names;
  for (const auto& [name, value] : defines)
    if (name.starts_with("QUINTET_NO_")) names.insert(name);
  return names;
}

class PayloadSize : public ::testing::Test {
 protected:
  // Returns the largest size of each payload type, by the type's name.
  std::map<std::string, std::uint64_t> sizes(const Defines& defines) const {
    const program::CompiledProgram compiled = program::compile(program_, compiler_, defines);
    for (const Diagnostic& d : compiled.diagnostics) ADD_FAILURE() << d.format();
    std::map<std::string, std::uint64_t> result;
    std::set<std::string> seen;
    for (const program::PayloadSize& payload : program::payloadSizes(compiled)) {
      EXPECT_GT(payload.bytes, 0u) << payload.stage << " " << payload.type;
      result[payload.type] = std::max(result[payload.type], payload.bytes);
      seen.insert(payload.stage);
    }
    for (const program::CompiledProgram::Stage& stage : compiled.stages) {
      const bool always = stage.kind == shader::Stage::rayGeneration || stage.kind == shader::Stage::miss;
      EXPECT_TRUE(!always || seen.contains(stage.file)) << stage.file;
    }
    return result;
  }
  static std::uint64_t largest(const std::map<std::string, std::uint64_t>& sizes) {
    std::uint64_t most = 0;
    for (const auto& [type, bytes] : sizes) most = std::max(most, bytes);
    return most;
  }

  program::Program program_ = program::loadProgram("pathtracer");
  shader::Compiler compiler_{{.optimize = false}};  // faster, and unused members stay
};

// The scenes of this test cover all features of scene_features.h. A new feature must be added here.
TEST_F(PayloadSize, CoversEveryFeature) {
  const std::set<std::string> all = absent(definesOf({}));
  EXPECT_GE(all.size(), 16u);
  EXPECT_EQ(absent(definesOf(allFeatures())), std::set<std::string>());
  for (const std::string& name : all)
    EXPECT_TRUE(std::ranges::any_of(features(), [&](const auto& f) {
      return !absent(definesOf({f.second})).contains(name);
    })) << name;
  for (const auto& [name, change] : features()) EXPECT_NE(definesOf({change}), definesOf({})) << name;
}

TEST_F(PayloadSize, IsAtMost64BytesForEachFeature) {
  for (const auto& [name, change] : features()) {
    const auto found = sizes(definesOf({change}));
    EXPECT_EQ(found.size(), 2u) << name;
    EXPECT_LE(largest(found), kMaxBytes) << name;
  }
}

// Without features, a hit has t, instance, geometry, primitive and two coordinates, and a shadow ray one word for
// visibility. All features add a solid's part and the seed to a hit, and the seed and a transmittance to a shadow ray.
// AOVs and driver workarounds add nothing.
TEST_F(PayloadSize, HasKnownSizesWithoutAndWithAllFeatures) {
  using Sizes = std::map<std::string, std::uint64_t>;
  EXPECT_EQ(sizes(definesOf({})), (Sizes{{"HitPayload", 24}, {"ShadowPayload", 4}}));
  const Sizes everything{{"HitPayload", 32}, {"ShadowPayload", 20}};
  EXPECT_EQ(sizes(definesOf(allFeatures())), everything);
  Defines defines = definesOf(allFeatures(), true);
  EXPECT_GT(defines.size(), definesOf(allFeatures()).size());
  for (const program::Output& output : program_.outputs) defines.emplace_back("QUINTET_OUTPUT_" + output.name, "1");
  EXPECT_EQ(sizes(defines), everything);
  EXPECT_LE(largest(everything), kMaxBytes);
}

// A payload that is too large, with 72 bytes, is detected.
TEST_F(PayloadSize, IsReadFromTheShaders) {
  program::CompiledProgram compiled;
  for (const char* qualifier : {"rayPayloadEXT", "rayPayloadInEXT"}) {
    shader::Source source{.stage = shader::Stage::closestHit, .name = "large.rchit", .defines = {}, .virtualFiles = {}};
    source.text = std::string(
                      "#version 460\n#extension GL_EXT_ray_tracing : require\nstruct Large { vec3 a; float b[13]; "
                      "uvec2 c; };\n") +
                  "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\nlayout(location = 0) " +
                  qualifier +
                  " Large p;\nvoid main() { p.a = vec3(1.0); p.b[gl_PrimitiveID] = 2.0; p.c.y = 1u;\n"
                  "traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, p.a, 0.0, p.a, 1.0, 0); }\n";
    const shader::Result result = compiler_.compile(source);
    ASSERT_TRUE(result.ok()) << result.diagnostics.front().format();
    compiled.stages.push_back({source.name, source.stage, result.spirv});
  }
  for (const program::PayloadSize& payload : program::payloadSizes(compiled))
    EXPECT_EQ(payload.bytes, 72u) << payload.type;
  EXPECT_EQ(program::payloadSizes(compiled).size(), 2u);
}

}  // namespace
}  // namespace quintet::render
