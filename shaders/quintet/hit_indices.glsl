// SPDX-License-Identifier: Apache-2.0
// The indices of a candidate or a hit as the driver reports them. Built-in variables of hit shaders have them
// (hit_geometry.glsl), and ray queries return them (ray_query.glsl). Any stage can include this file.
#ifndef QUINTET_HIT_INDICES_GLSL
#define QUINTET_HIT_INDICES_GLSL

#include "frame.glsl"

struct HitIndices {
  uint instance;   // gl_InstanceCustomIndexEXT
  uint geometry;   // gl_GeometryIndexEXT
  uint primitive;  // gl_PrimitiveID
};

GeometryData geometryOf(uint instance, uint geometry) {
  return GeometryArray(frame.geometries).at[InstanceArray(frame.instances).at[instance].firstGeometry + geometry];
}

// Index of a triangle (box, solid, CSG tree) in the scene's order; `primitive` is the driver's.
uint scenePrimitive(GeometryData geometry, uint primitive) {
  return geometry.primitiveMap != 0ul ? PrimitiveIndexArray(geometry.primitiveMap).at[primitive] : primitive;
}

#endif
