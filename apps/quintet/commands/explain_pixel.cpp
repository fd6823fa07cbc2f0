// SPDX-License-Identifier: Apache-2.0
// `quintet explain-pixel`: the rays of one sample of a pixel, and what they contribute; or where two samples separate.
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli/candidates.h"
#include "cli/exit_status.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "gpu/present/line_renderer.h"
#include "io/codec.h"
#include "job/depth_map.h"
#include "job/explanation_json.h"
#include "job/pixel_explainer.h"
#include "output/explanation_text.h"
#include "output/write.h"
#include "overlay/ray_image.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

constexpr double kMaxPixel = 65535;
constexpr std::size_t kMinWidth = 60, kMaxWidth = 100;  // columns

struct ExplainPixelOptions : RenderOptions {
  uvec2 pixel{0};
  std::uint32_t sample = 0;
  bool payloads = false;
  std::filesystem::path against;  // an explanation to compare with; may be empty
  std::filesystem::path image;    // that shows the rays; may be empty
  job::DiffTolerance tolerance;
};

struct ExplainPixelTexts : RenderTexts {
  std::string pixel, sample, tolerance;
};

OptionTable declareExplainPixel(ExplainPixelOptions& options, ExplainPixelTexts& texts) {
  OptionTable table(
      "explain-pixel",
      "Explains one sample of a pixel: prints its rays, what they hit and what they contribute. The other "
      "options are those of the render.");
  table.add({{.names = "SCENE",
              .help = "Scene file: .gltf, .glb or .scene.toml (default: the program's own)",
              .target = &texts.scene,
              .candidates = {.extensions = kSceneExtensions}}});
  table.add(
      "Sample",
      {{.names = "--pixel",
        .value = "X,Y",
        .help = "Pixel of the image, from the top left corner; the first one is 0,0",
        .target = &texts.pixel},
       {.names = "--sample",
        .value = "N",
        .help = "Number of the sample, or of the frame of a program that accumulates; the first one is 0 (default: 0)",
        .target = &texts.sample}});
  table.add(
      "Result",
      {{.names = "--json", .help = "Print one JSON object on standard output", .target = &options.console.json},
       {.names = "--image",
        .value = "FILE.png",
        .help = "Also render the whole image, and write it with the rays drawn over it",
        .target = &options.image,
        .candidates = {.extensions = {"png"}}},
       {.names = "--payloads",
        .help = "Print payloads and details of hits also for programs that state their contributions",
        .target = &options.payloads},
       {.names = "--against",
        .value = "FILE.json",
        .help =
            "Print only the first difference from an explanation that --json wrote; the status is 1 if there is one",
        .target = &options.against,
        .candidates = {.extensions = {"json"}}},
       {.names = "--tolerance",
        .value = "X",
        .help = "Relative difference of numbers that counts as rounding in --against (default: 1e-4)",
        .target = &texts.tolerance}});
  declareSize(table, texts, options);
  declareFrame(table, texts, "Explain");
  declareQuality(table, texts, options);
  declareView(table, texts, options);
  declareAnimation(table, texts, options);
  declareProgramName(table, options);
  declareParameters(table, options);
  declareDevice(table, texts, options);
  table.add("Run", {{.names = "-q,--quiet", .help = "Print no notes", .target = &options.console.quiet}});
  table.addExamples({
      {"quintet explain-pixel scene.glb --pixel 640,360", "sample 0 of the pixel, as the path tracer renders it"},
      {"quintet explain-pixel scene.glb --pixel 640,360 --sample 17 --spp 256", "sample 17 of a render with --spp 256"},
      {"quintet explain-pixel scene.glb --pixel 640,360 --image rays.png", "the rays over the image"},
      {"quintet explain-pixel --program my_program/ --pixel 12,40", "each trace with its payload"},
      {"quintet explain-pixel scene.glb --pixel 640,360 --json > a.json", "for scripts, and for --against"},
      {"quintet explain-pixel scene.glb --pixel 640,360 --bounces 2 --against a.json", "where the two separate"},
  });
  return table;
}

uvec2 parsePixel(const std::string& text) {
  const std::size_t comma = text.find(',');
  const auto x = parseInteger("--pixel", text.substr(0, comma), 0, kMaxPixel);
  const auto y = comma == text.npos ? std::nullopt : parseInteger("--pixel", text.substr(comma + 1), 0, kMaxPixel);
  if (!x || !y) throw UsageError(fmt::format("--pixel: '{}' must be X,Y, for example 640,360", text));
  return {static_cast<std::uint32_t>(*x), static_cast<std::uint32_t>(*y)};
}

void convertSample(const ExplainPixelTexts& texts, ExplainPixelOptions& options) {
  if (texts.pixel.empty()) throw UsageError("no pixel given; use --pixel X,Y");
  options.pixel = parsePixel(texts.pixel);
  options.sample = static_cast<std::uint32_t>(parseInteger("--sample", texts.sample, 0, job::kMaxSample).value_or(0));
  const job::RenderLimits& limits = options.request.limits;
  if (limits.samples && !limits.adaptive && options.sample >= *limits.samples)
    throw UsageError(fmt::format("--sample {}: a render with --spp {} has the samples 0 to {}", options.sample,
                                 *limits.samples, *limits.samples - 1));
  if (const auto tolerance = parseReal("--tolerance", texts.tolerance, 0.0, 1.0)) {
    if (options.against.empty()) throw UsageError("--tolerance requires --against");
    options.tolerance.relative = static_cast<float>(*tolerance);
  }
  convertFrames(texts, options);
}

std::optional<ExplainPixelOptions> parseExplainPixel(Arguments arguments) {
  ExplainPixelOptions options;
  ExplainPixelTexts texts;
  if (!parse(declareExplainPixel(options, texts), arguments)) return std::nullopt;
  options.request.scene = texts.scene;
  options.request.commandLine = commandLine("explain-pixel", arguments);
  options.output.file = "image.png";  // of the render that is explained; written with the rays on request
  if (!options.image.empty()) {
    options.output.file = options.image;
    if (output::fileKind(options.image) != output::FileKind::png)
      throw UsageError(fmt::format("--image: '{}' must be a PNG file", options.image.string()));
    if (output::isStandardOutput(options.image))
      throw UsageError("--image requires a file: the explanation is printed on standard output");
  }
  convert(texts, options);
  if (options.request.limits.samples)
    options.request.frames.accumulated = static_cast<std::uint32_t>(*options.request.limits.samples);
  convertSample(texts, options);
  return options;
}

std::size_t textWidth() { return std::clamp(terminalWidth(STDOUT_FILENO).value_or(kMaxWidth), kMinWidth, kMaxWidth); }

job::PixelExplanation explain(job::Engine& engine, std::shared_ptr<job::PreparedScene>& scene,
                              const program::Program& program, const ExplainPixelOptions& options, Console& console) {
  const job::RenderRequest request = job::requestForPixel(options.request, program, options.pixel);
  job::RenderJob job(engine, job::resolve(request, program), console, scene);
  setWorkStage("explaining a pixel");
  job::PixelExplainer explainer(engine, job);
  return explainer.explain(options.pixel, options.sample, console);
}

// Checks what can be checked before the work starts.
output::OutputPlan planImage(job::Engine& engine, const program::Program& program, const ExplainPixelOptions& options) {
  gpu::requireGraphicsQueue(engine.context());
  return output::planOutputs(options.output, program, options.request.frames);
}

// The image of the explained render. Of a program that accumulates, up to the explained frame.
job::RenderResult renderImage(job::RenderJob& job, const job::PixelExplanation& explanation,
                              const ExplainPixelOptions& options, Console& console) {
  if (!explanation.frames) return job.run(options.request.limits, console);
  const std::uint64_t frames = std::uint64_t{explanation.sample} + 1;
  while (job.sampleCount() < static_cast<double>(frames) && job.renderBatch(frames, console)) {
  }
  return job.result();
}

// Renders the image of the explained render, and writes it with the rays.
void writeImage(job::Engine& engine, std::shared_ptr<job::PreparedScene>& scene, const program::Program& program,
                const output::OutputPlan& plan, const job::PixelExplanation& explanation,
                const ExplainPixelOptions& options, Console& console) {
  job::RenderJob job(engine, job::resolve(options.request, program), console, scene);
  overlay::requireSceneCamera(explanation, job.camera());
  setWorkStage("rendering");
  const job::RenderResult result = renderImage(job, explanation, options, console);
  const job::DepthMap depth = job::renderDepthMap(engine, job);
  const io::Image image = overlay::drawRays(engine.context(), explanation, depth,
                                            output::displayImage(plan, *result.film), job::EngineOptions().caches);
  console.clear();
  console.write(options.image, io::encodePng(image, job::metadataOf(result.provenance)));
}

// `other`: of ExplainPixelOptions::against. Returns the exit status.
int print(const job::PixelExplanation& explanation, const std::optional<job::PixelExplanation>& other,
          const ExplainPixelOptions& options) {
  const bool json = options.console.json;
  if (!other) {
    writeFile("-", json ? job::explanationJson(explanation, options.request.commandLine)
                        : output::explanationText(explanation, textWidth(), options.payloads));
    return 0;
  }
  const job::ExplanationDiff diff = job::diffExplanations(explanation, *other, options.tolerance);
  const std::string file = options.against.string();
  writeFile("-", json ? output::explanationDiffJson(diff, options.request.commandLine, file)
                      : output::explanationDiffText(diff, options.request.commandLine, file, textWidth()));
  return diff.equal() ? 0 : kRuntimeError;
}

}  // namespace

OptionTable explainPixelOptions() {
  ExplainPixelOptions options;
  ExplainPixelTexts texts;
  return declareExplainPixel(options, texts).withoutTargets();
}

int explainPixelCommand(Arguments arguments) {
  const std::optional<ExplainPixelOptions> options = parseExplainPixel(arguments);
  if (!options) return 0;
  std::optional<job::PixelExplanation> other;
  if (!options->against.empty()) other = job::readExplanation(options->against);  // fails before the work starts
  const program::Program program = program::loadProgram(options->program);
  Console console(options->console);
  console.setProgram(&program);
  try {
    job::Engine engine({.device = options->device, .log = [&](LogLevel level, const std::string& text) {
                          if (level == LogLevel::warning) console.warning(text);
                        }});
    std::optional<output::OutputPlan> plan;
    if (!options->image.empty()) plan = planImage(engine, program, *options);
    std::shared_ptr<job::PreparedScene> scene;
    const job::PixelExplanation explanation = explain(engine, scene, program, *options, console);
    console.clear();
    const int status = print(explanation, other, *options);  // first, because the image can fail
    if (!plan) return status;
    try {
      writeImage(engine, scene, program, *plan, explanation, *options, console);
    } catch (const Error& error) {
      if (!options->console.json) throw;
      console.clear();
      return reportFailure(error, FailureJson::none);  // standard output has one object already
    }
    return status;
  } catch (const ProgramError& error) {
    console.diagnostics(error.diagnostics());
    return kRuntimeError;
  }
}

}  // namespace quintet::cli
