// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
/**** COMMON START ****/
struct RayPayloadType { vec3 color; float t; bool inner; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload = RayPayloadType(vec3(0.0), -1.0, false);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  RayPayloadType first = payload;
  gsnSetPixel(vec4(first.color * (first.t > 0.0 ? 1.0 : 0.5), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  RayPayloadType own = payload;
  own.color = vec3(0.7, 0.5, 0.3);
  own.t = gl_HitTEXT;
  if (!own.inner) {
    payload.inner = true;
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.001,
                vec3(0.0, 1.0, 0.0), 1e3, 0);
    own.color *= payload.t < 0.0 ? 1.0 : 0.3;
  }
  payload = own;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1);
  payload.t = -1.0;
}
