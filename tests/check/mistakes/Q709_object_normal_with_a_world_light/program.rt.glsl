struct RayPayloadType { vec3 farbe; };

const vec3 lichtPosition = vec3(3.0, 5.0, 4.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 punkt = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 1, 6), 1e-3, normalize(vec3(punkt, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.farbe, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  vec3 normale = normalize(n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y);
  vec3 ort = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 zumLicht = normalize(lichtPosition - ort);
  payload.farbe = vec3(max(dot(normale, zumLicht), 0.0));  // EXPECT Q709
}

void main() { /**** MISS SHADER ****/
  payload.farbe = vec3(0.0);
}
