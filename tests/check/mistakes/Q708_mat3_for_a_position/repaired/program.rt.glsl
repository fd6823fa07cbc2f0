struct RayPayloadType { vec3 c; };

struct Vertex { vec3 pos; };

Vertex interpolate(vec2 bc) {
  vec3 v0, v1, v2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, v0, v1, v2);
  vec3 w = vec3(1.0 - bc.x - bc.y, bc.x, bc.y);
  return Vertex(v0 * w.x + v1 * w.y + v2 * w.z);
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 s = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFF, 0, 0, 0, vec3(0, 2, 7), 0.001, normalize(vec3(s.x, s.y - 0.3, -2)), 1e4, 0);
  gsnSetPixel(vec4(payload.c, 1));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  Vertex v = interpolate(baryCoord);
  v.pos = gl_ObjectToWorldEXT * vec4(v.pos, 1.0);
  float d = distance(v.pos, vec3(0.0, 5.0, 0.0));
  payload.c = vec3(10.0 / (d * d));
}

void main() { /**** MISS SHADER ****/
  payload.c = vec3(0.0);
}
