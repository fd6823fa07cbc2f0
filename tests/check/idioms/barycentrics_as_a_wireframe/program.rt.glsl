struct RayPayloadType { vec3 color; };
uniform float lineWidth;  // defaultval="0.05" min="0" max="0.3"

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 w = vec3(baryCoord.y, 1.0 - baryCoord.x - baryCoord.y, baryCoord.x);  // any order
  float nearest = min(w.x, min(w.y, w.z));
  payload.color = nearest < lineWidth ? vec3(0.0) : vec3(0.5 * baryCoord.x + 0.3 * baryCoord.y + 0.2);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(1.0);
}
