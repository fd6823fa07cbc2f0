// What a long job tells a person on standard error: a bar on a terminal, a line every ten seconds
// elsewhere, nothing with --quiet.
#ifndef QUINTET_APP_PROGRESS_H
#define QUINTET_APP_PROGRESS_H

#include <cstdint>
#include <optional>
#include <string>

#include "base/stopwatch.h"

namespace quintet::app {

struct ProgressState {
  double samples = 0;        // per pixel, with the done part of the running batch
  double seconds = 0;        // since rendering began
  double raysPerSecond = 0;  // 0: not known yet
  std::optional<std::uint64_t> sampleLimit;
  std::optional<double> error;   // relative, stated
  const char* unit = "samples";  // or "frames"
  std::optional<double> secondLimit;

  double fraction() const;     // of the limit that is reached first, [0,1]
  double secondsLeft() const;  // infinity: not known yet
};

// "[=====>    ] 32/64 samples  12.3 Mrays/s  5.0 s  5.1 s left", at most `width` characters.
std::string progressBar(const ProgressState& state, int width, bool color);
// "32/64 samples, 12.3 Mrays/s, 5.0 s, 5.1 s left"
std::string progressLine(const ProgressState& state);

// A terminal, and neither NO_COLOR (no-color.org) nor TERM=dumb.
bool colorOnStandardError();

class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // A step whose end is not known: "compiling shaders". Shown on a terminal only.
  void stage(const std::string& text);
  void update(const ProgressState& state);
  // A line that stays, above the bar.
  void note(const std::string& text);
  void clear();  // removes the bar

 private:
  void show(const std::string& line);
  bool quiet_;
  bool terminal_;
  bool color_;
  bool shown_ = false;
  Stopwatch clock_;
  double last_ = 0;  // when the bar or the line was last written
};

}  // namespace quintet::app
#endif
