// SPDX-License-Identifier: Apache-2.0
#include "render/scene/scene_features.h"

#include <fmt/format.h>

#include <algorithm>

#include "program/inline_traces.h"
#include "quintet/shared/material.h"
#include "scene/model/material_textures.h"
#include "scene/model/surface_class.h"

namespace quintet::render {
namespace {

// What any primitive set of the scene is or holds.
struct ProceduralFeatures {
  bool solids = false;  // or trees
  bool csg = false;
  bool torus = false;
  bool alpha = false;
  bool panes = false;
  bool lights = false;  // solids, not trees
};

bool emits(const scene::Material& m) { return glm::any(glm::greaterThan(m.emissive, vec3(0.0f))); }

// At any time of the animation.
bool everEmits(const scene::Scene& scene, int material) {
  if (material == scene::kNone) return false;
  const auto m = static_cast<std::size_t>(material);
  return emits(scene.materials[m]) ||
         (m < scene.materialStates.size() && std::ranges::any_of(scene.materialStates[m], emits));
}

ProceduralFeatures proceduralFeatures(const scene::Scene& scene) {
  ProceduralFeatures features;
  for (const scene::Mesh& mesh : scene.meshes) {
    for (const scene::PrimitiveSet& set : mesh.primitiveSets) {
      features.solids |= set.kind != scene::PrimitiveSetKind::custom;
      features.csg |= set.kind == scene::PrimitiveSetKind::csg;
      features.torus |= std::ranges::count(set.primitives, scene::PrimitiveType::torus, &scene::Primitive::type) > 0;
      features.lights |=
          set.kind == scene::PrimitiveSetKind::solids &&
          std::ranges::any_of(set.primitives, [&](const scene::Primitive& p) { return everEmits(scene, p.material); });
      features.panes |= scene::isPane(scene, set);
      features.alpha |= set.kind != scene::PrimitiveSetKind::custom && scene::needsAlphaTest(scene, set);
    }
  }
  return features;
}

// Bit k: a material has texture shared::kTexture… k.
std::uint32_t textureSlots(const scene::Scene& scene) {
  std::uint32_t slots = 0;
  for (const scene::Material& m : scene.materials) {
    for (std::uint32_t k = 0; k < shared::kTextureCount; ++k)
      if ((m.*scene::kMaterialTextures[k].use).used()) slots |= 1u << k;
  }
  return slots;
}

// True if a triangle geometry of the scene fulfils the condition.
template <class Predicate>
bool anyGeometry(const scene::Scene& scene, Predicate predicate) {
  return std::ranges::any_of(scene.meshes,
                             [&](const scene::Mesh& mesh) { return std::ranges::any_of(mesh.geometries, predicate); });
}

template <class Predicate>
bool anyPrimitives(const scene::Scene& scene, Predicate predicate) {
  return std::ranges::any_of(
      scene.meshes, [&](const scene::Mesh& mesh) { return std::ranges::any_of(mesh.primitiveSets, predicate); });
}

bool anyTintsShadows(const scene::Scene& scene) {
  const auto tints = [&](const auto& geometry) { return scene::tintsShadows(scene, geometry); };
  return anyGeometry(scene, tints) || anyPrimitives(scene, tints);
}

}  // namespace

SceneFeatures sceneFeatures(const scene::Scene& scene, const scene::Environment& environment) {
  const auto any = [&](auto predicate) {
    return std::ranges::any_of(scene.materials, predicate) ||
           std::ranges::any_of(scene.materialStates,
                               [&](const auto& states) { return std::ranges::any_of(states, predicate); });
  };
  const float intensity = environment.values.empty() ? environment.intensity : 1.0f;  // at any time
  const vec3 environmentScale = intensity * (environment.image.empty() ? environment.constant : vec3(1.0f));

  SceneFeatures features;
  Defines& defines = features.defines;
  const auto without = [&](const char* name, bool present) {
    if (!present) defines.emplace_back(name, "1");
  };
  without("QUINTET_NO_SOLID_TRANSMISSION", any([](const scene::Material& m) {
            return (m.transmission > 0.0f || m.diffuseTransmission > 0.0f) && m.thickness > 0.0f;
          }));
  without("QUINTET_NO_THIN_TRANSMISSION",
          any([](const scene::Material& m) { return m.transmission > 0.0f && !(m.thickness > 0.0f); }));
  without("QUINTET_NO_PANES", any([](const scene::Material& m) { return scene::isPane(m); }));
  without("QUINTET_NO_TRANSMITTANCE", anyTintsShadows(scene));
  without("QUINTET_NO_CLEARCOAT", any([](const scene::Material& m) { return m.clearcoat > 0.0f; }));
  without("QUINTET_NO_SHEEN", any([](const scene::Material& m) { return m.sheenColor != vec3(0.0f); }));
  without("QUINTET_NO_DIFFUSE_TRANSMISSION",
          any([](const scene::Material& m) { return m.diffuseTransmission > 0.0f; }));
  without("QUINTET_NO_ANISOTROPY", any([](const scene::Material& m) { return m.anisotropy > 0.0f; }));
  without("QUINTET_NO_IRIDESCENCE", any([](const scene::Material& m) { return m.iridescence > 0.0f; }));
  without("QUINTET_NO_DISPERSION", any([](const scene::Material& m) {
            return m.dispersion > 0.0f && m.transmission > 0.0f && m.thickness > 0.0f && m.ior > 0.0f;
          }));
  without("QUINTET_NO_SCATTERING", any([](const scene::Material& m) { return scene::scatters(m); }));
  without("QUINTET_NO_NESTED_MEDIA",
          any([](const scene::Material& m) { return scene::isMedium(m) && m.dielectricPriority != 0.0f; }));
  const bool emitters = any(emits);
  const bool environmentLight = glm::any(glm::greaterThan(environmentScale, vec3(0.0f)));
  without("QUINTET_NO_TRIANGLE_LIGHTS", emitters);
  without("QUINTET_NO_PUNCTUAL_LIGHTS", !scene.lights.empty());
  without("QUINTET_NO_ENVIRONMENT", environmentLight);
  // A surface that emits counts as several lights: its triangles.
  without("QUINTET_NO_LIGHT_TREE", emitters || scene.lights.size() + (environmentLight ? 1 : 0) > 1);
  const ProceduralFeatures procedural = proceduralFeatures(scene);
  without("QUINTET_NO_PROCEDURALS", procedural.solids);
  without("QUINTET_NO_CSG", procedural.csg);
  without("QUINTET_NO_TORUS", procedural.torus);
  without("QUINTET_NO_PROCEDURAL_ALPHA", procedural.alpha);
  without("QUINTET_NO_PROCEDURAL_PANES", procedural.panes);
  without("QUINTET_NO_SOLID_LIGHTS", procedural.lights);
  const bool alphaTriangles =
      anyGeometry(scene, [&](const scene::Geometry& g) { return scene::needsAlphaTest(scene, g); });
  without("QUINTET_NO_SEEDS", procedural.alpha || alphaTriangles);
  without("QUINTET_NO_VERTEX_COLORS", anyGeometry(scene, [](const scene::Geometry& g) { return !g.colors.empty(); }));
  defines.emplace_back("QUINTET_TEXTURE_SLOTS", fmt::format("{:#x}u", textureSlots(scene)));
  features.alpha = alphaTriangles || anyPrimitives(scene, [&](const scene::PrimitiveSet& set) {
                     return scene::needsAlphaTest(scene, set);
                   });
  features.panes = anyGeometry(scene, [&](const scene::Geometry& g) { return scene::isPane(scene, g); });
  features.boxes = anyPrimitives(scene, [](const scene::PrimitiveSet&) { return true; });
  return features;
}

Defines shaderDefines(const SceneFeatures& features, const gpu::Quirks& quirks) {
  Defines defines = features.defines;
  // A driver that traverses on the CPU compiles there, too: 10 to 60 s for a variant of the path tracer. Its disk cache helps
  // only scenes with the same variant. What the code for textures and vertex colors costs was not measurable.
  if (quirks.slowInstances)
    std::erase_if(defines, [](const auto& define) {
      return define.first == "QUINTET_TEXTURE_SLOTS" || define.first == "QUINTET_NO_VERTEX_COLORS";
    });
  if (quirks.slowInstances) defines.emplace_back("QUINTET_MERGED_INSTANCES", "1");
  if (quirks.slowTraceCalls && !features.boxes && !features.panes) defines.emplace_back(program::kInlineTraces, "1");
  if (!quirks.corruptsHitAttributes) return defines;
  defines.emplace_back("QUINTET_CORRUPTS_HIT_ATTRIBUTES", "1");
  if (features.alpha) defines.emplace_back("QUINTET_RECOMPUTE_BARYCENTRICS", "1");
  return defines;
}

}  // namespace quintet::render
