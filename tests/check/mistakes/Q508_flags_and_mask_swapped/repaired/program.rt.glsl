struct RayPayloadType { vec3 color; };

vec3 background(vec3 d) { return mix(vec3(1.0), vec3(0.4, 0.6, 1.0), 0.5 + 0.5 * d.y); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = (2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) - vec2(gl_LaunchSizeEXT.xy)) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(p, -1.8));
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 4.0), 0.0, direction, 1e5, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.9, 0.4, 0.1) * (1.0 - baryCoord.x);
}

void main() { /**** MISS SHADER ****/
  payload.color = background(gl_WorldRayDirectionEXT);
}
