// SPDX-License-Identifier: Apache-2.0
#include "cli/console.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/parse.h"
#include "base/plural.h"
#include "base/text.h"
#include "base/wrap.h"
#include "check/diagnostic_text.h"
#include "cli/exit_status.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "output/report.h"

namespace quintet::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBarSeconds = 0.1;
constexpr double kLineSeconds = 10.0;
constexpr const char* kClearLine = "\r\x1b[K";

bool isTerminal() { return ::isatty(STDERR_FILENO) == 1; }

int barWidth() { return static_cast<int>(terminalWidth(STDERR_FILENO).value_or(80)); }

std::string jsonLine(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string figures(const job::Progress& p, std::string_view separator) {
  std::string text = fmt::format("{}", static_cast<std::uint64_t>(p.samples));
  if (p.sampleLimit) text += fmt::format("/{}", *p.sampleLimit);
  text += " " + nounFor(p.sampleLimit ? *p.sampleLimit : static_cast<std::uint64_t>(p.samples),
                        p.countsFrames ? "frame" : "sample");
  if (p.raysPerSecond > 0) text += fmt::format("{}{:.3g} Mrays/s", separator, p.raysPerSecond * 1e-6);
  if (p.error && std::isfinite(*p.error)) text += fmt::format("{}error {:.2g} %", separator, 100.0 * *p.error);
  text += fmt::format("{}{}", separator, durationText(p.seconds));
  if (const double left = p.secondsLeft(); std::isfinite(left))
    text += fmt::format("{}{} left", separator, durationText(left));
  return text;
}

}  // namespace

void printFailureJson(const std::string& text) {
  try {
    writeFile("-", text);
  } catch (const FileError&) {  // standard output is closed
  }
}

void printMessage(const std::string& text) {
  const std::optional<std::size_t> width = terminalWidth(STDERR_FILENO);
  printError((width ? wrapped(text, *width, 2) : text) + "\n");
}

bool parseColor(const std::string& name) {
  const std::size_t choice = parseChoice("--color", name, {"auto", "always", "never"});
  return choice == 0 ? colorOnStandardError() : choice == 1;
}

std::string progressBar(const job::Progress& progress, int width, bool color) {
  const std::string text = figures(progress, "  ");
  const int room = width - static_cast<int>(text.size()) - 4;
  if (room < 8) return text.substr(0, static_cast<std::size_t>(std::max(width - 1, 0)));
  const int length = std::min(room, 40);
  const int done = static_cast<int>(std::floor(progress.fraction() * length));
  std::string filled(static_cast<std::size_t>(done), '=');
  if (done < length) filled += '>';
  const std::string rest(static_cast<std::size_t>(std::max(length - done - 1, 0)), ' ');
  return color ? fmt::format("[\x1b[32m{}\x1b[0m{}] {}", filled, rest, text)
               : fmt::format("[{}{}] {}", filled, rest, text);
}

std::string progressLine(const job::Progress& progress) { return figures(progress, ", "); }

void printDiagnostics(const std::vector<Diagnostic>& diagnostics, const program::Program* program, bool json) {
  if (json) return writeFile("-", check::diagnosticsJson(diagnostics));
  printError(check::diagnosticsText(diagnostics, program ? check::sourcesOf(*program) : check::sourcesOnDisk(),
                                    {.color = colorOnStandardError(), .width = terminalWidth(STDERR_FILENO)}));
}

void exitAfterHang(const program::Program* program, const Diagnostic& diagnostic) {
  printError(fmt::format("quintet: {}{}; use --timeout to allow more time\n",
                         program ? printable(program->name) + ": " : "", diagnostic.text));
  std::fflush(nullptr);
  ::_exit(kRuntimeError);
}

Console::Console(const ConsoleOptions& options)
    : options_(options), terminal_(isTerminal()), color_(colorOnStandardError()) {}

void Console::show(const std::string& line) {
  printError(kClearLine + line);
  barVisible_ = true;
}

void Console::clear() {
  const std::lock_guard lock(mutex_);
  clearLocked();
}

void Console::clearLocked() {
  if (barVisible_) printError(kClearLine);
  barVisible_ = false;
}

void Console::setProgram(const program::Program* program) {
  program_ = program;
  setWorkProgram(program ? program->name : "");
}

void Console::stage(const std::string& text) {
  setWorkStage(text);
  const std::lock_guard lock(mutex_);
  if (!options_.quiet && !options_.jsonProgress && terminal_) show(text + " ...");
}

void Console::note(const std::string& text) {
  if (options_.quiet || options_.jsonProgress) return;
  const std::lock_guard lock(mutex_);
  clearLocked();
  printMessage(text);
}

void Console::warning(const std::string& text) {
  const std::lock_guard lock(mutex_);
  warnings_.push_back(text);
  clearLocked();
  if (options_.jsonProgress)
    printError(jsonLine({{"warning", text}}));
  else
    printMessage("quintet: warning: " + printable(text));
}

void Console::clearReport() {
  const std::lock_guard lock(mutex_);
  warnings_.clear();
  prints_ = {};
}

std::vector<std::string> Console::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

void Console::diagnostics(const std::vector<Diagnostic>& found) {
  clear();
  const bool failed = hasErrors(found);
  printDiagnostics(found, program_, failed && options_.json);
  if (failed)
    printError(fmt::format("quintet: {}{}\n", program_ ? printable(program_->name) + ": " : "", countText(found)));
}

void Console::printed(const job::Printed& prints) {
  const std::lock_guard lock(mutex_);
  prints_.omitted += prints.omitted;
  prints_.notStored += prints.notStored;
  prints_.lines.insert(prints_.lines.end(), prints.lines.begin(), prints.lines.end());
  if (options_.json && !options_.jsonProgress) return;  // at the end
  clearLocked();
  std::string text;
  for (const job::PrintedLine& line : prints.lines)
    text += options_.jsonProgress ? output::printedJson(line) : output::printedText(line) + "\n";
  printError(text);
}

void Console::printsDisabled() { note("the program prints (debugPrintfEXT); --print shows it"); }

std::optional<job::Printed> Console::takePrints() {
  if (!options_.collectPrints) return std::nullopt;
  if (const std::uint64_t beyond = prints_.omitted - prints_.notStored; beyond > 0)
    note(fmt::format("{} {} omitted; --print-limit allows more, and --print=X,Y selects a pixel",
                     counted(beyond, "printed line"), nounFor(beyond, "was", "were")));
  if (const std::uint64_t lost = prints_.notStored; lost > 0)
    note(fmt::format("{} did not fit into the log on the device; --print=X,Y selects a pixel",
                     counted(lost, "printed line")));
  return std::exchange(prints_, {});
}

void Console::progress(const job::Progress& state) {
  setWorkStage("rendering");
  const double now = clock_.seconds();
  if (options_.quiet || options_.jsonProgress || now - lastProgress_ < (terminal_ ? kBarSeconds : kLineSeconds)) return;
  lastProgress_ = now;
  const std::lock_guard lock(mutex_);
  if (terminal_) {
    show(progressBar(state, barWidth(), color_));
  } else {
    printError(progressLine(state) + "\n");
  }
}

void Console::batch(const job::BatchReport& report) {
  if (!options_.jsonProgress) return;
  Json line{{"samples", report.samples}, {"seconds", report.seconds}};
  if (report.checkpointSamples) line["checkpoint"] = *report.checkpointSamples;
  printError(jsonLine(line));
}

job::StopRequest Console::stopRequested() {
  if (isObsolete && isObsolete()) return job::StopRequest::abandon;
  if (!stop_ || !stop_->requested()) return job::StopRequest::none;
  if (!std::exchange(stopNoted_, true)) note("interrupted: " + options_.stopNote);
  return job::StopRequest::finish;
}

void Console::write(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (file == "-") return writeFile(file, bytes);  // no temporary file to protect
  const ProtectedWrite protect;
  setWorkFile(file);
  writeFile(file, bytes);
  setWorkFile({});
}

void Console::deviceHung(const Diagnostic& diagnostic) {
  clear();
  if (options_.json) printFailureJson(check::diagnosticsJson({diagnostic}));
  exitAfterHang(program_, diagnostic);
}

void Console::frame(const job::RenderResult& result) {
  if (onFrame) onFrame(result);
}

void Console::preview(const job::RenderResult& result) {
  if (onPreview) onPreview(result);
}

}  // namespace quintet::cli
