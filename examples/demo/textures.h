// SPDX-License-Identifier: Apache-2.0
// Procedural materials as images: base color (sRGB), roughness and metalness (g and b as in glTF), tangent-space
// normals (y up) from a height field. All textures repeat without a seam.
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
  float height = 0.0f;  // meters
};

struct SurfaceMaps {
  io::Image baseColor;
  io::Image metallicRoughness;
  io::Image normal;
};

// Evaluates texel(u, v) on a size × size grid. `metersPerTile` is the side of a tile, for the slopes of the normals.
SurfaceMaps bake(std::uint32_t size, float metersPerTile, const std::function<Texel(float, float)>& texel);

// Oiled oak boards in a herringbone pattern. One tile is 20 board widths.
inline constexpr float kOakTile = 1.8f;  // meters
SurfaceMaps oakHerringbone(std::uint32_t size);

// Honed white marble with gray veins.
inline constexpr float kMarbleTile = 1.6f;  // meters
SurfaceMaps marble(std::uint32_t size);

// Metal brushed along u. The base color is white; the material tints it.
SurfaceMaps brushedMetal(std::uint32_t size, float roughness);

// A leaf with its outline in alpha (RGBA, sRGB).
io::Image leafCutout(std::uint32_t size);

}  // namespace quintet::demo
#endif
