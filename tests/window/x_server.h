// SPDX-License-Identifier: Apache-2.0
// An X server without a screen (Xvfb), and synthetic input for one window of it.
#ifndef QUINTET_TESTS_WINDOW_X_SERVER_H
#define QUINTET_TESTS_WINDOW_X_SERVER_H

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/image.h"

// Of Xlib, whose header defines macros such as None and Status.
struct _XDisplay;

namespace quintet::test {

// Throws std::runtime_error if Xvfb does not start.
class XServer {
 public:
  XServer();
  ~XServer();
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;

  const std::string& display() const { return display_; }  // ":7"

 private:
  pid_t process_ = -1;
  std::string display_;
};

// The window with the class "quintet-view". Positions are pixels of the window.
class XWindow {
 public:
  // Waits until the window exists. `alive`: asked meanwhile; false ends the wait with a std::runtime_error.
  XWindow(const std::string& display, const std::function<bool()>& alive);
  ~XWindow();
  XWindow(const XWindow&) = delete;
  XWindow& operator=(const XWindow&) = delete;

  void move(int x, int y);
  void press(unsigned button);  // 1 left, 2 middle, 3 right, 4 and 5 wheel
  void release(unsigned button);
  // `modifiers`: as of key().
  void click(int x, int y, unsigned button = 1, const std::vector<std::string>& modifiers = {});
  void drag(int fromX, int fromY, int toX, int toY, unsigned button = 1);
  // A key by the name of its symbol, "z" or "Home", while the modifiers "Control_L" or "Shift_L" are held.
  void key(const std::string& symbol, const std::vector<std::string>& modifiers = {});
  // Several keys without a pause, as a fast typist or a tool presses them.
  void typeFast(const std::vector<std::string>& symbols);
  void resize(unsigned width, unsigned height);
  void hide();
  void show();
  // Drops a file as a file manager does. Returns false if the window rejects it.
  bool drop(const std::string& path, int x, int y);
  std::string clipboard();
  void close();  // as the close button of a window manager

  io::Image screenshot();  // 8-bit RGB of the whole window

 private:
  void sendKey(const std::string& symbol, bool down);
  void send(unsigned long target, const char* type, const std::vector<long>& data);
  void answerSelection(void* event, const std::string& text);

  _XDisplay* display_;
  unsigned long window_ = 0, source_ = 0;
};

}  // namespace quintet::test
#endif
