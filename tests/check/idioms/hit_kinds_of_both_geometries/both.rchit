#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 where;
void main() {
  if (gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT) c = vec3(0.9, 0.8, 0.7);
  else if (gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) c = vec3(0.3);
  else c = vec3(fract(4.0 * where), float(gl_HitKindEXT & 1u));
}
