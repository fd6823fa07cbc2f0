/**** COMMON START ****/
struct HitAttributeType {
  vec3 q;
};
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

void main() { /**** INTERSECTION SHADER ****/
  vec3 low, high;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, low, high);
  vec3 o = gl_ObjectRayOriginEXT - 0.5 * (low + high);
  vec3 d = gl_ObjectRayDirectionEXT;
  float r = 0.5 * (high.x - low.x);
  float a = dot(d, d);
  float b = dot(o, d);
  float h = b * b - a * (dot(o, o) - r * r);
  if (h < 0.0) return;
  float t = (-b - sqrt(h)) / a;
  if (t < gl_RayTminEXT || t >= gl_RayTmaxEXT) return;
  hit.q = (o + t * d) / r;
  reportIntersectionEXT(t, 1u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 l = normalize(lamp - position);
  vec3 v = normalize(vec3(hit.q * gl_WorldToObjectEXT));
  payload.color = vec3(max(dot(v, l), 0.0));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.lampIsSeen = true;
}
