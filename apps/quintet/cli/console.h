// SPDX-License-Identifier: Apache-2.0
// What a command prints for people on standard error: progress, notes, warnings and diagnostics; and how Ctrl-C reaches the job.
#ifndef QUINTET_CLI_CONSOLE_H
#define QUINTET_CLI_CONSOLE_H

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/stopwatch.h"
#include "cli/signals.h"
#include "job/observer.h"
#include "program/description/program.h"

namespace quintet::cli {

// Prints one line to standard error. A terminal gets lines that break between words.
void printMessage(const std::string& text);

// Writes to standard output, unless its reader has ended.
void printFailureJson(const std::string& text);

// The value of --color: "always", "never", or "auto" for colorOnStandardError(). Throws UsageError.
bool parseColor(const std::string& name);

// "[=====>    ] 32/64 samples  12.3 Mrays/s  5.0 s  5.1 s left", at most `width` characters.
std::string progressBar(const job::Progress& progress, int width, bool color);
// "32/64 samples, 12.3 Mrays/s, 5.0 s, 5.1 s left"
std::string progressLine(const job::Progress& progress);

// Diagnostics with source lines on standard error, followed by their number; with `json` as an array on standard output.
// `program`: null if its description could not be read.
void printDiagnostics(const std::vector<Diagnostic>& diagnostics, const program::Program* program, bool json);

// After a launch that did not end in time: prints the diagnostic and exits without destructors, which would wait for the
// device.
[[noreturn]] void exitAfterHang(const program::Program* program, const Diagnostic& diagnostic);

struct ConsoleOptions {
  bool quiet = false;          // neither progress nor notes
  bool json = false;           // errors of programs also as JSON on standard output
  bool jsonProgress = false;   // a line of JSON for each batch and warning, instead of progress
  bool collectPrints = false;  // the request asks for what the program prints
  // What the first Ctrl-C does, and the second one.
  std::string stopNote = "finishing the current batch; press Ctrl-C again to quit without an image";
};

// The observer of a command: a bar on a terminal, a line every ten seconds elsewhere.
class Console : public job::Observer {
 public:
  explicit Console(const ConsoleOptions& options);
  ~Console() override { clear(); }

  // For source lines of diagnostics; null: the files on disk. Must stay valid.
  void setProgram(const program::Program* program);
  // While set, Ctrl-C ends the job at the next opportunity. Must stay valid.
  void setGracefulStop(const GracefulStop* stop) { stop_ = stop; }

  void stage(const std::string& text) override;
  void note(const std::string& text) override;
  void warning(const std::string& text) override;
  void diagnostics(const std::vector<Diagnostic>& found) override;
  void printed(const job::Printed& prints) override;
  void printsDisabled() override;
  void progress(const job::Progress& state) override;
  void batch(const job::BatchReport& report) override;
  bool showsError() const override { return !options_.quiet; }
  job::StopRequest stopRequested() override;
  void write(const std::filesystem::path& file, std::span<const std::byte> bytes) override;
  void deviceHung(const Diagnostic& diagnostic) override;
  bool isFrameWritten(const job::Provenance& frame) override { return wasWritten && wasWritten(frame); }
  void frame(const job::RenderResult& result) override;
  bool wantsPreviews() const override { return static_cast<bool>(onPreview); }
  void preview(const job::RenderResult& result) override;

  std::function<void(const job::RenderResult&)> onFrame, onPreview;
  std::function<bool(const job::Provenance&)> wasWritten;  // the frame, by an earlier run
  std::function<bool()> isObsolete;                        // the render is obsolete

  void clear();                               // removes the bar
  std::vector<std::string> warnings() const;  // so far
  void clearReport();                         // discards warnings and prints; before the next render of --watch
  // What the program printed since the last call, with a note about omitted lines. Unset unless collectPrints is set.
  std::optional<job::Printed> takePrints();

 private:
  void show(const std::string& line);
  void clearLocked();

  const ConsoleOptions options_;
  const bool terminal_;
  const bool color_;
  mutable std::mutex mutex_;  // warnings come from the driver's threads
  bool barVisible_ = false;
  std::vector<std::string> warnings_;
  job::Printed prints_;  // since takePrints()
  const program::Program* program_ = nullptr;
  const GracefulStop* stop_ = nullptr;
  bool stopNoted_ = false;
  Stopwatch clock_;
  double lastProgress_ = 0;  // on clock_
};

}  // namespace quintet::cli
#endif
