// SPDX-License-Identifier: Apache-2.0
// Motion vectors: where a surface was in the previous frame of an animation, in the world and in the image. The library
// keeps the previous positions of deformed vertices only for programs that store the output `motion`.
#ifndef QUINTET_MOTION_GLSL
#define QUINTET_MOTION_GLSL

#include "camera.glsl"
#include "payload.glsl"
#include "surface.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer AddressArray { Address at[]; };

// The vertices of the hit's geometry in the previous frame, vec3[]; 0 if they were where they are now.
Address previousVertices(HitPayload hit, InstanceData instance) {
  if (frame.previousPositions == 0ul) return 0ul;
  return AddressArray(frame.previousPositions).at[instance.firstGeometry + hit.geometry];
}

// World position, one frame earlier, of the point of the hit that is at `position` now. It has moved with its instance,
// and on a mesh with a skin or morph targets also with the three vertices of its triangle.
vec3 previousPosition(HitPayload hit, vec3 position) {
  const InstanceData instance = InstanceArray(frame.instances).at[hit.instance];
  const Address vertices = previousVertices(hit, instance);
  if (vertices == 0ul && frame.previousInstances == 0ul) return position;
  vec3 object;
  if (vertices != 0ul) {
    const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + hit.geometry];
    const uvec3 v = Uvec3Array(geometry.triangles).at[hit.primitive];
    Vec3Array positions = Vec3Array(vertices);
    object = (1.0 - hit.barycentric.x - hit.barycentric.y) * positions.at[v.x] +
             hit.barycentric.x * positions.at[v.y] + hit.barycentric.y * positions.at[v.z];
  } else {
    object = rowsTimesPoint(instance.objectFromWorld, position);
  }
  if (frame.previousInstances == 0ul) return rowsTimesPoint(instance.worldFromObject, object);
  const InstanceData before = InstanceArray(frame.previousInstances).at[hit.instance];
  return rowsTimesPoint(before.worldFromObject, object);
}

// Motion in the image of the point of the hit that is at `position`, since the previous frame, with that of the camera: in
// pixels, x right, y down. 0 if the point was behind the camera.
vec2 imageMotion(HitPayload hit, vec3 position) {
  const vec3 before = previousPosition(hit, position);
  if (frame.previousCamera.orthographic == 0u && cameraFromWorld(frame.previousCamera, before).z >= 0.0) return vec2(0.0);
  return imagePoint(frame.camera, position) - imagePoint(frame.previousCamera, before);
}

#endif
