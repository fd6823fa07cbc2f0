// SPDX-License-Identifier: Apache-2.0
#include "window/window.h"

#include <dlfcn.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/error.h"

// After gpu/vulkan.h, so that GLFW declares its functions for Vulkan.
#include <GLFW/glfw3.h>

namespace quintet::viewer {
namespace {

std::string lastGlfwError() {
  const char* text = nullptr;
  return ::glfwGetError(&text) == GLFW_NO_ERROR || !text ? "unknown reason" : text;
}

// Whether the X server of $DISPLAY has the extension GLX; true if GLFW uses no X server. The functions are those of the
// libX11 that GLFW loads, so that the build requires no headers of X11.
bool serverHasGlx() {
  void* const library = ::dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (!library) return true;
  const auto open = reinterpret_cast<void* (*)(const char*)>(::dlsym(library, "XOpenDisplay"));
  const auto close = reinterpret_cast<int (*)(void*)>(::dlsym(library, "XCloseDisplay"));
  const auto query =
      reinterpret_cast<int (*)(void*, const char*, int*, int*, int*)>(::dlsym(library, "XQueryExtension"));
  bool found = true;
  if (void* const display = open && close && query ? open(nullptr) : nullptr) {
    int code = 0, event = 0, error = 0;
    found = query(display, "GLX", &code, &event, &error) != 0;
    close(display);
  }
  ::dlclose(library);
  return found;
}

Modifiers modifiersOf(int bits) {
  return {(bits & GLFW_MOD_SHIFT) != 0, (bits & GLFW_MOD_CONTROL) != 0, (bits & GLFW_MOD_ALT) != 0};
}

// Keys without a character.
std::string keyName(int key) {
  switch (key) {
    case GLFW_KEY_SPACE: return "Space";
    case GLFW_KEY_ESCAPE: return "Escape";
    case GLFW_KEY_TAB: return "Tab";
    case GLFW_KEY_HOME: return "Home";
    case GLFW_KEY_PAGE_UP: return "PageUp";
    case GLFW_KEY_PAGE_DOWN: return "PageDown";
    case GLFW_KEY_DELETE: return "Delete";
    case GLFW_KEY_KP_DECIMAL: return "Keypad .";
    default: break;
  }
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return fmt::format("F{}", key - GLFW_KEY_F1 + 1);
  return {};
}

bool isLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// The letter that the key types, in the current layout of the keyboard.
std::string letterName(int key, int scancode) {
  const char* name = ::glfwGetKeyName(key, scancode);
  if (!name || name[0] == '\0' || name[1] != '\0' || !isLetter(name[0])) return {};
  return {static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])))};
}

}  // namespace

// Each callback keeps what happened, and deliver() passes it on in a later frame if this one has enough.
struct Window::Callbacks {
  static Window& of(GLFWwindow* handle) { return *static_cast<Window*>(::glfwGetWindowUserPointer(handle)); }

  template <class Function>
  static void wait(GLFWwindow* handle, bool isKey, bool endsFrame, const Function& function) {
    Window& window = of(handle);
    window.waiting_.push_back({[&window, function] { function(window); }, isKey, endsFrame});
  }
  static vec2 pointer(GLFWwindow* handle) {
    double x = 0, y = 0;
    ::glfwGetCursorPos(handle, &x, &y);
    return {x, y};
  }

  static void key(GLFWwindow* handle, int key, int scancode, int action, int mods) {
    KeyEvent event;
    event.key = keyName(key);
    if (event.key.empty()) event.key = letterName(key, scancode);
    if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) event.position = std::string(1, static_cast<char>(key));
    event.modifiers = modifiersOf(mods);
    event.pressed = action != GLFW_RELEASE;
    event.repeated = action == GLFW_REPEAT;
    // The user interface sees which keys are down in a frame. Keys that type a character need not be seen.
    const bool isModifier = key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER;
    const bool isCommand = (key >= GLFW_KEY_ESCAPE && !isModifier) || (mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) != 0;
    wait(handle, true, action == GLFW_PRESS && isCommand && !isModifier, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->key(key, scancode, action, mods);
      window.keyRepeats_ = event.repeated;
      if (!event.key.empty() || !event.position.empty()) window.events_.emplace_back(event);
    });
  }

  static void character(GLFWwindow* handle, unsigned codepoint) {
    wait(handle, true, false, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->character(codepoint);
      // Letters and the space are those of key().
      if (codepoint <= ' ' || codepoint > '~' || isLetter(static_cast<char>(codepoint))) return;
      window.events_.emplace_back(
          KeyEvent{.key = {static_cast<char>(codepoint)}, .pressed = true, .repeated = window.keyRepeats_});
    });
  }

  static void button(GLFWwindow* handle, int button, int action, int mods) {
    const vec2 at = pointer(handle);
    wait(handle, false, true, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->button(button, action, mods);
      if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
      window.events_.emplace_back(ButtonEvent{.button = button == GLFW_MOUSE_BUTTON_LEFT    ? MouseButton::left
                                                        : button == GLFW_MOUSE_BUTTON_RIGHT ? MouseButton::right
                                                                                            : MouseButton::middle,
                                              .modifiers = modifiersOf(mods),
                                              .position = at,
                                              .pressed = action == GLFW_PRESS});
    });
  }

  static void cursor(GLFWwindow* handle, double x, double y) {
    wait(handle, false, false, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->cursor(x, y);
      window.events_.emplace_back(MoveEvent{{x, y}});
    });
  }

  static void cursorEnter(GLFWwindow* handle, int entered) {
    wait(handle, false, false, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->cursorEnter(entered);
    });
  }

  static void scroll(GLFWwindow* handle, double x, double steps) {
    const vec2 at = pointer(handle);
    wait(handle, false, false, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->scroll(x, steps);
      window.events_.emplace_back(WheelEvent{static_cast<float>(steps), at});
    });
  }

  static void drop(GLFWwindow* handle, int count, const char** paths) {
    wait(handle, false, false, [files = std::vector<std::string>(paths, paths + count)](Window& window) {
      window.events_.emplace_back(DropEvent{files});
    });
  }

  static void focus(GLFWwindow* handle, int focused) {
    wait(handle, false, false, [=](Window& window) {
      if (window.rawInput_) window.rawInput_->focus(focused);
      window.events_.emplace_back(FocusEvent{focused == GLFW_TRUE});
    });
  }
};

Window::Window(const std::string& title, uvec2 size) {
  if (!::glfwInit()) throw Error(fmt::format("cannot open a window: {}", lastGlfwError()));
  if (!::glfwVulkanSupported()) {
    ::glfwTerminate();
    throw Error("cannot open a window: the Vulkan loader supports no windows");
  }
  ::glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  ::glfwWindowHintString(GLFW_X11_CLASS_NAME, "quintet-view");  // GLFW uses the class only with an instance name
  ::glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "quintet-view");
  handle_ = ::glfwCreateWindow(static_cast<int>(size.x), static_cast<int>(size.y), title.c_str(), nullptr, nullptr);
  if (!handle_) {
    const std::string reason = lastGlfwError();
    ::glfwTerminate();
    throw Error(fmt::format("cannot open a window: {}", reason));
  }
  ::glfwSetWindowUserPointer(handle_, this);
  ::glfwSetKeyCallback(handle_, Callbacks::key);
  ::glfwSetCharCallback(handle_, Callbacks::character);
  ::glfwSetMouseButtonCallback(handle_, Callbacks::button);
  ::glfwSetCursorPosCallback(handle_, Callbacks::cursor);
  ::glfwSetCursorEnterCallback(handle_, Callbacks::cursorEnter);
  ::glfwSetScrollCallback(handle_, Callbacks::scroll);
  ::glfwSetDropCallback(handle_, Callbacks::drop);
  ::glfwSetWindowFocusCallback(handle_, Callbacks::focus);
}

Window::~Window() {
  ::glfwDestroyWindow(handle_);
  ::glfwTerminate();
}

gpu::SurfaceSource Window::surfaceSource() const {
  gpu::SurfaceSource source;
  std::uint32_t count = 0;
  const char** names = ::glfwGetRequiredInstanceExtensions(&count);
  if (names) source.instanceExtensions.assign(names, names + count);
  const auto ofX11 = [](const std::string& name) {
    return name == "VK_KHR_xlib_surface" || name == "VK_KHR_xcb_surface";
  };
  source.hasGlx = std::ranges::none_of(source.instanceExtensions, ofX11) || serverHasGlx();
  source.create = [handle = handle_](VkInstance instance) {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(::glfwCreateWindowSurface(instance, handle, nullptr, &surface), "create the surface of the window");
    return surface;
  };
  return source;
}

uvec2 Window::size() const {
  int width = 0, height = 0;
  ::glfwGetFramebufferSize(handle_, &width, &height);
  return {static_cast<std::uint32_t>(std::max(width, 0)), static_cast<std::uint32_t>(std::max(height, 0))};
}

float Window::contentScale() const {
  float x = 1.0f, y = 1.0f;
  ::glfwGetWindowContentScale(handle_, &x, &y);
  return std::max(x, y);
}

float Window::pixelScale() const {
  int width = 0, height = 0;
  ::glfwGetWindowSize(handle_, &width, &height);
  const uvec2 pixels = size();
  return width > 0 && pixels.x > 0 ? static_cast<float>(pixels.x) / static_cast<float>(width) : 1.0f;
}

uvec2 Window::windowedSize() const {
  int width = windowedWidth_, height = windowedHeight_;
  if (!::glfwGetWindowMonitor(handle_)) ::glfwGetWindowSize(handle_, &width, &height);
  return {static_cast<std::uint32_t>(std::max(width, 0)), static_cast<std::uint32_t>(std::max(height, 0))};
}

std::optional<glm::ivec2> Window::position() const {
  if (::glfwGetWindowMonitor(handle_)) return std::nullopt;
  glm::ivec2 position{0};
  ::glfwGetError(nullptr);  // forgets an earlier one
  ::glfwGetWindowPos(handle_, &position.x, &position.y);
  if (::glfwGetError(nullptr) != GLFW_NO_ERROR) return std::nullopt;  // Wayland
  return position;
}

void Window::setPosition(glm::ivec2 position) { ::glfwSetWindowPos(handle_, position.x, position.y); }

bool Window::shouldClose() const { return ::glfwWindowShouldClose(handle_) == GLFW_TRUE; }
bool Window::minimized() const { return ::glfwGetWindowAttrib(handle_, GLFW_ICONIFIED) == GLFW_TRUE; }

std::vector<InputEvent> Window::waitForEvents(double seconds, bool holdsKeys) {
  const bool hasInput = !waiting_.empty() && !(holdsKeys && waiting_.front().isKey);
  if (seconds > 0 && !hasInput)
    ::glfwWaitEventsTimeout(seconds);
  else
    ::glfwPollEvents();
  while (!waiting_.empty() && !(holdsKeys && waiting_.front().isKey)) {
    const Waiting input = std::move(waiting_.front());
    waiting_.pop_front();
    input.deliver();
    if (input.endsFrame) break;
  }
  return std::exchange(events_, {});
}

void Window::wake() { ::glfwPostEmptyEvent(); }

void Window::setTitle(const std::string& title) { ::glfwSetWindowTitle(handle_, title.c_str()); }

void Window::toggleFullScreen() {
  if (::glfwGetWindowMonitor(handle_)) {
    ::glfwSetWindowMonitor(handle_, nullptr, windowedX_, windowedY_, windowedWidth_, windowedHeight_, GLFW_DONT_CARE);
    return;
  }
  GLFWmonitor* monitor = ::glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? ::glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  ::glfwGetWindowPos(handle_, &windowedX_, &windowedY_);
  ::glfwGetWindowSize(handle_, &windowedWidth_, &windowedHeight_);
  ::glfwSetWindowMonitor(handle_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::setClipboard(const std::string& text) { ::glfwSetClipboardString(handle_, text.c_str()); }

}  // namespace quintet::viewer
