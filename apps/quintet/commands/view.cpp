// SPDX-License-Identifier: Apache-2.0
// `quintet view`: starts the window, which is the program quintet-view. With --script: an interactive session without a
// window, which reads commands as lines of JSON and prints events as lines of JSON.
#include <algorithm>
#include <iostream>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "cli/companion.h"
#include "cli/failure.h"
#include "cli/view_options.h"
#include "gpu/error.h"
#include "gpu/present/line_renderer.h"
#include "io/codec.h"
#include "job/explanation_json.h"
#include "job/interactive/command_json.h"
#include "job/interactive/event_json.h"
#include "job/interactive/session.h"
#include "output/write.h"
#include "overlay/ray_image.h"

namespace quintet::cli {
namespace {

using job::interactive::Session;

void printLine(const std::string& json) { writeFile("-", json + "\n"); }

class Script {
 public:
  Script(job::Engine& engine, Session& session, Console& console)
      : engine_(engine), session_(session), console_(console) {}

  // Returns false if the line ends the script.
  bool execute(const std::string& line) {
    const nlohmann::json message = job::interactive::scriptSchema().readCommand(line);
    const auto name = message.at("do").get<std::string>();
    if (name == "refine") {
      const std::uint32_t samples = message.value("samples", session_.state().samples);
      if (samples != session_.state().samples) session_.apply(job::interactive::SetSamples{samples});
      report(session_.refine());
    } else if (name == "step") {
      report(session_.step(message.at("seconds").get<double>()));
    } else if (name == "pick") {
      const uvec2 pixel = job::interactive::parsePixel(message);
      const std::optional<job::interactive::Pick> picked = session_.pick(pixel);
      printLine(job::interactive::pickedJson(pixel, picked, session_.instanceNames(), session_.materialNames()));
    } else if (name == "explain") {
      const uvec2 pixel = job::interactive::parsePixel(message);
      const auto sample = message.at("sample").get<std::uint32_t>();
      const auto file = message.at("file").get<std::string>();
      explained_.reset();
      explained_ = Explained{session_.explain(pixel, sample), session_.camera(), session_.state().program};
      if (!file.empty()) writeFile(file, job::explanationJson(explained_->explanation));
      printLine(job::interactive::explainedJson(explained_->explanation, file));
    } else if (name == "save") {
      save(message.at("file").get<std::string>(), message.at("rays").get<bool>());
    } else if (name == "quit") {
      return false;
    } else {
      session_.apply(job::interactive::parseCommand(message));
    }
    return true;
  }

 private:
  // The last explained pixel.
  struct Explained {
    job::PixelExplanation explanation;
    scene::Camera camera;
    std::string program;  // SessionState::program
  };

  void report(const std::vector<job::interactive::Event>& events) {
    const job::interactive::Failed* failed = nullptr;
    for (const job::interactive::Event& event : events) {
      const auto* failure = std::get_if<job::interactive::Failed>(&event);
      if (failure)
        failed = failure;  // becomes the error of the line
      else
        printLine(job::interactive::eventJson(event));
      if (std::holds_alternative<job::interactive::ProgramReloaded>(event)) explained_.reset();
    }
    if (failed) throw Error(failed->message);
  }

  void requireRays(const std::string& file) {
    if (!explained_) throw UsageError("no pixel has been explained since the program was loaded; use 'explain' first");
    if (explained_->program != session_.state().program)
      throw UsageError("the program has changed since the pixel was explained; use 'explain' again");
    if (output::fileKind(file) != output::FileKind::png)
      throw UsageError(fmt::format("{}: an image with rays must be a PNG file", file));
    overlay::requireSceneCamera(explained_->explanation, explained_->camera);
    gpu::requireGraphicsQueue(engine_.context());
  }

  void writeRays(const output::OutputPlan& plan, const std::string& file) {
    const job::RenderResult result = session_.result();
    const io::Image image = overlay::drawRays(engine_.context(), explained_->explanation, session_.depthMap(),
                                              output::displayImage(plan, *result.film), job::EngineOptions().caches);
    console_.write(file, io::encodePng(image, job::metadataOf(result.provenance)));
  }

  void save(const std::string& file, bool rays) {
    const job::interactive::SessionState& state = session_.state();
    output::OutputRequest request;
    request.file = file;
    request.output = state.output;
    request.exposure = state.exposure;
    request.toneMap = state.toneMap;
    if (output::isStandardOutput(file)) throw UsageError("standard output has the events; save to a file");
    if (output::fileKind(file) == output::FileKind::film)
      throw UsageError(fmt::format("{}: a session writes images; use 'quintet render' for films", file));
    // Reports mistakes before the render.
    static_cast<void>(output::planOutputs(request, session_.program()));
    if (rays) requireRays(file);
    report(session_.refine());
    // The program can have been loaded again.
    const output::OutputPlan plan = output::planOutputs(request, session_.program());
    if (rays) requireRays(file);
    if (rays)
      writeRays(plan, file);
    else
      output::writeOutputs(plan, session_.result(), console_);
    printLine(job::interactive::savedJson(file));
  }

  job::Engine& engine_;
  Session& session_;
  Console& console_;
  std::optional<Explained> explained_;
};

// Returns the exit status.
int runScript(const ViewOptions& options, std::istream& lines, const std::string& name) {
  Console console({.quiet = true});
  job::Engine engine({.device = options.device, .log = [&](LogLevel level, const std::string& text) {
                        if (level == LogLevel::warning) console.warning(text);
                      }});
  const Stopwatch clock;
  Session session(
      engine, {options.program, options.request}, [&] { return clock.seconds(); }, console);
  Script script(engine, session, console);
  int status = 0;
  std::string line;
  for (std::uint64_t number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto fail = [&](const Error& error) {
      const std::string where = fmt::format("line {}", number);
      printLine(job::interactive::failedJson(number, error.what()));
      status = printFailure(FileError(name, where, error.what()).what(), kRuntimeError);
    };
    try {
      if (!script.execute(line)) break;
    } catch (const ProgramError& error) {
      printLine(job::interactive::eventJson(job::interactive::DiagnosticsFound{error.diagnostics()}));
      fail(error);
    } catch (const TimeoutError&) {
      throw;  // no later line can succeed
    } catch (const DeviceLostError& error) {
      session.recoverFrom(error);
      fail(error);
    } catch (const Error& error) {
      fail(error);
    }
    if (status != 0 && !options.keepGoing) break;
  }
  return status;
}

}  // namespace

OptionTable viewOptions() {
  ViewOptions options;
  RenderTexts texts;
  return viewOptionTable(options, texts).withoutTargets();
}

// Only a session without a window is parsed here.
bool hasScript(Arguments arguments) {
  return std::ranges::any_of(arguments, [](const std::string& argument) {
    return argument == "--script" || argument.starts_with("--script=") || argument == "--help" || argument == "-h";
  });
}

[[noreturn]] void openWindow(Arguments arguments) {
  const std::filesystem::path viewer = findCompanion("quintet-view");
  if (viewer.empty())
    throw Error(
        "quintet-view, the program with the window, not found beside quintet or in PATH; build it with "
        "-DQUINTET_VIEWER=ON, or use --script FILE for a session without a window (docs/viewer.md)");
  startCompanion(viewer, arguments);
}

int viewCommand(Arguments arguments) {
  if (!hasScript(arguments)) openWindow(arguments);
  const std::optional<ViewOptions> options = parseViewOptions(arguments);
  if (!options) return 0;
  if (options->script == "-") return runScript(*options, std::cin, "standard input");
  std::istringstream lines(readTextFile(options->script));
  return runScript(*options, lines, options->script);
}

}  // namespace quintet::cli
