// SPDX-License-Identifier: Apache-2.0
// The user interface library (Dear ImGui): its context, font and style, and its triangles as a gpu::DrawList.
#ifndef QUINTET_APPS_VIEWER_GUI_GUI_H
#define QUINTET_APPS_VIEWER_GUI_GUI_H

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/math.h"
#include "gpu/present/draw_list.h"
#include "viewer/settings.h"
#include "window/window.h"

struct ImDrawCmd;
struct ImDrawList;

namespace quintet::viewer {

// Indices of textures: gpu::DrawListRenderer::setTexture.
inline constexpr std::size_t kFontTexture = 0, kImageTexture = 1, kReferenceTexture = 2;

// A callback of ImGui's lists that becomes a DrawCommand::external with the clip rectangle at that point.
void drawExternally(const ImDrawList*, const ImDrawCmd*);

struct FontPixels {
  uvec2 size{0};
  std::shared_ptr<const std::vector<std::byte>> rgba;
};

// One per process.
class Gui : private RawInput {
 public:
  // `scale`: size of text and controls, in screen coordinates.
  Gui(Window& window, Theme theme, float scale);
  ~Gui() override;
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  // Both take effect in the next frame.
  void setTheme(Theme theme);
  void setScale(float scale);

  void sendFontAgain() { fontChanged_ = true; }
  // Pixels of kFontTexture if they have changed since the last call, else null.
  FontPixels takeFont();

  void beginFrame();
  gpu::DrawList endFrame();

  static bool wantsMouse();     // the pointer is over a panel, or a panel is being dragged
  static bool wantsKeyboard();  // a text is being edited
  // Closes the open menus and lists. Returns false if there are none.
  static bool closePopups();
  std::array<float, 4> background() const;

 private:
  void key(int key, int scancode, int action, int modifiers) override;
  void character(unsigned codepoint) override;
  void button(int button, int action, int modifiers) override;
  void scroll(double x, double y) override;
  void cursor(double x, double y) override;
  void cursorEnter(int entered) override;
  void focus(int focused) override;
  void loadFont();
  void applyStyle();

  Window& window_;
  Theme theme_;
  float scale_;
  float pixelScale_;  // of the window when it was opened
  FontPixels font_;
  bool fontChanged_ = false, styleChanged_ = true;
};

}  // namespace quintet::viewer
#endif
