// Procedural materials as pictures: base colour (sRGB), occlusion-free roughness and metalness (glTF's
// g and b), tangent-space normals (y up) from a height field. All repeat without a seam.
#ifndef QUINTET_DEMO_TEXTURES_H
#define QUINTET_DEMO_TEXTURES_H

#include <cstdint>
#include <functional>

#include "base/math.h"
#include "io/image.h"

namespace quintet::demo {

struct Texel {
  vec3 color{1.0f};  // linear reflectance
  float roughness = 1.0f;
  float metallic = 0.0f;
  float height = 0.0f;  // metres
};

struct SurfaceMaps {
  io::Image baseColor;
  io::Image metallicRoughness;
  io::Image normal;
};

// Evaluates texel(u, v) on a size × size grid that spans metresPerTile.
SurfaceMaps bake(std::uint32_t size, float metresPerTile, const std::function<Texel(float, float)>& texel);

// Oiled oak boards laid in herringbone. One tile is 20 board widths.
inline constexpr float kOakTile = 1.8f;  // metres
SurfaceMaps oakHerringbone(std::uint32_t size);

// Honed white marble with grey veins.
inline constexpr float kMarbleTile = 1.6f;  // metres
SurfaceMaps marble(std::uint32_t size);

// Metal brushed along u; white base colour, to be tinted by the material.
SurfaceMaps brushedMetal(std::uint32_t size, float roughness);

// A leaf with its outline in alpha (RGBA, sRGB).
io::Image leafCutout(std::uint32_t size);

}  // namespace quintet::demo
#endif
