struct RayPayloadType { vec3 color; };

vec3 edgeToWorld(vec3 a, vec3 b) { return gl_ObjectToWorldEXT * vec4(b, 1.0) - gl_ObjectToWorldEXT * vec4(a, 1.0); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 a, b, c;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, a, b, c);
  vec3 n = normalize(cross(edgeToWorld(a, b), edgeToWorld(a, c)));
  payload.color = 0.5 + 0.5 * faceforward(n, gl_WorldRayDirectionEXT, n);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
