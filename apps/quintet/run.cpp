// `quintet run`: a program of the user's or a built-in one, on a scene or on the built-in one.
#include <fmt/format.h>

#include "aov.h"
#include "base/file.h"
#include "commands.h"
#include "diagnostics_view.h"
#include "hang.h"
#include "program_report.h"
#include "run_options.h"
#include "run_pictures.h"
#include "run_watch.h"
#include "session.h"

namespace quintet::app {
namespace {

// Here, and called like the program: "ao.png", "sphere.png" for lessons/sphere.rt.glsl.
std::filesystem::path defaultOutput(const std::string& name) {
  std::string stem = std::filesystem::path(name).filename().string();
  stem = stem.substr(0, stem.find('.'));
  return (stem.empty() ? "out" : stem) + ".png";
}

int draw(Session& session, const RunOptions& options) {
  session.prepare();
  session.openDevice();
  session.loadScene();
  session.link();
  const GracefulStop stop;
  PictureEnd end{};
  withoutHanging(session.program(), options.render.json, [&] { end = drawPictures(session, options, stop); });
  session.report();
  return end == PictureEnd::interrupted ? stop.exitStatus() : 0;
}

int runProgram(RunOptions& all) {
  RenderOptions& options = all.render;
  try {
    if (options.output.empty()) options.output = defaultOutput(program::loadProgram(options.program).name);
    Session session(options);
    try {
      return all.watch ? watchProgram(session, all) : draw(session, all);
    } catch (const render::ProgramError& error) {
      session.tell(error.diagnostics());
      return 1;
    }
  } catch (const FileError& error) {
    // An editor reads the place; main says it in words.
    if (options.json) writeFile("-", diagnosticsJson({asDiagnostic(error)}));
    throw;
  }
}

}  // namespace

int runCommand(Arguments arguments) {
  std::optional<RunOptions> options = parseRunOptions(arguments);
  if (!options) return 0;
  RenderOptions& render = options->render;
  if (options->list) {
    writeFile("-", programList(render.json));
    return 0;
  }
  if (render.programHelp) {
    const program::Program program = program::loadProgram(render.program);
    writeFile("-", render.json ? programJson(program) : programHelp(program));
    return 0;
  }
  if (render.aovList) {
    writeFile("-", aovList(program::loadProgram(render.program)));
    return 0;
  }
  return runProgram(*options);
}

}  // namespace quintet::app
