struct RayPayloadType {
  float t;
  vec3 normal;
};

// A mirror: the second ray starts where the first one ended.
void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0.0, 1.0, 6.0);
  vec3 dir = vec3(ndc, -2.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.001, dir, 1000.0, 0);
  vec3 color = vec3(0.2, 0.3, 0.5);
  if (payload.t > 0.0) {
    vec3 position = eye + payload.t * normalize(dir);  // EXPECT Q717
    vec3 mirrored = reflect(normalize(dir), payload.normal);
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, position, 0.001, mirrored, 1000.0, 0);
    color = payload.t > 0.0 ? 0.5 + 0.5 * payload.normal : vec3(0.1);
  }
  gsnSetPixel(vec4(color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 toWorld;
  gsnGetNormal3x3Matrix(gl_InstanceID, toWorld);
  payload.normal = normalize(toWorld * cross(p1 - p0, p2 - p0));
  payload.t = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
  payload.normal = vec3(0.0);
}
