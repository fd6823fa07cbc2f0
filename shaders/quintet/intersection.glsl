// SPDX-License-Identifier: Apache-2.0
// A triangle that a ray has intersected, as the driver reports it: by indices in the acceleration structure. Hit shaders have
// these indices in built-in variables (hit_geometry.glsl), ray queries return them (ray_query.glsl). Any stage can include this
// file.
#ifndef QUINTET_INTERSECTION_GLSL
#define QUINTET_INTERSECTION_GLSL

#include "frame.glsl"

struct Intersection {
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
