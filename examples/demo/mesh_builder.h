// The solids and sheets that the scenes are made of. Every solid is closed, with its fronts outside, rests
// on the plane y = 0 unless stated, and comes with normals; u and v are stated where they make sense.
#ifndef QUINTET_DEMO_MESH_BUILDER_H
#define QUINTET_DEMO_MESH_BUILDER_H

#include <functional>
#include <span>
#include <vector>

#include "demo/mesh.h"

namespace quintet::demo {

// The sheet point(u, v) over [0,1]², with front dp/du × dp/dv; uv = (u, v). wrapU, wrapV: the last row is
// the first again (bit for bit). Triangles that shrink to a line (poles) are left out. No normals.
TriangleMesh parametric(int uCount, int vCount, bool wrapU, bool wrapV, const std::function<vec3(float, float)>& point);

// Sphere around the origin from a subdivided icosahedron: 20 · 4^level triangles. With `facets` flat faces.
TriangleMesh icosphere(float radius, int level, bool facets = false);

// Surface of revolution about y. The profile's points are (radius, height); a solid's profile starts and
// ends at radius 0 and keeps the solid on its left. u runs round the axis, v along the profile.
TriangleMesh revolve(std::span<const vec2> profile, int segments, float creaseDegrees = 180.0f);

// A smooth curve through the points (centripetal Catmull-Rom; Yuksel et al. 2011), `perSpan` steps each.
std::vector<vec2> smoothCurve(std::span<const vec2> points, int perSpan);

// The profile of a disc with a rounded edge, for `revolve`; rests on y = 0.
std::vector<vec2> discProfile(float radius, float height, float bevel, int bevelSteps);

// Superellipsoid |x/a|^n + |y/b|^n + |z/c|^n = 1 (Barr 1981) on a projected cube, around the origin.
TriangleMesh superellipsoid(vec3 halfSize, float exponent, int perEdge);

// Torus knot (p, q): p times round the axis z, q times through the hole, around the origin. `radius` of the
// carrying torus's circle, `swing` of its tube, `tube` of the rope. u along the rope, v round it.
TriangleMesh torusKnot(int p, int q, float radius, float swing, float tube, int along, int around);

struct PrismShape {
  int sides = 5;
  float radius = 0.1f;     // to the corners, before rounding
  float rounding = 0.02f;  // radius of the vertical edges
  float bevel = 0.006f;    // of the rims
  float height = 0.4f;
  float twist = 1.0f;  // radians, bottom to top
  float taper = 1.0f;  // top size / bottom size
  int perSide = 24;    // vertices of the outline per side
  int rings = 96;
};
TriangleMesh twistedPrism(const PrismShape& shape);

// Axis-aligned box with flat faces between the corners.
TriangleMesh box(vec3 low, vec3 high);

// Parallelogram corner + u·a + v·b; front a × b; uv = (u, v).
TriangleMesh quad(vec3 corner, vec3 a, vec3 b);

// A flat ring (or disc: inner = 0) at y = 0, front up; uv = (x, z) / metresPerTile.
TriangleMesh flatDisc(float inner, float outer, int segments, float metresPerTile);

// A rope of radius start → end along the curve, closed at both ends.
TriangleMesh tube(std::span<const vec3> curve, float startRadius, float endRadius, int around);

// A pointed leaf (one sheet) from `base`, `length` along `direction`; `up` is about its front's normal.
TriangleMesh leaf(vec3 base, vec3 direction, vec3 up, float length, float width, float bend);

}  // namespace quintet::demo
#endif
