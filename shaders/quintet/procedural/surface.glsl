// SPDX-License-Identifier: Apache-2.0
// The surface of a solid at a hit. quintet/surface.glsl declares Surface and then includes this file. It is therefore
// included before the guard, so that either file can be the first.
#include "../surface.glsl"
#ifndef QUINTET_PROCEDURAL_SURFACE_GLSL
#define QUINTET_PROCEDURAL_SURFACE_GLSL

#include "../explain_hooks.glsl"
#include "point.glsl"

// As surfaceError, of a point of a solid: p in the canonical space, which adds a transform each way; `largest`: the
// largest magnitudes of object-space coordinates in reach of the solid. 32 roundings in canonical space, whose coordinates
// are 1 at most: square roots and quotients of the point and of the intersection, which Vulkan allows 2.5 roundings each.
float solidError(InstanceData instance, PrimitiveData primitive, vec3 p, vec3 largest, vec3 world, vec3 n) {
  const float e = 5.9604645e-8;
  const vec3 objectNormal = abs(transposeTimesVector(instance.worldFromObject, n));
  const vec3 primitiveNormal = abs(transposeTimesVector(primitive.objectFromPrimitive, transposeTimesVector(instance.worldFromObject, n)));
  vec3 worldSize = abs(world);
  vec3 objectSize;
  vec3 primitiveSize;
  for (int i = 0; i < 3; ++i) {
    const vec4 fromPrimitive = abs(primitive.objectFromPrimitive[i]);
    const vec4 toPrimitive = abs(primitive.primitiveFromObject[i]);
    const vec4 fromObject = abs(instance.worldFromObject[i]);
    const vec4 toObject = abs(instance.objectFromWorld[i]);
    worldSize[i] += 4.0 * (dot(fromObject.xyz, largest) + fromObject.w);
    objectSize[i] = 4.0 * (dot(fromPrimitive.xyz, abs(p)) + fromPrimitive.w + dot(toObject.xyz, abs(world)) + toObject.w) + 8.0 * largest[i];
    primitiveSize[i] = 32.0 + 5.0 * (dot(toPrimitive.xyz, largest) + toPrimitive.w);
  }
  return 2.0 * e * (dot(abs(n), worldSize) + dot(objectNormal, objectSize) + dot(primitiveNormal, primitiveSize));
}

Surface fetchSolid(HitPayload hit, InstanceData instance, GeometryData geometry, vec3 wo) {
  const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[hit.part & kPartPrimitiveMask];
  const SolidPoint point = solidPoint(primitive.type, primitive.parameter, (hit.part >> kPartFaceShift) & 7u, hit.barycentric);
  const BoxData box = BoxArray(geometry.boxes).at[hit.primitive];
  const vec3 object = rowsTimesPoint(primitive.objectFromPrimitive, point.position);
  const float side = (hit.part & kPartFlipped) != 0u ? -1.0 : 1.0;

  Surface s;
  s.position = rowsTimesPoint(instance.worldFromObject, object);
  const vec3 normal = transposeTimesVector(instance.objectFromWorld, transposeTimesVector(primitive.primitiveFromObject, point.normal));
  const vec3 front = side * safeNormalize(normal / maxComponent(abs(normal)), side * wo);
  s.frontFace = (hit.part & kPartFront) != 0u;
  s.geometricNormal = s.frontFace ? front : -front;
  s.shadingNormal = s.geometricNormal;
  s.error = solidError(instance, primitive, point.position, max(abs(box.min), abs(box.max)), s.position, front);

  const vec3 along = rowsTimesVector(instance.worldFromObject, rowsTimesVector(primitive.objectFromPrimitive, point.tangent));
  const vec3 up = rowsTimesVector(instance.worldFromObject, rowsTimesVector(primitive.objectFromPrimitive, point.bitangent));
  s.tangent = safeNormalize(along - front * dot(front, along), anyTangent(front));
  s.bitangent = cross(front, s.tangent);
  if (dot(s.bitangent, up) < 0.0) s.bitangent = -s.bitangent;
  s.material = primitive.material;
  s.color = vec4(1.0);
  s.uvs[0] = point.uv;
  s.uvs[1] = point.uv;
  explainSurface(s.position, s.geometricNormal, s.shadingNormal, s.uvs[0], s.material, s.frontFace);
  return s;
}

#endif
