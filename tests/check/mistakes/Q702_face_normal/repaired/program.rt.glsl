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
  mat3 m = mat3(gl_ObjectToWorldEXT);
  vec3 up = cross(m * (p1 - p0), m * (p2 - p0));
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 l = normalize(lamp - position);
  payload.color = vec3(abs(dot(normalize(up), l)));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.lampIsSeen = true;
}
