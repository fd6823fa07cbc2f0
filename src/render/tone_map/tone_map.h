// SPDX-License-Identifier: Apache-2.0
// Conversion of linear radiance to display values. Tone curves and gamma are applied nowhere else.
#ifndef QUINTET_RENDER_TONE_MAP_TONE_MAP_H
#define QUINTET_RENDER_TONE_MAP_TONE_MAP_H

#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "io/image.h"
#include "program/description/program.h"

namespace quintet::render {

enum class ToneMap { linear, aces, agx, neutral };

std::optional<ToneMap> toneMapByName(const std::string& name);  // "linear", "aces", "agx", "neutral"
std::vector<std::string> toneMapNames();
// The default for an output of this kind: neutral for colors, else linear.
ToneMap defaultToneMap(program::OutputKind kind);

// Converts one color from linear Rec. 709 radiance, with exposure applied, to linear display light in [0, 1].
vec3 toneMap(ToneMap operation, vec3 color);

// Converts linear premultiplied float RGBA to sRGB with 8 or 16 bits per channel: multiplies by 2^exposure, divides the
// color by alpha, tone maps and encodes it. Returns straight RGBA, or RGB if `opaque`.
io::Image toDisplay(const io::Image& image, ToneMap operation, float exposure, bool opaque, unsigned bits = 8);

// Converts display values (sRGB-encoded, straight alpha) to linear premultiplied light. Alpha becomes 1 unless
// `transparent`.
void decodeDisplay(io::Image& image, bool transparent);

}  // namespace quintet::render
#endif
