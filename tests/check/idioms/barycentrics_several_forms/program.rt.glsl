/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  bool lampIsSeen;
};

uniform vec3 lamp;  // defaultval="3, 5, 3" unit="m" help="Position of the lamp"
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2, n0, n1, n2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  vec3 w = vec3(1.0 - baryCoord.x - baryCoord.y, baryCoord);
  vec2 t0, t1, t2;
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, t0, t1, t2);
  float u = baryCoord.x, v = baryCoord.y;
  vec3 p = p0 * (1.0 - (u + v)) + p1 * u + p2 * v;
  vec3 n = n0 + u * (n1 - n0) + v * (n2 - n0);
  vec2 st = t0 * (1.0 - dot(baryCoord, vec2(1.0))) + t1 * u + t2 * v;
  vec3 middle = (p0 + p1 + p2) / 3.0;
  vec3 edge = u * (p1 - p0) + v * (p2 - p0);
  float inside = min(u, min(v, 1.0 - u - v));
  n = normalize(vec3(n * gl_WorldToObjectEXT));
  payload.color = vec3(inside < 0.02 ? 0.0 : max(dot(n, normalize(lamp - gl_ObjectToWorldEXT * vec4(p, 1.0))), 0.0)) +
                  0.01 * vec3(st, length(p - middle) + length(edge));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.lampIsSeen = true;
}
