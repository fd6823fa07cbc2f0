// SPDX-License-Identifier: Apache-2.0
// Lights, and the tables from which they are sampled.
#ifndef QUINTET_SHARED_LIGHTS_H
#define QUINTET_SHARED_LIGHTS_H

#include "types.h"

QT_SHARED_BEGIN

// Entry of a Walker/Vose alias table: entry i is kept with probability `keep`; otherwise `alias` is used.
struct AliasEntry {
  float keep;  // [0,1]
  uint alias;
  float probability;  // of sampling i; the sum over all entries is 1
};
QT_SHARED_SIZE(AliasEntry, 12);

// LightData::type
QT_CONSTANT kLightPoint = 0u;
QT_CONSTANT kLightSpot = 1u;
QT_CONSTANT kLightDirectional = 2u;
QT_CONSTANT kLightTriangle = 3u;     // emissive triangle of an instance
QT_CONSTANT kLightEnvironment = 4u;  // the environment; EnvironmentData has the table of its directions
QT_CONSTANT kLightSolid = 5u;        // emissive sphere, box, cylinder, cone or torus of an instance

struct LightData {
  vec3 intensity;  // point, spot: W/sr; directional: W/m²; others unused
  uint type;
  vec3 position;   // world; point, spot
  uint instance;   // triangle, solid
  vec3 direction;  // world, unit, in which the light travels; spot, directional
  uint
      geometry;  // triangle, solid: geometry index in the instance's mesh; point, spot: the bits of the float 1 / range
  float cosInner;  // spot
  float cosOuter;  // spot
  uint primitive;  // triangle, solid: original index in the geometry
  uint leaf;       // its LightNode, or kNoLight if it is never sampled
};
QT_SHARED_SIZE(LightData, 64);

// LightNode::link
QT_CONSTANT kLightNodeLeaf = 0x80000000u;       // the index is a light's, not the first child's
QT_CONSTANT kLightNodeInfinite = 0x40000000u;   // directional lights, environment
QT_CONSTANT kLightNodeBothSides = 0x20000000u;  // the cone contains lines, not directions
QT_CONSTANT kLightNodeShare = 0x10000000u;      // first child: both children have at least the probability kLightShare
QT_CONSTANT kLightNodeIndex = 0x0FFFFFFFu;

// A node of the tree of lights (quintet/lights/tree.glsl; built by src/render/lights/light_tree.h): bounds of the lights
// below it. Node 0 is the root. The two children of a node are adjacent. All descendants of the first child come before
// all descendants of the second.
struct LightNode {
  vec3 center;      // world; mean position of the lights, weighted by intensity; infinite: unused
  float radius;     // meters; of a ball around the center that contains the lights
  float intensity;  // sum of their largest radiant intensities, as luminance; infinite: irradiance instead. Scaled
  uint axis;        // octahedral, 2 x snorm 16: axis of a cone of their normals; infinite: of the directions to them
  uint cone;        // 2 x snorm 16: cosines of thetaO and thetaE (Conty Estevez and Kulla 2018)
  uint link;        // flags and index of the first child or the light
};
QT_SHARED_SIZE(LightNode, 32);

// Equirectangular environment (scene::Environment): u = atan2(d.z, d.x)/2π + 0.5, v = acos(d.y)/π after
// rotating d by -rotation about y. Radiance = scale · texel.
struct EnvironmentData {
  Address table;  // AliasEntry[width · height]: texels by luminance · solid angle; 0 means black or no environment
  Address balancedTable;  // the same size, by the luminance above its mean over the sphere (quintet/lights/environment.glsl)
  vec3 scale;     // multiplies the texture; the radiance itself when texture is kNoTexture
  uint texture;   // bindless index or kNoTexture
  uint width;     // texels of the table
  uint height;
  float cosRotation;
  float sinRotation;
};
QT_SHARED_SIZE(EnvironmentData, 48);

QT_SHARED_END

#endif
