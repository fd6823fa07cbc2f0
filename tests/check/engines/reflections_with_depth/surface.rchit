// SPDX-License-Identifier: Apache-2.0
#extension GL_EXT_scalar_block_layout : enable
layout(constant_id = 0) const int kMaxDepth = 3;
struct RayPayload { vec3 color; int depth; };
struct LightSample { vec3 pos; vec3 dir; float dist; vec3 radiance; };
layout(location = 0) rayPayloadInEXT RayPayload payload;
layout(location = 1) rayPayloadEXT RayPayload reflected;
layout(location = 2) rayPayloadEXT float visible;
layout(location = 0) callableDataEXT LightSample ls;
layout(set=0,binding=0) uniform accelerationStructureEXT scene;
layout(set=0,binding=2) uniform U { mat4 vi; mat4 pi; int lightCount; int lightKind; } u;
layout(set=0,binding=3,scalar) readonly buffer Nrm { vec3 n[]; };
hitAttributeEXT vec2 bary;
void main() {
  vec3 pos = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 N = normalize(n[gl_PrimitiveID] * mat3(gl_WorldToObjectEXT));
  vec3 c = vec3(0);
  for (int i = 0; i < u.lightCount; ++i) {
    ls.pos = pos;
    executeCallableEXT(u.lightKind, 0);
    if (dot(ls.dir, N) <= 0.0) continue;
    visible = 0.0;
    traceRayEXT(scene, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 1, pos, 0.01, ls.dir, ls.dist, 2);
    c += visible * ls.radiance * dot(ls.dir, N);
  }
  if (payload.depth + 1 < kMaxDepth) {
    reflected.depth = payload.depth + 1;
    traceRayEXT(scene, gl_RayFlagsNoneEXT, 0xff, 0, 0, 0, pos, 0.01, reflect(gl_WorldRayDirectionEXT, N), 1000.0, 1);
    c += 0.3 * reflected.color;
  }
  payload.color = c;
}
