// SPDX-License-Identifier: Apache-2.0
// A window of the desktop (GLFW): its size, its input, and the surface on which Vulkan presents.
#ifndef QUINTET_APPS_VIEWER_WINDOW_WINDOW_H
#define QUINTET_APPS_VIEWER_WINDOW_WINDOW_H

#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/context.h"
#include "window/input_event.h"

struct GLFWwindow;

namespace quintet::viewer {

// Sizes and positions are in the screen coordinates of the window system, unless they are stated to be pixels. A
// coordinate is one or several pixels of the framebuffer: 2 on Wayland and macOS if the display is scaled by 2, 1 on X11.
// One window per process. All functions are called from the main thread, except wake().
class Window {
 public:
  // Throws Error if there is no display.
  Window(const std::string& title, uvec2 size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return handle_; }
  gpu::SurfaceSource surfaceSource() const;  // valid as long as the window

  uvec2 size() const;          // pixels of the framebuffer; 0 if the window is minimized
  float pixelScale() const;    // pixels per screen coordinate
  uvec2 windowedSize() const;  // of the window; in full screen, the size before
  float contentScale() const;  // size of text and controls in pixels that the display asks for; 1 at 96 DPI
  bool shouldClose() const;
  bool minimized() const;

  // Waits up to `seconds` for input or wake(), and returns the input since the last call.
  std::vector<InputEvent> waitForEvents(double seconds);
  static void wake();  // from any thread

  void setTitle(const std::string& title);
  void toggleFullScreen();
  void setClipboard(const std::string& text);

 private:
  struct Callbacks;

  GLFWwindow* handle_ = nullptr;
  std::vector<InputEvent> events_;
  bool keyRepeats_ = false;  // the last event of a key, which a character follows
  int windowedX_ = 0, windowedY_ = 0, windowedWidth_ = 0, windowedHeight_ = 0;  // before full screen
};

}  // namespace quintet::viewer
#endif
