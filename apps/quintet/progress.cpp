#include "progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "standard_error.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr double kBarSeconds = 0.1;
constexpr double kLineSeconds = 10.0;
constexpr double kUnknown = std::numeric_limits<double>::infinity();

// NO_COLOR (no-color.org) and dumb terminals.
bool wantsColor() {
  const char* noColor = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return !(noColor && *noColor) && !(term && std::string_view(term) == "dumb");
}

int terminalWidth() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

// The figures, separated by `gap`.
std::string figures(const ProgressState& state, std::string_view gap) {
  std::string text = fmt::format("{}", static_cast<std::uint64_t>(state.samples));
  if (state.sampleLimit) text += fmt::format("/{}", *state.sampleLimit);
  text += fmt::format(" {}", state.unit);
  if (state.raysPerSecond > 0) text += fmt::format("{}{:.3g} Mrays/s", gap, state.raysPerSecond * 1e-6);
  if (state.error && std::isfinite(*state.error)) text += fmt::format("{}error {:.2g} %", gap, 100.0 * *state.error);
  text += fmt::format("{}{}", gap, durationText(state.seconds));
  if (const double left = state.secondsLeft(); left < kUnknown)
    text += fmt::format("{}{} left", gap, durationText(left));
  return text;
}

}  // namespace

double ProgressState::fraction() const {
  double done = 0;
  if (sampleLimit && *sampleLimit > 0) done = samples / static_cast<double>(*sampleLimit);
  if (secondLimit && *secondLimit > 0) done = std::max(done, seconds / *secondLimit);
  return std::clamp(done, 0.0, 1.0);
}

double ProgressState::secondsLeft() const {
  double left = kUnknown;
  if (secondLimit) left = std::max(*secondLimit - seconds, 0.0);
  if (sampleLimit && samples > 0)
    left = std::min(left, std::max((static_cast<double>(*sampleLimit) / samples - 1.0) * seconds, 0.0));
  return left;
}

std::string progressBar(const ProgressState& state, int width, bool color) {
  const std::string text = figures(state, "  ");
  const int room = width - static_cast<int>(text.size()) - 4;
  if (room < 8) return text.substr(0, static_cast<std::size_t>(std::max(width - 1, 0)));
  const int length = std::min(room, 40);
  const int done = static_cast<int>(std::floor(state.fraction() * length));
  std::string filled(static_cast<std::size_t>(done), '=');
  if (done < length) filled += '>';
  const std::string rest(static_cast<std::size_t>(std::max(length - done - 1, 0)), ' ');
  return color ? fmt::format("[\x1b[32m{}\x1b[0m{}] {}", filled, rest, text)
               : fmt::format("[{}{}] {}", filled, rest, text);
}

std::string progressLine(const ProgressState& state) { return figures(state, ", "); }

bool colorOnStandardError() { return ::isatty(STDERR_FILENO) == 1 && wantsColor(); }

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1), color_(wantsColor()) {}

void Progress::show(const std::string& line) {
  printError("\r\x1b[K{}", line);
  shown_ = true;
}

void Progress::stage(const std::string& text) {
  if (!quiet_ && terminal_) show(text + " ...");
}

void Progress::update(const ProgressState& state) {
  const double now = clock_.seconds();
  if (quiet_ || now - last_ < (terminal_ ? kBarSeconds : kLineSeconds)) return;
  last_ = now;
  if (terminal_) {
    show(progressBar(state, terminalWidth(), color_));
  } else {
    printError("{}\n", progressLine(state));
  }
}

void Progress::note(const std::string& text) {
  if (quiet_) return;
  clear();
  printError("{}\n", text);
}

void Progress::clear() {
  if (!shown_) return;
  printError("\r\x1b[K");
  shown_ = false;
}

}  // namespace quintet::app
