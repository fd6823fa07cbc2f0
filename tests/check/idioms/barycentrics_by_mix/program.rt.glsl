struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec2 a, b, c;
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, a, b, c);
  // b.y of the way from the edge to vertex 2; the point on the edge is at b.x / (1 - b.y).
  vec2 onEdge = mix(a, b, baryCoord.x / max(1.0 - baryCoord.y, 1e-6));
  vec2 st = mix(onEdge, c, baryCoord.y);
  payload.color = vec3(st, 0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
