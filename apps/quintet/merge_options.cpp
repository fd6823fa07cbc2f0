#include "merge_options.h"

#include "base/error.h"
#include "option_groups.h"
#include "output.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet merge a.qfilm b.qfilm -o scene.png                any order; the bytes of one rendering\n"
    "  quintet merge part*.qfilm -o scene.exr\n"
    "  quintet merge a.qfilm b.qfilm -o ab.qfilm                 what is missing may come later\n"
    "  quintet merge out.checkpoint.qfilm --partial -o look.png  a look at a rendering that goes on\n";

}  // namespace

std::optional<MergeOptions> parseMergeOptions(Arguments arguments) {
  CLI::App app("Joins parts of a rendering, made by 'render --batches' on any number of machines.", "quintet merge");
  MergeOptions options;
  RenderOptions& render = options.render;
  RawOptions raw;
  app.add_option("PART", options.parts, "Films (.qfilm): parts, or checkpoints")->type_name("");
  app.add_option("-o,--output", raw.output, ".png, .exr, .hdr or .qfilm; - is PNG on standard output")
      ->type_name("FILE");
  app.add_option("--exposure", raw.exposure, "Multiply by 2^STOPS (PNG; kept by a film; default: as rendered)")
      ->type_name("STOPS");
  app.add_option("--tonemap", raw.toneMap, "linear, aces, agx or neutral (PNG; kept by a film; default: as rendered)")
      ->type_name("NAME");
  app.add_flag("--all-outputs", render.allOutputs, "Write every output of the films: out.NAME.png (kept by a film)");
  app.add_flag("--partial", options.partial, "Make the picture even if samples are missing");
  app.add_flag("--force", render.farm.force, "Overwrite a film that would be lost");
  app.add_flag("--json", render.json, "At the end, one JSON object on standard output");
  app.add_flag("-q,--quiet", render.quiet, "No notes on standard error");
  declareExr(app, raw, AovNames::ofFilms);
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  if (options.parts.empty()) throw UsageError("no parts given; see 'quintet merge --help'");
  if (raw.output.empty()) throw UsageError("no output given (-o FILE); see 'quintet merge --help'");
  render.output = raw.output;
  render.commandLine = commandLine("merge", arguments);
  options.exposureGiven = !raw.exposure.empty();
  interpret(raw, render);
  checkStandardOutput(render.output, render.json, render.allOutputs);
  checkExrOptions(raw, render);
  if (!render.aovs.empty() && outputKind(render.output) == OutputKind::film)
    throw UsageError("--aov is for OpenEXR files: a film keeps all layers that its parts have");
  if (asksForAovList(raw)) throw UsageError("--aov list: 'quintet render --aov list' names a program's layers");
  checkOutput(render.output);
  return options;
}

}  // namespace quintet::app
