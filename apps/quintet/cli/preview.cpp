// SPDX-License-Identifier: Apache-2.0
#include "cli/preview.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parse.h"
#include "cli/signals.h"
#include "cli/terminal.h"
#include "cli/values.h"

namespace quintet::cli {
namespace {

using io::TerminalProtocol;

constexpr std::chrono::milliseconds kAnswerTime{1000};  // connections to distant machines are slow

std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool insideMultiplexer() {
  const std::string_view term = variable("TERM");
  return !variable("TMUX").empty() || term.starts_with("tmux") || term.starts_with("screen");
}

// Terminals that are known to draw images. A multiplexer hides its terminal.
std::optional<TerminalProtocol> protocolByEnvironment() {
  if (insideMultiplexer()) return {};
  const std::string_view term = variable("TERM"), program = variable("TERM_PROGRAM");
  if (!variable("KITTY_WINDOW_ID").empty() || term == "xterm-kitty" || term == "xterm-ghostty" || program == "ghostty")
    return TerminalProtocol::kitty;
  // WezTerm answers commands of kitty although it is asked not to.
  if (program == "WezTerm" || !variable("WEZTERM_PANE").empty() || term == "wezterm" || term.starts_with("foot") ||
      term == "mlterm")
    return TerminalProtocol::sixel;
  return {};
}

// The terminal of standard error, with input without echo and line buffering. Ctrl-C stays a signal.
class RawInput {
 public:
  RawInput() : valid_(::tcgetattr(STDERR_FILENO, &before_) == 0) {
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    valid_ = valid_ && ::tcsetattr(STDERR_FILENO, TCSANOW, &raw) == 0;
  }
  ~RawInput() {
    if (valid_) ::tcsetattr(STDERR_FILENO, TCSANOW, &before_);
  }
  RawInput(const RawInput&) = delete;
  RawInput& operator=(const RawInput&) = delete;

  bool valid() const { return valid_; }
  // Something was typed already.
  static bool pending() {
    int count = 0;
    return ::ioctl(STDERR_FILENO, FIONREAD, &count) != 0 || count > 0;
  }

 private:
  const ProtectedWrite protect_;  // a signal ends the process after the destructor
  termios before_{};
  bool valid_;
};

// The answer "\x1b[?62;4;22c" to the request for primary device attributes, from the first number on; empty if there is none.
std::string deviceAttributes() {
  // A process in the background would be stopped.
  const pid_t foreground = ::tcgetpgrp(STDERR_FILENO);
  if (foreground >= 0 && foreground != ::getpgrp()) return "";
  const RawInput input;
  if (!input.valid() || RawInput::pending()) return "";
  printError("\x1b[c");
  std::string text;
  const auto end = std::chrono::steady_clock::now() + kAnswerTime;
  while (true) {
    const std::size_t first = text.find("\x1b[?"), last = text.find('c', std::min(first, text.size()));
    if (last != text.npos) return text.substr(first + 3, last - first - 3);
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    pollfd waiting{STDERR_FILENO, POLLIN, 0};
    if (left.count() <= 0 || ::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) return "";
    std::array<char, 256> buffer{};
    const ssize_t got = ::read(STDERR_FILENO, buffer.data(), buffer.size());
    if (got <= 0) return "";
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

// Attribute 4 after the class of the terminal.
bool answersSixel() {
  const std::vector<std::string> attributes = splitText(deviceAttributes(), ';');
  return attributes.size() > 1 && std::find(attributes.begin() + 1, attributes.end(), "4") != attributes.end();
}

io::TerminalArea areaForImage() {
  winsize size{};
  io::TerminalArea area;
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
    area = {size.ws_col, size.ws_row, static_cast<std::uint32_t>(size.ws_xpixel / size.ws_col),
            static_cast<std::uint32_t>(size.ws_ypixel / size.ws_row)};
  }
  area.rows = std::max(area.rows, 3u) - 2;  // the progress line, and a row of what was there before
  return area;
}

}  // namespace

std::vector<std::string> previewNames() { return {"auto", "kitty", "sixel", "blocks", "off"}; }

PreviewChoice choosePreview(const std::string& name) {
  const std::size_t choice = parseChoice("--preview", name, previewNames());
  if (name == "off") return {};
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  if (name != "auto") {
    if (!terminal) throw UsageError(fmt::format("--preview={}: standard error is not a terminal", name));
    constexpr std::array kProtocols{TerminalProtocol::kitty, TerminalProtocol::sixel, TerminalProtocol::halfBlocks};
    return {kProtocols[choice - 1], ""};
  }
  if (!terminal) return {{}, "no preview: standard error is not a terminal"};
  if (variable("TERM") == "dumb") return {{}, "no preview: the terminal cannot show images (TERM=dumb)"};
  if (const auto known = protocolByEnvironment()) return {known, ""};
  if (answersSixel()) return {TerminalProtocol::sixel, ""};
  if (!colorOnStandardError()) return {{}, "no preview: NO_COLOR is set; --preview=blocks overrides it"};
  return {TerminalProtocol::halfBlocks, ""};
}

Preview::Preview(TerminalProtocol protocol)
    : protocol_(protocol),
      trueColor_(variable("COLORTERM") == "truecolor" || variable("COLORTERM") == "24bit"),
      // Different from the ids of earlier processes, whose images the terminal still shows.
      id_(static_cast<std::uint32_t>(::getpid()) << 8 | 1) {}

std::string Preview::draw(const io::Image& image) {
  const io::TerminalArea area = areaForImage();
  const io::TerminalFit fit = io::fitToTerminal(image.width, image.height, area, protocol_);
  std::string text;
  // After a change of the size, text can be anywhere.
  if (visible_ && (area != area_ || fit.rows != fit_.rows || fit.width != fit_.width)) text += erase();
  if (!visible_) text.append(fit.rows, '\n');
  text += fmt::format("\x1b[{}A", fit.rows);
  const bool sameSize = fit.width == image.width && fit.height == image.height;
  const io::Image scaled = sameSize ? image : io::toSrgb8(io::resizeBox(image, fit.width, fit.height));
  const std::string down = fmt::format("\x1b[{}B", fit.rows);
  switch (protocol_) {
    case TerminalProtocol::kitty: text += io::encodeKitty(scaled, id_) + down; break;
    case TerminalProtocol::sixel: text += io::encodeSixel(scaled) + down; break;
    case TerminalProtocol::halfBlocks: text += io::encodeHalfBlocks(scaled, trueColor_); break;
  }
  area_ = area;
  fit_ = fit;
  visible_ = true;
  return text;
}

std::string Preview::erase() {
  if (!visible_) return "";
  visible_ = false;
  return (protocol_ == TerminalProtocol::kitty ? io::deleteKitty(id_) : "") + fmt::format("\x1b[{}A\x1b[J", fit_.rows);
}

void Preview::keep() {
  if (visible_) ++id_;
  visible_ = false;
}

}  // namespace quintet::cli
