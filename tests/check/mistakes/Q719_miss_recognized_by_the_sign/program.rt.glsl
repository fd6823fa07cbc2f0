struct RayPayloadType {
  vec3 albedo;
  float t;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1000.0, 0);
  vec3 color = vec3(0.5, 0.7, 1.0);
  if (payload.t > 0.0) color = payload.albedo / (1.0 + payload.t * payload.t);
  gsnSetPixel(vec4(color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.albedo = vec3(baryCoord, 0.5);
  payload.t = gl_RayTmaxEXT;
}

void main() { /**** MISS SHADER ****/
  payload.albedo = vec3(1.0);
  payload.t = gl_RayTmaxEXT;  // EXPECT Q719
}
