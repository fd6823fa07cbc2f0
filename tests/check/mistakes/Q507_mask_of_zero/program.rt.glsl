struct RayPayloadType {
  vec3 Lo;
};
const uint MASK_ALL = 0x00;

void main() { /**** RAY GENERATION SHADER ****/
  vec2 uv = vec2(gl_LaunchIDEXT.xy) / vec2(gl_LaunchSizeEXT.xy - 1u);
  vec3 rd = normalize(vec3(uv - 0.5, -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, MASK_ALL, 0u, 0u, 0u, vec3(0, 0.5, 5), 1e-3, rd, 1e3, 0);  // EXPECT Q507
  gsnSetPixel(vec4(payload.Lo, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.Lo = vec3(float(gl_PrimitiveID & 7) / 7.0);
}

void main() { /**** MISS SHADER ****/
  payload.Lo = vec3(0.0);
}
