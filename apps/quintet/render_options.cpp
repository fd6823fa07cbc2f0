#include "render_options.h"

#include "base/error.h"
#include "option_groups.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet render scene.glb                                scene.png\n"
    "  quintet render scene.glb -o out.exr --size 1920x1080 --spp 256\n"
    "  quintet render scene.glb -o out.exr --aov albedo,normal  layers besides the picture; --aov list names them\n"
    "  quintet render scene.glb --time 60 --env sky.hdr        as many samples as a minute allows\n"
    "  quintet render scene.glb --look-from 2,1,3 --look-at 0,0.5,0 --fov 35\n"
    "  quintet render scene.glb --program ao --set distance=0.5  another program with a parameter\n"
    "  quintet render --program pathtracer --help-program      what parameters it has\n"
    "  quintet render scene.glb -o - --quiet | display         PNG on standard output\n"
    "  quintet render scene.glb --spp 4096 --checkpoint 60 --resume  go on where it was killed\n"
    "  quintet render scene.glb --spp 64 --batches 0-7 -o a.qfilm    half of it; batches 8-15 elsewhere, then\n"
    "  quintet merge a.qfilm b.qfilm -o scene.png                    the same bytes as all at once\n";

}  // namespace

std::optional<RenderOptions> parseRenderOptions(Arguments arguments) {
  CLI::App app("Renders a scene with the path tracer, or with another program.", "quintet render");
  RenderOptions options;
  RawOptions raw;
  app.add_option("SCENE", raw.scene, "The scene: .gltf, .glb or .scene.toml")->type_name("");
  app.add_option("-o,--output", raw.output,
                 ".png, .exr, .hdr or .qfilm (all of the film, for 'quintet merge'); - is PNG on\nstandard output "
                 "(default: SCENE.png, here)")
      ->type_name("FILE")
      ->group("Image");
  declareImage(app, raw, options);
  declareExr(app, raw);
  declareQuality(app, raw, options);
  declareView(app, raw, options);
  app.add_option("--program", options.program, "Built-in program, or folder of one (default: pathtracer)")
      ->type_name("NAME")
      ->group("Program");
  declareProgram(app, raw, options);
  app.add_flag("--help-program", options.programHelp, "Print the program's parameters and leave")->group("Program");
  declareProcess(app, raw, options, "A launch that takes longer hangs (default: 60; on a CPU 600)");
  app.add_flag("--json", options.json, "At the end, one JSON object on standard output")->group("Run");
  declareFarm(app, options.farm);
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  options.commandLine = commandLine("render", arguments);
  options.aovList = asksForAovList(raw);
  if (options.programHelp || options.aovList) return options;
  if (raw.scene.empty()) throw UsageError("no scene given; see 'quintet render --help'");
  options.scene = raw.scene;
  options.output = app.count("--output") > 0 ? std::filesystem::path(raw.output)
                                             : options.scene.filename().replace_extension(".png");
  checkStandardOutput(options.output, options.json, options.allOutputs);
  interpret(raw, options);
  checkExrOptions(raw, options);
  interpretFarm(options);
  if (options.samples) options.drawnFrames = static_cast<std::uint32_t>(*options.samples);
  return options;
}

}  // namespace quintet::app
