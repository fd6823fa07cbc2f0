// SPDX-License-Identifier: Apache-2.0
#include "gui/gui.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#include <imgui.h>
#include <imgui_internal.h>

#include "gui/style.h"

namespace quintet::viewer {
namespace {

constexpr float kFontSize = 15.0f;  // screen coordinates at scale 1
constexpr float kTitleSize = 2.0f;  // relative to the text

// Fonts of common systems, in the order of preference. The library's own font has only ASCII.
constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/freefont/FreeSans.ttf",
    "/System/Library/Fonts/Helvetica.ttc",
};

std::string findFont() {
  std::error_code error;
  for (const char* file : kFonts)
    if (std::filesystem::is_regular_file(file, error)) return file;
  return {};
}

// Latin and Greek letters, punctuation, arrows and mathematical signs that names and units use.
constexpr ImWchar kGlyphs[] = {0x0020, 0x024F, 0x0370, 0x03FF, 0x2010, 0x2044, 0x2070, 0x209F,
                               0x2190, 0x21FF, 0x2200, 0x22FF, 0x25A0, 0x25FF, 0};

}  // namespace

Gui::Gui(Window& window, Theme theme, float scale)
    : window_(window), theme_(theme), scale_(scale), pixelScale_(window.pixelScale()) {
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // the settings are in viewer/settings.h
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  io.BackendRendererName = "quintet";
  io.ConfigWindowsMoveFromTitleBarOnly = true;
#if IMGUI_VERSION_NUM >= 18700
  io.ConfigInputTrickleEventQueue = false;  // Window::waitForEvents() does this
#endif
  ImGui_ImplGlfw_InitForVulkan(window.handle(), /*install_callbacks=*/false);
  window_.setRawInput(this);
  loadFont();
}

Gui::~Gui() {
  window_.setRawInput(nullptr);
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Gui::setTheme(Theme theme) {
  styleChanged_ = styleChanged_ || theme != theme_;
  theme_ = theme;
}

void Gui::setScale(float scale) {
  if (scale == scale_) return;
  scale_ = scale;
  styleChanged_ = true;
  loadFont();
}

// It is only compared with, never called.
void drawExternally(const ImDrawList*, const ImDrawCmd*) {}

void Gui::loadFont() {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  const float size = std::round(kFontSize * scale_ * pixelScale_);
  ImGui::GetIO().FontGlobalScale = 1.0f / pixelScale_;
  const std::string file = findFont();
  ImFontConfig config;
  config.OversampleH = 2;
  config.OversampleV = 1;
  config.PixelSnapH = true;
  if (file.empty() || !atlas.AddFontFromFileTTF(file.c_str(), size, &config, kGlyphs)) {
    config.SizePixels = size;
    atlas.AddFontDefault(&config);
  }
  // The font of titles.
  const float titleSize = std::round(kTitleSize * size);
  if (file.empty() || !atlas.AddFontFromFileTTF(file.c_str(), titleSize, &config, atlas.GetGlyphRangesDefault())) {
    config.SizePixels = titleSize;
    atlas.AddFontDefault(&config);
  }
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
  auto bytes = std::make_shared<std::vector<std::byte>>(static_cast<std::size_t>(width) * height * 4);
  std::memcpy(bytes->data(), pixels, bytes->size());
  atlas.SetTexID(textureId(kFontTexture));
  font_ = {{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)}, std::move(bytes)};
  fontChanged_ = true;
}

FontPixels Gui::takeFont() {
  if (!fontChanged_) return {};
  fontChanged_ = false;
  return font_;
}

void Gui::applyStyle() {
  ImGuiStyle style;
  setStyle(style, theme_);
  style.ScaleAllSizes(scale_);
  ImGui::GetStyle() = style;
}

void Gui::beginFrame() {
  if (styleChanged_) applyStyle();
  styleChanged_ = false;
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

gpu::DrawList Gui::endFrame() {
  ImGui::Render();
  const ImDrawData& data = *ImGui::GetDrawData();
  gpu::DrawList list;
  list.vertices.reserve(static_cast<std::size_t>(data.TotalVtxCount));
  list.indices.reserve(static_cast<std::size_t>(data.TotalIdxCount));
  const ImVec2 scale = data.FramebufferScale;
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& from = *data.CmdLists[i];
    const auto firstVertex = static_cast<std::uint32_t>(list.vertices.size());
    const auto firstIndex = static_cast<std::uint32_t>(list.indices.size());
    for (const ImDrawVert& vertex : from.VtxBuffer)
      list.vertices.push_back({vertex.pos.x * scale.x, vertex.pos.y * scale.y, vertex.uv.x, vertex.uv.y, vertex.col});
    list.indices.insert(list.indices.end(), from.IdxBuffer.begin(), from.IdxBuffer.end());
    for (const ImDrawCmd& command : from.CmdBuffer) {
      const bool external = command.UserCallback == drawExternally;
      if (!external && (command.UserCallback || command.ElemCount == 0)) continue;
      list.commands.push_back({.texture = external ? 0 : textureIndex(command.GetTexID()),
                               .left = command.ClipRect.x * scale.x,
                               .top = command.ClipRect.y * scale.y,
                               .right = command.ClipRect.z * scale.x,
                               .bottom = command.ClipRect.w * scale.y,
                               .firstIndex = firstIndex + command.IdxOffset,
                               .indexCount = command.ElemCount,
                               .firstVertex = firstVertex + command.VtxOffset,
                               .external = external});
    }
  }
  return list;
}

bool Gui::wantsMouse() { return ImGui::GetIO().WantCaptureMouse; }
bool Gui::wantsKeyboard() { return ImGui::GetIO().WantTextInput; }

bool Gui::closePopups() {
  if (!ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return false;
  ImGui::ClosePopupToLevel(0, /*restore_focus_to_window_under_popup=*/true);
  return true;
}

void Gui::key(int key, int scancode, int action, int modifiers) {
  ImGui_ImplGlfw_KeyCallback(window_.handle(), key, scancode, action, modifiers);
}
void Gui::character(unsigned codepoint) { ImGui_ImplGlfw_CharCallback(window_.handle(), codepoint); }
void Gui::button(int button, int action, int modifiers) {
  ImGui_ImplGlfw_MouseButtonCallback(window_.handle(), button, action, modifiers);
}
void Gui::scroll(double x, double y) { ImGui_ImplGlfw_ScrollCallback(window_.handle(), x, y); }
void Gui::cursor([[maybe_unused]] double x, [[maybe_unused]] double y) {
#if IMGUI_VERSION_NUM >= 18700  // earlier versions read the position in each frame
  ImGui_ImplGlfw_CursorPosCallback(window_.handle(), x, y);
#endif
}
void Gui::cursorEnter(int entered) { ImGui_ImplGlfw_CursorEnterCallback(window_.handle(), entered); }
void Gui::focus(int focused) { ImGui_ImplGlfw_WindowFocusCallback(window_.handle(), focused); }

std::array<float, 4> Gui::background() const {
  const vec3 color = backgroundColor(theme_);
  return {color.r, color.g, color.b, 1.0f};
}

}  // namespace quintet::viewer
