// `quintet run`: a program of the user's or a built-in one, on a scene or on the built-in one.
#include <fmt/format.h>

#include "base/file.h"
#include "commands.h"
#include "program_report.h"
#include "run_options.h"
#include "session.h"

namespace quintet::app {
namespace {

int showProgram(const RenderOptions& options) {
  const program::Program program = program::loadProgram(options.program);
  writeFile("-", options.json ? programJson(program) : programHelp(program));
  return 0;
}

// Here, and called like the program: "ao.png", "sphere.png" for lessons/sphere.rt.glsl.
std::filesystem::path defaultOutput(const std::string& name) {
  std::string stem = std::filesystem::path(name).filename().string();
  stem = stem.substr(0, stem.find('.'));
  return (stem.empty() ? "out" : stem) + ".png";
}

int render(RenderOptions& options) {
  if (options.output.empty()) options.output = defaultOutput(program::loadProgram(options.program).name);
  Session session(options);
  session.prepare();
  session.openDevice();
  session.loadScene();
  session.link();
  const GracefulStop stop;
  const RenderOutcome outcome =
      renderBatches(session.renderer(), {options.samples, options.seconds}, stop, session.progress());
  session.write(outcome);
  session.report();
  return stop.exitStatus();
}

}  // namespace

int runCommand(Arguments arguments) {
  std::optional<RunOptions> options = parseRunOptions(arguments);
  if (!options) return 0;
  if (options->list) {
    writeFile("-", programList(options->render.json));
    return 0;
  }
  if (options->render.programHelp) return showProgram(options->render);
  return render(options->render);
}

}  // namespace quintet::app
