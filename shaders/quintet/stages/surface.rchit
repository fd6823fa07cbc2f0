// Says which triangle was hit; the ray generation shader does the rest.
#include <quintet/hit.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;
hitAttributeEXT vec2 baryCoord;

void main() { payload = triangleHit(baryCoord, raySeed(payload)); }
