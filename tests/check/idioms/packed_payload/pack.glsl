#define PACK(rgb, t) uvec2(packHalf2x16((rgb).rg), packHalf2x16(vec2((rgb).b, t)))
vec4 unpackHit(uvec2 v) { return vec4(unpackHalf2x16(v.x), unpackHalf2x16(v.y)); }
