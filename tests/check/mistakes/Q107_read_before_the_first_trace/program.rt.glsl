struct RayPayloadType {
  vec3 color;
  float weight;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 sum = vec3(0.0);
  float w = payload.weight;  // EXPECT Q107
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001,
              normalize(vec3(ndc, -2.0)), 1000.0, 0);
  sum += w * payload.color;
  gsnSetPixel(vec4(sum, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(baryCoord, 0.3);
  payload.weight = 1.0;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.2);
  payload.weight = 0.5;
}
