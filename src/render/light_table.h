// All lights of a scene and what chooses among them (shared::Frame::lights, lightNodes, lightTable, lightSlots).
#ifndef QUINTET_RENDER_LIGHT_TABLE_H
#define QUINTET_RENDER_LIGHT_TABLE_H

#include <span>

#include "quintet/shared/frame.h"
#include "render/environment_table.h"
#include "render/light_emitters.h"

namespace quintet::render {

struct LightTable {
  // First the punctual lights in the scene's order, then all triangles or solids of each emissive instance geometry,
  // then the environment. Lights without power are in the list but never drawn. Empty: nothing emits.
  std::vector<shared::LightData> lights;
  std::vector<shared::LightNode> nodes;     // light_tree.h
  std::vector<shared::AliasEntry> entries;  // one per light: the choice by power alone
  // One per geometry of each instance: index of its triangle or solid 0 in `lights` (p: + p), or kNoLight.
  std::vector<std::uint32_t> slots;
  std::vector<std::uint32_t> firstSlots;  // one per instance: where its geometries begin in `slots`
  std::uint32_t environmentLight = shared::kNoLight;
  EnvironmentTable environment;  // of environmentInUse

  bool dark() const { return entries.empty(); }  // no light has any power
  void clear();                                  // lights and slots
};

// Each class of lights (point and spot; directional; triangles and solids; environment) with any power gets at least
// this share of the samples, the rest is shared by power: a huge sky or a distant sun must not starve the
// lamp on the desk, nor the other way round. Of the choice by power; the tree's is kLightShare (lights/tree.glsl).
inline constexpr double kMinimumClassShare = 0.1;

// So that a forest of emissive instances does not fill the memory: 140 bytes for each light.
inline constexpr std::size_t kMaxTriangleLights = std::size_t{1} << 23;

// LightData::instance is the index in scene.instances, LightData::geometry the index in its mesh. Power, as
// luminance: point 4π·I; spot I · its effective solid angle; directional E·π·R² and environment ∫L·π·R² with
// the radius R of the scene's bounds; triangle and solid π·area·L with the mean L of its texture. Intensity, in the tree:
// point and spot I; triangle area·L, solid a quarter of it; irradiance of directional lights, a quarter of ∫L of the
// environment. Unlit materials and trees of solids make no lights (BSDF sampling alone sees them). Any table that leaves
// no light out is unbiased; this is about noise.
// Instance geometries beyond maxTriangleLights triangles in all (the largest first) are left to BSDF sampling, too.
class LightTableBuilder {
 public:
  LightTableBuilder(const scene::Scene& scene, const scene::Environment& environmentInUse,
                    std::size_t maxTriangleLights = kMaxTriangleLights);
  // With the instances at these places (world from object, one each). Lights, slots and the environment's index are the
  // same for all places; LightTable::environment is left empty.
  LightTable build(std::span<const mat4> places) const;
  EnvironmentTable& environment() { return environment_; }

  bool moves() const { return moves_; }  // an instance with keyframes has lights
  void keep();                           // from here on without the scene

 private:
  struct Part {
    std::size_t instance;
    std::size_t geometry;
    std::size_t slot;
    std::size_t mesh;
    std::size_t count;
  };
  struct Collector;
  void addParts(const scene::Scene& scene, std::size_t maxCount);

  std::vector<scene::Light> punctual_;
  std::vector<std::vector<Emitter>> emitters_;  // by mesh and geometry
  std::vector<Part> parts_;
  std::vector<std::uint32_t> slots_, firstSlots_;
  EnvironmentTable environment_;
  double environmentIntegral_ = 0.0;
  double crossSection_ = 0.0;  // π·R², m²
  bool moves_ = false;
};

// All at once, at frame 0.
LightTable buildLightTable(const scene::Scene& scene, const scene::Environment& environmentInUse,
                           std::size_t maxTriangleLights = kMaxTriangleLights);

// ∫ of KHR_lights_punctual's angular attenuation over the sphere, sr.
double spotSolidAngle(double cosInner, double cosOuter);

}  // namespace quintet::render
#endif
