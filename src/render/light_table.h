// All lights of a scene and the table that chooses among them (shared::Frame::lights, lightTable, lightSlots).
#ifndef QUINTET_RENDER_LIGHT_TABLE_H
#define QUINTET_RENDER_LIGHT_TABLE_H

#include "quintet/shared/frame.h"
#include "render/environment_table.h"

namespace quintet::render {

struct LightTable {
  // First the punctual lights in the scene's order, then all triangles or solids of each emissive instance geometry,
  // then the environment. Lights without power are in the list but never drawn. Empty: nothing emits.
  std::vector<shared::LightData> lights;
  std::vector<shared::AliasEntry> entries;  // one per light
  // One per geometry of each instance: index of its triangle or solid 0 in `lights` (p: + p), or kNoLight.
  std::vector<std::uint32_t> slots;
  std::vector<std::uint32_t> firstSlots;    // one per instance: where its geometries begin in `slots`
  std::uint32_t environmentLight = shared::kNoLight;
  EnvironmentTable environment;             // of environmentInUse
};

// Each class of lights (point and spot; directional; triangles and solids; environment) with any power gets at least
// this share of the samples, the rest is shared by power: a huge sky or a distant sun must not starve the
// lamp on the desk, nor the other way round.
inline constexpr double kMinimumClassShare = 0.1;

// So that a forest of emissive instances does not fill the memory: 64 bytes and 12 for each light.
inline constexpr std::size_t kMaxTriangleLights = std::size_t{1} << 23;

// LightData::instance is the index in scene.instances, LightData::geometry the index in its mesh. Power, as
// luminance: point 4π·I; spot I · its effective solid angle; directional E·π·R² and environment ∫L·π·R² with
// the radius R of the scene's bounds; triangle and solid π·area·L with the mean L of its texture. Unlit materials and
// trees of solids make no lights (BSDF sampling alone sees them). Any table is unbiased; this is about noise.
// Instance geometries beyond maxTriangleLights triangles in all (the largest first) are left to BSDF sampling, too.
LightTable buildLightTable(const scene::Scene& scene, const scene::Environment& environmentInUse,
                           std::size_t maxTriangleLights = kMaxTriangleLights);

// ∫ of KHR_lights_punctual's angular attenuation over the sphere, sr.
double spotSolidAngle(double cosInner, double cosOuter);

}  // namespace quintet::render
#endif
