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
  vec2 t0, t1, t2;
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, t0, t1, t2);
  vec2 b = baryCoord;
  vec2 st = t0 * (1.0 - b.x) + t1 * b.x + t2 * b.y;  // EXPECT Q710
  payload.color = vec3(fract(8.0 * st), 0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.lampIsSeen = true;
}
