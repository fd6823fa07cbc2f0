struct RayPayloadType { vec3 color; };

float random(vec3 v) { return fract(sin(dot(v, vec3(12.9898, 78.233, 37.719))) * 43758.5453); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 a, b, c;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, a, b, c);
  vec3 middle = (a + b + c) / 3.0;
  // A random point of the triangle.
  float r = sqrt(random(a)), s = random(b);
  vec3 sampled = (1.0 - r) * a + r * (1.0 - s) * b + r * s * c;
  float edge = min(min(baryCoord.x, baryCoord.y), 1.0 - (baryCoord.x + baryCoord.y));
  payload.color = vec3(distance(middle, sampled), smoothstep(0.0, 0.1, edge), 2.0 * baryCoord.x - baryCoord.y);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
