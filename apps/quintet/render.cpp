// `quintet render`: options, device, scene, program, batches, picture, report.
#include "aov.h"
#include "base/error.h"
#include "base/file.h"
#include "checkpoint.h"
#include "commands.h"
#include "hang.h"
#include "program_report.h"
#include "session.h"

namespace quintet::app {
namespace {

int render(Session& session, const RenderOptions& options) {
  session.prepare();
  session.openDevice();
  session.loadScene();
  session.link();
  const GracefulStop stop;
  Checkpoint checkpoint(session, options);
  const RenderLimits limits = checkpoint.begin();
  RenderHooks hooks;
  hooks.states = !options.quiet && session.program().accumulation == program::Accumulation::film;
  hooks.afterBatch = [&](const RenderOutcome& outcome) { checkpoint.afterBatch(outcome); };
  RenderOutcome outcome;
  withoutHanging(session.program(), options.json,
                 [&] { outcome = renderBatches(session.renderer(), limits, stop, session.progress(), hooks); });
  checkpoint.afterRendering(outcome);
  try {
    session.write(outcome);
  } catch (...) {
    checkpoint.keep(outcome);
    throw;
  }
  checkpoint.afterPicture(outcome);
  session.report();
  return outcome.interrupted ? stop.exitStatus() : 0;
}

}  // namespace

int renderCommand(Arguments arguments) {
  const std::optional<RenderOptions> options = parseRenderOptions(arguments);
  if (!options) return 0;
  if (options->programHelp) {
    writeFile("-", programHelp(program::loadProgram(options->program)));
    return 0;
  }
  if (options->aovList) {
    writeFile("-", aovList(program::loadProgram(options->program)));
    return 0;
  }
  Session session(*options);
  try {
    return render(session, *options);
  } catch (const render::ProgramError& error) {
    session.tell(error.diagnostics());
    return 1;
  }
}

}  // namespace quintet::app
