struct RayPayloadType { vec3 color; };

vec3 mixTriangle(vec3 a, vec3 b, vec3 c, vec2 bary) {
  return a + bary.y * (b - a) + bary.x * (c - a);  // EXPECT Q710
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n[3];
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n[0], n[1], n[2]);
  vec3 smoothN = mixTriangle(n[0], n[1], n[2], baryCoord);
  payload.color = 0.5 + 0.5 * normalize(vec3(smoothN * gl_WorldToObjectEXT));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
