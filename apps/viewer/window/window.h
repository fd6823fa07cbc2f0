// SPDX-License-Identifier: Apache-2.0
// A window of the desktop (GLFW): its size, its input, and the surface on which Vulkan presents.
#ifndef QUINTET_APPS_VIEWER_WINDOW_WINDOW_H
#define QUINTET_APPS_VIEWER_WINDOW_WINDOW_H

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/context.h"
#include "window/input_event.h"

struct GLFWwindow;

namespace quintet::viewer {

// Gets the input as GLFW reports it, in the order in which waitForEvents() returns it.
class RawInput {
 public:
  virtual ~RawInput() = default;
  virtual void key(int key, int scancode, int action, int modifiers) = 0;
  virtual void character(unsigned codepoint) = 0;
  virtual void button(int button, int action, int modifiers) = 0;
  virtual void scroll(double x, double y) = 0;
  virtual void cursor(double x, double y) = 0;
  virtual void cursorEnter(int entered) = 0;
  virtual void focus(int focused) = 0;
};

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

  uvec2 size() const;                          // pixels of the framebuffer; 0 if the window is minimized
  float pixelScale() const;                    // pixels per screen coordinate
  uvec2 windowedSize() const;                  // of the window; in full screen, the size before
  std::optional<glm::ivec2> position() const;  // of the window; unset in full screen, and if the window system hides it
  void setPosition(glm::ivec2 position);
  float contentScale() const;  // size of text and controls in pixels that the display asks for; 1 at 96 DPI
  bool shouldClose() const;
  bool minimized() const;

  // Waits up to `seconds` for input or wake(), and returns the input since the last call, as far as one frame can use it:
  // a key such as Enter is pressed and released in different frames, so that fast typing loses nothing. `holdsKeys`: keys
  // and characters wait, for example until a field has the focus that will get them.
  std::vector<InputEvent> waitForEvents(double seconds, bool holdsKeys = false);
  void setRawInput(RawInput* input) { rawInput_ = input; }  // may be null
  static void wake();                                       // from any thread

  void setTitle(const std::string& title);
  void toggleFullScreen();
  void setClipboard(const std::string& text);

 private:
  struct Callbacks;
  struct Waiting {
    std::function<void()> deliver;
    bool isKey = false;      // or a character
    bool endsFrame = false;  // what follows belongs to the next frame
  };

  GLFWwindow* handle_ = nullptr;
  RawInput* rawInput_ = nullptr;
  std::deque<Waiting> waiting_;
  std::vector<InputEvent> events_;
  bool keyRepeats_ = false;  // the last event of a key, which a character follows
  int windowedX_ = 0, windowedY_ = 0, windowedWidth_ = 0, windowedHeight_ = 0;  // before full screen
};

}  // namespace quintet::viewer
#endif
