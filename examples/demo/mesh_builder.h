// SPDX-License-Identifier: Apache-2.0
// Solids and sheets for the scenes. Every solid is closed, has normals and the front outside, and rests on the plane y
// = 0 unless stated otherwise. u and v are stated where they are useful.
#ifndef QUINTET_DEMO_MESH_BUILDER_H
#define QUINTET_DEMO_MESH_BUILDER_H

#include <functional>
#include <span>
#include <vector>

#include "demo/mesh.h"

namespace quintet::demo {

// The sheet point(u, v) over [0,1]², with front dp/du × dp/dv and uv = (u, v), without normals. With wrapU or wrapV,
// the last row equals the first one bit for bit. Degenerate triangles (at poles) are omitted.
TriangleMesh parametric(int uCount, int vCount, bool wrapU, bool wrapV, const std::function<vec3(float, float)>& point);

// Sphere centered at the origin from a subdivided icosahedron: 20 · 4^level triangles. `facets` gives flat faces.
TriangleMesh icosphere(float radius, int level, bool facets = false);

// Surface of revolution about y. Points of the profile are (radius, height). The profile of a solid starts and ends at
// radius 0 and has the solid on its left. u runs around the axis, v along the profile.
TriangleMesh revolve(std::span<const vec2> profile, int segments, float creaseDegrees = 180.0f);

// Smooth curve through the points (centripetal Catmull-Rom; Yuksel et al. 2011), with `perSpan` steps between two
// points.
std::vector<vec2> smoothCurve(std::span<const vec2> points, int perSpan);

// Profile of a disc with a rounded edge, for `revolve`.
std::vector<vec2> discProfile(float radius, float height, float bevel, int bevelSteps);

// Superellipsoid |x/a|^n + |y/b|^n + |z/c|^n = 1 (Barr 1981), a projected cube centered at the origin.
TriangleMesh superellipsoid(vec3 halfSize, float exponent, int perEdge);

// Torus knot (p, q), centered at the origin: p times around the z axis, q times through the hole. `radius` is the major
// radius of the supporting torus, `swing` its minor radius, `tube` the radius of the rope. u runs along the rope, v
// around it.
TriangleMesh torusKnot(int p, int q, float radius, float swing, float tube, int along, int around);

struct PrismShape {
  int sides = 5;
  float radius = 0.1f;     // to the corners, before rounding
  float rounding = 0.02f;  // radius of the vertical edges
  float bevel = 0.006f;    // radius of the rims
  float height = 0.4f;
  float twist = 1.0f;  // radians, bottom to top
  float taper = 1.0f;  // top size / bottom size
  int perSide = 24;    // vertices per side of the outline
  int rings = 96;
};
TriangleMesh twistedPrism(const PrismShape& shape);

// Axis-aligned box with flat faces.
TriangleMesh box(vec3 low, vec3 high);

// Parallelogram corner + u·a + v·b with front a × b and uv = (u, v).
TriangleMesh quad(vec3 corner, vec3 a, vec3 b);

// Flat ring at y = 0 with front +y and uv = (x, z) / metersPerTile; a disc if inner = 0.
TriangleMesh flatDisc(float inner, float outer, int segments, float metersPerTile);

// Rope along the curve, closed at both ends. The radius changes linearly.
TriangleMesh tube(std::span<const vec3> curve, float startRadius, float endRadius, int around);

// Pointed leaf (one sheet) from `base` along `direction`. `up` is approximately the normal of its front.
TriangleMesh leaf(vec3 base, vec3 direction, vec3 up, float length, float width, float bend);

}  // namespace quintet::demo
#endif
