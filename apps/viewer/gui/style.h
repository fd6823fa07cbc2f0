// SPDX-License-Identifier: Apache-2.0
// Colors and sizes of the user interface, and the conversion of texture indices.
#ifndef QUINTET_APPS_VIEWER_GUI_STYLE_H
#define QUINTET_APPS_VIEWER_GUI_STYLE_H

#include <cstddef>
#include <cstdint>

#include <imgui.h>

#include "base/math.h"
#include "viewer/settings.h"

namespace quintet::viewer {

// Sizes are those at scale 1.
void setStyle(ImGuiStyle& style, Theme theme);

vec3 backgroundColor(Theme theme);  // behind the image, sRGB-encoded

// Colors with a meaning, for text on panels.
struct Palette {
  ImVec4 error, warning, note, success, faint;
};
const Palette& palette(Theme theme);

// ImTextureID is a pointer in older versions of the library and a number in newer ones. 0 means no texture.
inline ImTextureID textureId(std::size_t index) { return (ImTextureID)(static_cast<std::intptr_t>(index) + 1); }
inline std::size_t textureIndex(ImTextureID id) { return static_cast<std::size_t>((std::intptr_t)id) - 1; }

}  // namespace quintet::viewer
#endif
