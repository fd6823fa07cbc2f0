// Says which solid was hit, of a tree, too; the ray generation shader does the rest.
#include <quintet/features.glsl>
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;

#ifdef QUINTET_NO_PROCEDURALS
void main() {}
#else
#include <quintet/procedural/hit.glsl>
void main() { payload = solidHit(raySeed(payload)); }
#endif
