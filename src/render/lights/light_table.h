// SPDX-License-Identifier: Apache-2.0
// All lights of a scene and the data that samples them (shared::Frame::lights, lightNodes, lightTable, lightSlots).
#ifndef QUINTET_RENDER_LIGHTS_LIGHT_TABLE_H
#define QUINTET_RENDER_LIGHTS_LIGHT_TABLE_H

#include <span>

#include "quintet/shared/frame.h"
#include "render/lights/environment_table.h"
#include "render/lights/light_emitters.h"
#include "render/lights/light_tree.h"

namespace quintet::render {

// Largest number of lights whose scratch memory and tables are kept for the next edit.
inline constexpr std::size_t kKeptLights = std::size_t{1} << 20;

struct LightTable {
  // The punctual lights in the scene's order, then all triangles or solids of each emissive geometry of each instance,
  // then the environment. Lights without power are listed but never sampled. Empty if nothing emits.
  std::vector<shared::LightData> lights;
  std::vector<shared::LightNode> nodes;     // light_tree.h
  std::vector<shared::AliasEntry> entries;  // one per light: sampling by power alone
  // One per geometry of each instance: index in `lights` of its triangle or solid 0 (triangle p is p entries later), or
  // kNoLight.
  std::vector<std::uint32_t> slots;
  std::vector<std::uint32_t> firstSlots;  // one per instance: index in `slots` of its first geometry
  std::uint32_t environmentLight = shared::kNoLight;
  EnvironmentTable environment;  // of the environment in use

  bool hasNoPower() const { return entries.empty(); }
  void clear();  // discards lights and slots
};

// Each class of lights (point and spot; directional; triangles and solids; environment) with any power gets at least
// this share of the samples. The rest is distributed by power. A huge sky or a distant sun must not starve the lamp on
// the desk, nor the other way round. This applies to sampling by power; the share of the tree is kLightShare
// (lights/tree.glsl).
inline constexpr double kMinimumClassShare = 0.1;

// Bounds the memory that a forest of emissive instances takes: 140 bytes per light.
inline constexpr std::size_t kMaxTriangleLights = std::size_t{1} << 23;

// Builds the tables of lights. LightData::instance is the index in scene.instances, LightData::geometry the index in
// its mesh.
//
// Power as luminance: 4π·I for a point light; I times the effective solid angle for a spot light; E·π·R² for a
// directional light and ∫L·π·R² for the environment, with the radius R of the scene's bounds; π·area·L for a triangle
// or solid, with the mean L of its texture. Intensity in the tree: I for point and spot lights; area·L for a triangle
// and a quarter of it for a solid; the irradiance of a directional light; a quarter of ∫L for the environment.
//
// Unlit and invisible materials and CSG trees are not lights; only BSDF sampling finds their emission. If the emissive instance
// geometries have more than `maxTriangleLights` triangles in total, the largest of them are left to BSDF sampling, too.
// Any table that contains all lights gives an unbiased image; the table affects noise only.
class LightTableBuilder {
 public:
  LightTableBuilder(const scene::Scene& scene, const scene::Environment& environmentInUse,
                    std::size_t maxTriangleLights = kMaxTriangleLights);
  // Builds the table for these transforms, one per instance, in the memory of an earlier table. Lights, slots and the
  // environment's index are the same for all transforms. LightTable::environment is left as it is.
  void build(std::span<const mat4> worldFromObject, LightTable& table);
  EnvironmentTable& environment() { return environment_; }

  // Edits for the next build(). The scene has the same meshes and instances as that of the constructor.
  void setPunctualLights(const std::vector<scene::Light>& lights) { punctual_ = lights; }
  // Sets the emission of the materials. Recomputes only the emitters of materials whose emission changed. Returns false if
  // none changed.
  bool setEmission(const scene::Scene& scene);
  // `integral`: EnvironmentTable::integral; 0 means that the environment is black.
  void setEnvironment(double integral) { environmentIntegral_ = integral; }
  double environmentIntegral() const { return environmentIntegral_; }

  // Something that an animation moves or deforms has lights, or a punctual light follows a node.
  bool hasMovingLights() const { return hasMovingLights_; }
  bool hasLights(std::size_t instance) const { return lit_[instance]; }  // so that its transform matters
  // Makes the builder independent of the scene, which can then be destroyed.
  void copyGeometry() { emitters_.copyGeometry(); }
  // Whether build() depends on the vertices of a geometry of a deformed mesh. After copyGeometry().
  bool hasPositions(std::size_t mesh, std::size_t geometry) const { return emitters_.hasPositions(mesh, geometry); }
  // Vertices of a deformed mesh, for the next build(). After copyGeometry().
  void setPositions(std::size_t mesh, std::size_t geometry, std::span<const vec3> positions) {
    emitters_.setPositions(mesh, geometry, positions);
  }

 private:
  struct Part {
    std::size_t instance;
    std::size_t geometry;
    std::size_t slot;
    std::size_t mesh;
    std::size_t count;
  };
  struct Collector;
  // What is built for each light of the table. It is kept, because new memory costs as much time as an edit of lights.
  struct Scratch {
    std::vector<double> powers;
    std::vector<float> weights;
    std::vector<LightTreeInput> bounds;
    LightTree tree;
  };
  void addParts(const scene::Scene& scene);

  std::vector<scene::Light> punctual_;
  Emitters emitters_;
  std::vector<Part> parts_;
  std::vector<bool> lit_;  // by instance: it has a part
  std::vector<std::uint32_t> slots_, firstSlots_;
  EnvironmentTable environment_;
  std::size_t maxTriangleLights_;
  double environmentIntegral_ = 0.0;
  double crossSection_ = 0.0;  // π·R², m²
  bool hasMovingLights_ = false;
  Scratch scratch_;
};

// Builds the table at frame 0, including the environment.
LightTable buildLightTable(const scene::Scene& scene, const scene::Environment& environmentInUse,
                           std::size_t maxTriangleLights = kMaxTriangleLights);

// Returns the integral of KHR_lights_punctual's angular attenuation over the sphere, in sr.
double spotSolidAngle(double cosInner, double cosOuter);

}  // namespace quintet::render
#endif
