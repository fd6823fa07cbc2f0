// From linear radiance to what a display shows. The only place where tone and gamma are applied.
#ifndef QUINTET_RENDER_TONE_MAP_H
#define QUINTET_RENDER_TONE_MAP_H

#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "io/image.h"

namespace quintet::render {

enum class ToneMap { linear, aces, agx, neutral };

std::optional<ToneMap> toneMapByName(const std::string& name);  // "linear", "aces", "agx", "neutral"
std::vector<std::string> toneMapNames();

// One colour: linear Rec. 709 radiance (exposure applied) to linear display light in [0,1].
vec3 toneMap(ToneMap operation, vec3 color);

// The image multiplied by 2^exposure, tone mapped (colour divided by alpha first) and sRGB-encoded: 8-bit
// straight RGBA, or RGB if `opaque`. `image`: linear premultiplied float RGBA.
io::Image toDisplay(const io::Image& image, ToneMap operation, float exposure, bool opaque);

// Display values (sRGB-encoded, straight) to linear light. Their alpha counts where a transparent picture is wanted.
void decodeDisplay(io::Image& image, bool transparent);

}  // namespace quintet::render
#endif
