// SPDX-License-Identifier: Apache-2.0
#include "gui/style.h"

namespace quintet::viewer {
namespace {

ImVec4 rgb(int hex, float alpha = 1.0f) {
  return {static_cast<float>(hex >> 16 & 255) / 255.0f, static_cast<float>(hex >> 8 & 255) / 255.0f,
          static_cast<float>(hex & 255) / 255.0f, alpha};
}

// The colors from which all others are derived, and where the themes differ.
struct Base {
  int window, panel, control, controlHovered, controlActive, line, text, faint, accent, accentHovered;
};
constexpr Base kDark{0x232427, 0x2B2D31, 0x3A3D43, 0x484C54, 0x555A64,
                     0x3D4046, 0xE4E6EA, 0x9499A3, 0x3D7DD8, 0x5590E4};
constexpr Base kLight{0xF3F4F6, 0xFFFFFF, 0xE1E4E9, 0xD3D8E0, 0xC3CAD5,
                      0xCDD2DA, 0x1F2328, 0x667080, 0x2F6FD0, 0x4D87DE};

void setColors(ImVec4* colors, const Base& base) {
  colors[ImGuiCol_Text] = rgb(base.text);
  colors[ImGuiCol_TextDisabled] = rgb(base.faint);
  colors[ImGuiCol_WindowBg] = rgb(base.window);
  colors[ImGuiCol_ChildBg] = rgb(base.window, 0.0f);
  colors[ImGuiCol_PopupBg] = rgb(base.panel);
  colors[ImGuiCol_Border] = rgb(base.line);
  colors[ImGuiCol_BorderShadow] = rgb(base.line, 0.0f);
  colors[ImGuiCol_FrameBg] = rgb(base.control);
  colors[ImGuiCol_FrameBgHovered] = rgb(base.controlHovered);
  colors[ImGuiCol_FrameBgActive] = rgb(base.controlActive);
  colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = colors[ImGuiCol_TitleBgCollapsed] = rgb(base.panel);
  colors[ImGuiCol_MenuBarBg] = rgb(base.window);
  colors[ImGuiCol_ScrollbarBg] = rgb(base.window, 0.0f);
  colors[ImGuiCol_ScrollbarGrab] = rgb(base.control);
  colors[ImGuiCol_ScrollbarGrabHovered] = rgb(base.controlHovered);
  colors[ImGuiCol_ScrollbarGrabActive] = rgb(base.controlActive);
  colors[ImGuiCol_CheckMark] = rgb(base.accent);
  colors[ImGuiCol_SliderGrab] = rgb(base.accent);
  colors[ImGuiCol_SliderGrabActive] = rgb(base.accentHovered);
  colors[ImGuiCol_Button] = rgb(base.control);
  colors[ImGuiCol_ButtonHovered] = rgb(base.controlHovered);
  colors[ImGuiCol_ButtonActive] = rgb(base.controlActive);
  colors[ImGuiCol_Header] = rgb(base.panel);
  colors[ImGuiCol_HeaderHovered] = rgb(base.control);
  colors[ImGuiCol_HeaderActive] = rgb(base.controlHovered);
  colors[ImGuiCol_Separator] = rgb(base.line);
  colors[ImGuiCol_SeparatorHovered] = rgb(base.accent);
  colors[ImGuiCol_SeparatorActive] = rgb(base.accentHovered);
  colors[ImGuiCol_ResizeGrip] = rgb(base.line, 0.0f);
  colors[ImGuiCol_PlotLines] = rgb(base.accent);
  colors[ImGuiCol_PlotLinesHovered] = rgb(base.accentHovered);
  colors[ImGuiCol_PlotHistogram] = rgb(base.accent);
  colors[ImGuiCol_PlotHistogramHovered] = rgb(base.accentHovered);
  colors[ImGuiCol_TableHeaderBg] = rgb(base.panel);
  colors[ImGuiCol_TableBorderStrong] = colors[ImGuiCol_TableBorderLight] = rgb(base.line);
  colors[ImGuiCol_TextSelectedBg] = rgb(base.accent, 0.4f);
  colors[ImGuiCol_NavHighlight] = rgb(base.accent);
  colors[ImGuiCol_ModalWindowDimBg] = rgb(0x000000, 0.45f);
}

}  // namespace

void setStyle(ImGuiStyle& style, Theme theme) {
  if (theme == Theme::dark)
    ImGui::StyleColorsDark(&style);
  else
    ImGui::StyleColorsLight(&style);
  setColors(style.Colors, theme == Theme::dark ? kDark : kLight);
  style.WindowPadding = {10, 8};
  style.FramePadding = {7, 4};
  style.ItemSpacing = {8, 6};
  style.ItemInnerSpacing = {6, 4};
  style.IndentSpacing = 16;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 10;
  style.WindowMinSize = {8, 8};
  style.WindowRounding = 0;
  style.ChildRounding = 4;
  style.FrameRounding = 4;
  style.PopupRounding = 6;
  style.ScrollbarRounding = 6;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.WindowTitleAlign = {0.5f, 0.5f};
}

vec3 backgroundColor(Theme theme) {
  const ImVec4 color = theme == Theme::dark ? rgb(0x151618) : rgb(0xD5D8DD);
  return {color.x, color.y, color.z};
}

const Palette& palette(Theme theme) {
  static const Palette kDarkPalette{rgb(0xFF7B72), rgb(0xE3B341), rgb(0x79B8FF), rgb(0x6FCF7F), rgb(0x9499A3)};
  static const Palette kLightPalette{rgb(0xC42B2B), rgb(0x8A6100), rgb(0x0B5CAD), rgb(0x1F7A33), rgb(0x667080)};
  return theme == Theme::dark ? kDarkPalette : kLightPalette;
}

}  // namespace quintet::viewer
