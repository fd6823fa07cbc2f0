// GLSL of the tests' ray tracer.
#ifndef QUINTET_TESTS_GPU_RT_SHADERS_H
#define QUINTET_TESTS_GPU_RT_SHADERS_H

namespace quintet::rt::test {

inline constexpr char kCommon[] = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
struct Ray { vec3 origin; float tMin; vec3 direction; float tMax; };
struct Hit { float t; uint primitive; uint geometry; uint custom; uint tag; uint kind; float u; float v; };
struct Box { vec3 low; vec3 high; };
layout(buffer_reference, scalar) readonly buffer Rays { Ray at[]; };
layout(buffer_reference, scalar) buffer Hits { Hit at[]; };
layout(buffer_reference, scalar) readonly buffer Map { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Boxes { Box at[]; };
layout(push_constant, scalar) uniform Launch {
  Rays rays; Hits hits; uint count; uint flags; uint mask; uint recordOffset; uint recordStride; uint missIndex;
} launch;
)";

inline constexpr char kRecord[] = R"(
layout(shaderRecordEXT, scalar) buffer Record { uint64_t map; uint64_t boxes; uint tag; uint padding; } record;
uint inputPrimitive() { return record.map == 0ul ? gl_PrimitiveID : Map(record.map).at[gl_PrimitiveID]; }
)";

inline constexpr char kRayGenerationText[] = R"(
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadEXT Hit hit;
void main() {
  uint i = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
  if (i >= launch.count) return;
  Ray ray = launch.rays.at[i];
  hit = Hit(-2.0, 0, 0, 0, 0, 0, 0.0, 0.0);
  traceRayEXT(tlas, launch.flags, launch.mask, launch.recordOffset, launch.recordStride, launch.missIndex, ray.origin,
              ray.tMin, ray.direction, ray.tMax, 0);
  launch.hits.at[i] = hit;
}
)";

inline constexpr char kMissText[] = R"(
layout(location = 0) rayPayloadInEXT Hit hit;
layout(shaderRecordEXT, scalar) buffer Record { uint tag; } record;
void main() { hit = Hit(-1.0, 0, 0, 0, record.tag, 0, 0.0, 0.0); }
)";

inline constexpr char kClosestHitText[] = R"(
layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 attributes;
void main() {
  hit = Hit(gl_HitTEXT, inputPrimitive(), gl_GeometryIndexEXT, gl_InstanceCustomIndexEXT, record.tag, gl_HitKindEXT,
            attributes.x, attributes.y);
}
)";

// The sphere inscribed in the box: the nearer of its two points within the ray's interval.
inline constexpr char kIntersectionText[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  Box box = Boxes(record.boxes).at[inputPrimitive()];
  vec3 toCenter = 0.5 * (box.low + box.high) - gl_ObjectRayOriginEXT;
  float radius = 0.5 * (box.high.x - box.low.x), a = dot(gl_ObjectRayDirectionEXT, gl_ObjectRayDirectionEXT);
  float b = dot(toCenter, gl_ObjectRayDirectionEXT), d = b * b - a * (dot(toCenter, toCenter) - radius * radius);
  if (d < 0.0) return;
  float nearer = (b - sqrt(d)) / a, farther = (b + sqrt(d)) / a;
  float t = nearer >= gl_RayTminEXT ? nearer : farther;
  if (t >= gl_RayTminEXT && t < gl_RayTmaxEXT) {
    attributes = vec2(0.0);
    reportIntersectionEXT(t, nearer >= gl_RayTminEXT ? 1u : 2u);
  }
}
)";

inline constexpr char kOddOnlyText[] = R"(
void main() { if (inputPrimitive() % 2u == 0u) ignoreIntersectionEXT; }
)";
inline constexpr char kAcceptAllText[] = "void main() {}\n";

}  // namespace quintet::rt::test
#endif
