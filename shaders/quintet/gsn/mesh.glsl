// SPDX-License-Identifier: Apache-2.0
// Mesh data by instance and primitive, both as indices in the scene; zeros for indices out of range. For a mesh with
// several geometries, shaders of a hit read the geometry of the hit, other shaders the first one.
uint gsnGeometryOf_(int inst) {
#ifdef QUINTET_GSN_HIT
  if (uint(inst) == gsnInstance_) return gsnGeometryIndex_;
#endif
  return 0u;
}

bool gsnGeometryAt_(int inst, int prim, out GeometryData geometry) {
  if (uint(inst) >= frame.instanceCount) return false;
  const uint first = InstanceArray(frame.instances).at[inst].firstGeometry;
  geometry = GeometryArray(frame.geometries).at[first + gsnGeometryOf_(inst)];
  return uint(prim) < geometry.triangleCount;
}

// Returns false if the triangle does not exist.
bool gsnTriangleAt_(int inst, int prim, out GeometryData geometry, out uvec3 vertices) {
  vertices = uvec3(0u);
  if (!gsnGeometryAt_(inst, prim, geometry) || geometry.triangles == 0ul) return false;
  vertices = Uvec3Array(geometry.triangles).at[prim];
  return true;
}

// Vertices of the triangle in object space.
void gsnGetPositions(int inst, int prim, out vec3 p0, out vec3 p1, out vec3 p2) {
  p0 = p1 = p2 = vec3(0.0);
  GeometryData geometry;
  uvec3 v;
  if (!gsnTriangleAt_(inst, prim, geometry, v)) return;
  Vec3Array positions = Vec3Array(geometry.positions);
  p0 = positions.at[v.x];
  p1 = positions.at[v.y];
  p2 = positions.at[v.z];
}

// Vertex normals in object space; the face normal if the mesh has no normals.
void gsnGetNormals(int inst, int prim, out vec3 n0, out vec3 n1, out vec3 n2) {
  n0 = n1 = n2 = vec3(0.0);
  GeometryData geometry;
  uvec3 v;
  if (!gsnTriangleAt_(inst, prim, geometry, v)) return;
  if (geometry.normals == 0ul) {
    Vec3Array positions = Vec3Array(geometry.positions);
    const vec3 n = cross(positions.at[v.y] - positions.at[v.x], positions.at[v.z] - positions.at[v.x]);
    const float size = length(n);
    n0 = n1 = n2 = size > 0.0 ? n / size : vec3(0.0);
    return;
  }
  Vec3Array normals = Vec3Array(geometry.normals);
  n0 = normals.at[v.x];
  n1 = normals.at[v.y];
  n2 = normals.at[v.z];
}

// Texture coordinates of the first set, t upwards; zeros if the mesh has none.
void gsnGetTexCoords(int inst, int prim, out vec2 t0, out vec2 t1, out vec2 t2) {
  t0 = t1 = t2 = vec2(0.0);
  GeometryData geometry;
  uvec3 v;
  if (!gsnTriangleAt_(inst, prim, geometry, v) || geometry.uvs[0] == 0ul) return;
  Vec2Array uvs = Vec2Array(geometry.uvs[0]);
  t0 = vec2(uvs.at[v.x].x, 1.0 - uvs.at[v.x].y);
  t1 = vec2(uvs.at[v.y].x, 1.0 - uvs.at[v.y].y);
  t2 = vec2(uvs.at[v.z].x, 1.0 - uvs.at[v.z].y);
}

// The box of a procedural primitive in object space.
void gsnGetIntersectionBox(int inst, int prim, out vec3 aabbMin, out vec3 aabbMax) {
  aabbMin = aabbMax = vec3(0.0);
  GeometryData geometry;
  if (!gsnGeometryAt_(inst, prim, geometry) || geometry.boxes == 0ul) return;
  const BoxData box = BoxArray(geometry.boxes).at[prim];
  aabbMin = box.min;
  aabbMax = box.max;
}

// mat3(transpose(inverse(objectToWorld))), which transforms normals from object to world space.
void gsnGetNormal3x3Matrix(int inst, out mat3 normalMatrix) {
  normalMatrix = mat3(1.0);
  if (uint(inst) >= frame.instanceCount) return;
  const InstanceData instance = InstanceArray(frame.instances).at[inst];
  normalMatrix = mat3(instance.objectFromWorld[0].xyz, instance.objectFromWorld[1].xyz, instance.objectFromWorld[2].xyz);
}
