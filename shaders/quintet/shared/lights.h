// Lights and the tables from which they are drawn.
#ifndef QUINTET_SHARED_LIGHTS_H
#define QUINTET_SHARED_LIGHTS_H

#include "types.h"

QT_SHARED_BEGIN

// Walker/Vose alias table: entry i is kept with probability `keep`, else `alias` is taken.
struct AliasEntry {
  float keep;         // [0,1]
  uint alias;
  float probability;  // of drawing i itself, normalised: the sum over all entries is 1
};
QT_SHARED_SIZE(AliasEntry, 12);

// LightData::type
QT_CONSTANT kLightPoint = 0u;
QT_CONSTANT kLightSpot = 1u;
QT_CONSTANT kLightDirectional = 2u;
QT_CONSTANT kLightTriangle = 3u;     // emissive triangle of an instance
QT_CONSTANT kLightEnvironment = 4u;  // the whole environment; its direction comes from its own table
QT_CONSTANT kLightSolid = 5u;        // emissive sphere, box, cylinder, cone or torus of an instance

struct LightData {
  vec3 intensity;   // point, spot: W/sr; directional: W/m²; others unused
  uint type;
  vec3 position;    // world; point, spot
  uint instance;    // triangle, solid
  vec3 direction;   // world, unit, the way the light travels; spot, directional
  uint geometry;    // triangle, solid: geometry index in the instance's mesh
  float cosInner;   // spot
  float cosOuter;   // spot
  uint primitive;   // triangle, solid: original index in the geometry
  uint leaf;        // its LightNode, or kNoLight: never drawn
};
QT_SHARED_SIZE(LightData, 64);

// LightNode::link
QT_CONSTANT kLightNodeLeaf = 0x80000000u;       // the index is that of a light, not of the first child
QT_CONSTANT kLightNodeInfinite = 0x40000000u;   // directional lights, environment
QT_CONSTANT kLightNodeBothSides = 0x20000000u;  // the cone holds lines rather than directions
QT_CONSTANT kLightNodeShare = 0x10000000u;      // first child: it and the second get kLightShare of the draws at least
QT_CONSTANT kLightNodeIndex = 0x0FFFFFFFu;

// A node of the tree of lights (quintet/lights/tree.glsl; built by src/render/light_tree.h): bounds of the lights below
// it. Node 0 is the root; the two children of a node lie side by side, and all that is below the first child lies
// before all that is below the second.
struct LightNode {
  vec3 center;      // world; mean of the lights' places by intensity; infinite: unused
  float radius;     // metres; of a ball around it that holds the lights
  float intensity;  // sum of their largest radiant intensities, as luminance; infinite: irradiance instead. Scaled
  uint axis;        // octahedral, 2 x snorm 16: axis of a cone of their normals; infinite: of the directions to them
  uint cone;        // 2 x snorm 16: cosine of its half angle, and of the angle beyond it within which light leaves
  uint link;        // flags and index of the first child or the light
};
QT_SHARED_SIZE(LightNode, 32);

// Equirectangular environment (scene::Environment): u = atan2(d.z, d.x)/2π + 0.5, v = acos(d.y)/π after
// rotating d by -rotation about y. Radiance = scale · texel.
struct EnvironmentData {
  Address table;    // AliasEntry[width · height]: texels by luminance · solid angle; 0: none to sample (black or absent)
  vec3 scale;       // multiplies the texture; the radiance itself when texture is kNoTexture
  uint texture;     // bindless index or kNoTexture
  uint width;       // texels of the table
  uint height;
  float cosRotation;
  float sinRotation;
};
QT_SHARED_SIZE(EnvironmentData, 40);

QT_SHARED_END

#endif
