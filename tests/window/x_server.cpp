// SPDX-License-Identifier: Apache-2.0
#include "x_server.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>

namespace quintet::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLimit{60};
constexpr std::chrono::milliseconds kPause{20};

void pause() { std::this_thread::sleep_for(kPause); }

Atom atom(Display* display, const char* name) { return ::XInternAtom(display, name, False); }

// The top-level window with this class; 0 if there is none yet.
Window findWindow(Display* display, const char* name) {
  Window root = 0, parent = 0, *children = nullptr, found = 0;
  unsigned count = 0;
  if (!::XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count)) return 0;
  for (unsigned i = 0; i < count; ++i) {
    XClassHint hint{};
    if (!::XGetClassHint(display, children[i], &hint)) continue;
    XWindowAttributes attributes{};
    ::XGetWindowAttributes(display, children[i], &attributes);
    if (std::strcmp(hint.res_class, name) == 0 && attributes.map_state == IsViewable) found = children[i];
    ::XFree(hint.res_name);
    ::XFree(hint.res_class);
  }
  if (children) ::XFree(children);
  return found;
}

}  // namespace

XServer::XServer() {
  int pipe[2];
  if (::pipe(pipe) != 0) throw std::runtime_error("cannot create a pipe");
  process_ = ::fork();
  if (process_ == 0) {
    ::close(pipe[0]);
    const std::string descriptor = std::to_string(pipe[1]);
    ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);  // it reports display numbers that are taken
    ::execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "2560x1600x24", "-nolisten", "tcp",
             "-noreset", nullptr);
    ::_exit(127);
  }
  ::close(pipe[1]);
  std::string number;
  for (char c = 0; ::read(pipe[0], &c, 1) == 1 && c != '\n';) number += c;
  ::close(pipe[0]);
  if (number.empty()) throw std::runtime_error("Xvfb does not start (package xvfb)");
  display_ = ":" + number;
}

XServer::~XServer() {
  ::kill(process_, SIGTERM);
  ::waitpid(process_, nullptr, 0);
}

XWindow::XWindow(const std::string& display, const std::function<bool()>& alive)
    : display_(::XOpenDisplay(display.c_str())) {
  if (!display_) throw std::runtime_error("cannot connect to the X server");
  const Clock::time_point end = Clock::now() + kLimit;
  while (!(window_ = findWindow(display_, "quintet-view"))) {
    if (!alive() || Clock::now() > end) {
      ::XCloseDisplay(display_);
      throw std::runtime_error("no window appears");
    }
    pause();
  }
  // There is no window manager that would do this.
  ::XSetInputFocus(display_, window_, RevertToParent, CurrentTime);
  source_ = ::XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
  ::XSync(display_, False);
}

XWindow::~XWindow() { ::XCloseDisplay(display_); }

void XWindow::move(int x, int y) {
  int rootX = 0, rootY = 0;
  Window child = 0;
  ::XTranslateCoordinates(display_, window_, DefaultRootWindow(display_), x, y, &rootX, &rootY, &child);
  ::XTestFakeMotionEvent(display_, -1, rootX, rootY, CurrentTime);
  ::XSync(display_, False);
  pause();
}

void XWindow::press(unsigned button) {
  ::XTestFakeButtonEvent(display_, button, True, CurrentTime);
  ::XSync(display_, False);
  pause();
}

void XWindow::release(unsigned button) {
  ::XTestFakeButtonEvent(display_, button, False, CurrentTime);
  ::XSync(display_, False);
  pause();
}

void XWindow::click(int x, int y, unsigned button, const std::vector<std::string>& modifiers) {
  move(x, y);
  for (const std::string& modifier : modifiers) sendKey(modifier, true);
  press(button);
  release(button);
  for (const std::string& modifier : modifiers) sendKey(modifier, false);
}

void XWindow::drag(int fromX, int fromY, int toX, int toY, unsigned button) {
  move(fromX, fromY);
  press(button);
  constexpr int kSteps = 5;
  for (int i = 1; i <= kSteps; ++i) move(fromX + (toX - fromX) * i / kSteps, fromY + (toY - fromY) * i / kSteps);
  release(button);
}

void XWindow::sendKey(const std::string& symbol, bool down) {
  const KeyCode code = ::XKeysymToKeycode(display_, ::XStringToKeysym(symbol.c_str()));
  if (code == 0) throw std::runtime_error("no key " + symbol);
  ::XTestFakeKeyEvent(display_, code, down ? True : False, CurrentTime);
  ::XSync(display_, False);
  pause();
}

void XWindow::key(const std::string& symbol, const std::vector<std::string>& modifiers) {
  for (const std::string& modifier : modifiers) sendKey(modifier, true);
  sendKey(symbol, true);
  sendKey(symbol, false);
  for (const std::string& modifier : modifiers) sendKey(modifier, false);
}

void XWindow::typeFast(const std::vector<std::string>& symbols) {
  for (const std::string& symbol : symbols) {
    const KeyCode code = ::XKeysymToKeycode(display_, ::XStringToKeysym(symbol.c_str()));
    if (code == 0) throw std::runtime_error("no key " + symbol);
    ::XTestFakeKeyEvent(display_, code, True, CurrentTime);
    ::XTestFakeKeyEvent(display_, code, False, CurrentTime);
  }
  ::XSync(display_, False);
}

void XWindow::resize(unsigned width, unsigned height) {
  ::XResizeWindow(display_, window_, width, height);
  ::XSync(display_, False);
  pause();
}

void XWindow::hide() {
  ::XUnmapWindow(display_, window_);
  ::XSync(display_, False);
  pause();
}

void XWindow::show() {
  ::XMapWindow(display_, window_);
  ::XSync(display_, False);
  pause();
  ::XSetInputFocus(display_, window_, RevertToParent, CurrentTime);
  ::XSync(display_, False);
}

void XWindow::send(unsigned long target, const char* type, const std::vector<long>& data) {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = target;
  event.xclient.message_type = atom(display_, type);
  event.xclient.format = 32;
  for (std::size_t i = 0; i < data.size(); ++i) event.xclient.data.l[i] = data[i];
  ::XSendEvent(display_, target, False, NoEventMask, &event);
  ::XFlush(display_);
}

void XWindow::close() {
  send(window_, "WM_PROTOCOLS", {static_cast<long>(atom(display_, "WM_DELETE_WINDOW")), CurrentTime});
}

// Gives the owner's text to the window that requests the selection.
void XWindow::answerSelection(void* data, const std::string& text) {
  const XSelectionRequestEvent& request = static_cast<XEvent*>(data)->xselectionrequest;
  ::XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
  XEvent answer{};
  answer.xselection.type = SelectionNotify;
  answer.xselection.requestor = request.requestor;
  answer.xselection.selection = request.selection;
  answer.xselection.target = request.target;
  answer.xselection.property = request.property;
  answer.xselection.time = request.time;
  ::XSendEvent(display_, request.requestor, False, NoEventMask, &answer);
  ::XFlush(display_);
}

// The protocol is XDND, version 5.
bool XWindow::drop(const std::string& path, int x, int y) {
  const auto list = static_cast<long>(atom(display_, "text/uri-list"));
  const auto source = static_cast<long>(source_);
  const std::string text = "file://" + path + "\r\n";
  int rootX = 0, rootY = 0;
  Window child = 0;
  ::XTranslateCoordinates(display_, window_, DefaultRootWindow(display_), x, y, &rootX, &rootY, &child);
  ::XSetSelectionOwner(display_, atom(display_, "XdndSelection"), source_, CurrentTime);
  send(window_, "XdndEnter", {source, 5L << 24, list, 0, 0});
  send(window_, "XdndPosition",
       {source, 0, static_cast<long>(rootX) << 16 | rootY, CurrentTime,
        static_cast<long>(atom(display_, "XdndActionCopy"))});
  bool dropped = false;
  const Clock::time_point end = Clock::now() + kLimit;
  while (Clock::now() < end) {
    if (::XPending(display_) == 0) {
      pause();
      continue;
    }
    XEvent event{};
    ::XNextEvent(display_, &event);
    if (event.type == SelectionRequest) answerSelection(&event, text);
    if (event.type != ClientMessage) continue;
    if (event.xclient.message_type == atom(display_, "XdndStatus") && !dropped) {
      if (!(event.xclient.data.l[1] & 1)) return false;
      dropped = true;
      send(window_, "XdndDrop", {source, 0, CurrentTime, 0, 0});
    }
    if (event.xclient.message_type == atom(display_, "XdndFinished")) return true;
  }
  return false;
}

std::string XWindow::clipboard() {
  const Atom property = atom(display_, "QUINTET_CLIPBOARD");
  const Atom text = atom(display_, "UTF8_STRING");
  ::XConvertSelection(display_, atom(display_, "CLIPBOARD"), text, property, source_, CurrentTime);
  ::XFlush(display_);
  const Clock::time_point end = Clock::now() + kLimit;
  while (Clock::now() < end) {
    if (::XPending(display_) == 0) {
      pause();
      continue;
    }
    XEvent event{};
    ::XNextEvent(display_, &event);
    if (event.type != SelectionNotify) continue;
    if (event.xselection.property == None) return {};
    Atom type = 0;
    int format = 0;
    unsigned long count = 0, rest = 0;
    unsigned char* data = nullptr;
    ::XGetWindowProperty(display_, source_, property, 0, 1 << 20, True, AnyPropertyType, &type, &format, &count, &rest,
                         &data);
    std::string result(reinterpret_cast<const char*>(data), count);
    ::XFree(data);
    return result;
  }
  return {};
}

io::Image XWindow::screenshot() {
  XWindowAttributes attributes{};
  ::XGetWindowAttributes(display_, window_, &attributes);
  XImage* shot = ::XGetImage(display_, window_, 0, 0, static_cast<unsigned>(attributes.width),
                             static_cast<unsigned>(attributes.height), AllPlanes, ZPixmap);
  if (!shot) throw std::runtime_error("cannot read the window");
  io::Image image = io::makeImage(static_cast<std::uint32_t>(shot->width), static_cast<std::uint32_t>(shot->height), 3,
                                  io::PixelType::u8, io::ColorEncoding::sRgb);
  for (int y = 0; y < shot->height; ++y)
    for (int x = 0; x < shot->width; ++x) {
      const unsigned long value = XGetPixel(shot, x, y);
      const auto pixel = image.pixel<std::uint8_t>(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
      pixel[0] = static_cast<std::uint8_t>(value >> 16);
      pixel[1] = static_cast<std::uint8_t>(value >> 8);
      pixel[2] = static_cast<std::uint8_t>(value);
    }
  XDestroyImage(shot);
  return image;
}

}  // namespace quintet::test
