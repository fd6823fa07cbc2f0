#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  // The same texture for all invocations of a launch.
  uint id = parameters.day;
  if (parameters.dark != 0u) id = parameters.night;
  c = textureLod(textures[id], b, 0.0).rgb;
  // All invocations that are still in the loop look at the same layer.
  for (uint layer = 0u; layer < 4u; ++layer) {
    const vec4 texel = textureLod(textures[parameters.day + layer], b, 0.0);
    c = mix(c, texel.rgb, texel.a);
    if (texel.a * b.x > 0.9) break;
  }
}
