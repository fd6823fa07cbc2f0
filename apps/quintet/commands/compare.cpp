// SPDX-License-Identifier: Apache-2.0
// `quintet compare`: the difference between two images, or the statistical test of two films.
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/signals.h"
#include "cli/values.h"
#include "io/codec.h"
#include "io/compare.h"
#include "io/exr/exr.h"
#include "io/side_by_side.h"
#include "job/film_comparison.h"
#include "output/comparison_report.h"
#include "output/plan.h"

namespace quintet::cli {
namespace {

struct CompareOptions {
  std::string a, b, output, sideBySide, metric = "mae8", max, gammaB, maxMemory;
  std::string level, block, tolerance;
  std::vector<std::string> mayDiffer;
  bool zTest = false;
  std::optional<std::string> layer;
  bool resize = false;
  bool json = false;
};

// Rejects options that have no effect.
void checkApplicable(const CompareOptions& options) {
  const auto reject = [](const char* name, bool given, const char* problem) {
    if (given) throw UsageError(fmt::format("{}: {}", name, problem));
  };
  constexpr const char* kFilms = "requires --z-test";
  constexpr const char* kImages = "applies to images, not to --z-test";
  reject("--level", !options.zTest && !options.level.empty(), kFilms);
  reject("--block", !options.zTest && !options.block.empty(), kFilms);
  reject("--tolerance", !options.zTest && !options.tolerance.empty(), kFilms);
  reject("--may-differ", !options.zTest && !options.mayDiffer.empty(), kFilms);
  reject("--max", options.zTest && !options.max.empty(), kImages);
  reject("--metric", options.zTest && options.metric != CompareOptions().metric, kImages);
  reject("--side-by-side", options.zTest && !options.sideBySide.empty(), kImages);
  reject("--gamma-b", options.zTest && !options.gammaB.empty(), kImages);
  reject("--layer", options.zTest && options.layer.has_value(), kImages);
  reject("--resize", options.zTest && options.resize, kImages);
}

OptionTable declareCompare(CompareOptions& options) {
  OptionTable table("compare", "Measures the difference between image A and image B, the reference.");
  const Candidates images{.extensions = {"png", "exr", "hdr", "jpg", "jpeg", "webp", "qfilm"}};
  std::vector<std::string> measures;
  for (const output::Measure& measure : output::measures({})) measures.push_back(measure.name);
  table.add({{.names = "A",
              .help = "The image: PNG, JPEG, WebP, KTX2, Radiance HDR or OpenEXR",
              .target = &options.a,
              .candidates = images,
              .required = true},
             {.names = "B", .help = "The reference", .target = &options.b, .candidates = images, .required = true},
             {.names = "-o,--output",
              .value = "FILE",
              .help = "Write the FLIP error of each pixel as PNG, from black (none) to yellow",
              .target = &options.output,
              .candidates = {.extensions = {"png"}}},
             {.names = "--side-by-side",
              .value = "FILE",
              .help = "Write A, B and the error side by side",
              .target = &options.sideBySide,
              .candidates = {.extensions = {"png"}}},
             {.names = "--max",
              .value = "VALUE",
              .help = "Exit with status 1 if the metric exceeds this value (psnr: is below it)",
              .target = &options.max},
             {.names = "--metric",
              .value = "NAME",
              .help = "Metric of --max: mae8, max8, rmse, relmse, psnr, flip, alpha8 (default: mae8)",
              .target = &options.metric,
              .candidates = {.names = measures}},
             {.names = "--resize",
              .help = "Reduce the larger image to the size of the smaller one (box filter)",
              .target = &options.resize},
             {.names = "--layer",
              .value = "NAME",
              .help = "Layer of both OpenEXR files (beauty, normal), or one channel (depth.Z)",
              .target = &options.layer},
             {.names = "--gamma-b",
              .value = "X",
              .help = "B is encoded by this power instead of the sRGB curve",
              .target = &options.gammaB},
             {.names = "--max-memory", .value = "BYTES", .help = kMaxMemoryHelp, .target = &options.maxMemory},
             {.names = "--json", .help = "Print one JSON object instead of text", .target = &options.json}});
  table.add(
      "Films",
      {{.names = "--z-test",
        .help =
            "Test whether two films (.qfilm) with different seeds show the same image except for noise; status 1 if "
            "not; -o writes |t| of each block",
        .target = &options.zTest},
       {.names = "--level",
        .value = "P",
        .help = "Largest probability of rejecting equal images (default: 0.01)",
        .target = &options.level},
       {.names = "--block",
        .value = "N",
        .help = "Test the means of blocks of N x N pixels (default: 8)",
        .target = &options.block},
       {.names = "--tolerance",
        .value = "X",
        .help = "Relative difference that counts as rounding (default: 1e-5)",
        .target = &options.tolerance},
       {.names = "--may-differ",
        .value = "NAME",
        .help = "Fact that may differ besides seed and number of samples: program, parameter, shader library, ... (a "
                "name listed by 'quintet info FILM', or its first word); may be repeated",
        .target = &options.mayDiffer,
        .candidates = {.names = {"program", "parameter", "outputs"}}}});
  table.addExamples({
      {"quintet compare out.png reference.png"},
      {"quintet compare out.png reference.png --max 2", "status 1 if mae8 exceeds 2"},
      {"quintet compare out.exr big.exr --resize --metric flip --max 0.05 -o diff.png"},
      {"quintet compare a.exr b.exr --layer normal --metric rmse --max 1e-3"},
      {"quintet compare out.png reference.png --json | jq .psnr"},
      {"quintet compare a.qfilm b.qfilm --z-test", "status 1 if they differ by more than noise"},
      {"quintet compare a.qfilm b.qfilm --z-test --may-differ program"},
  });
  return table;
}

std::optional<CompareOptions> parseCompare(Arguments arguments) {
  CompareOptions options;
  if (!parse(declareCompare(options), arguments)) return std::nullopt;
  if (options.b.empty()) throw UsageError("two images are required; see 'quintet compare --help'");
  checkApplicable(options);
  return options;
}

const output::Measure& findMeasure(const std::vector<output::Measure>& all, const std::string& name) {
  std::vector<std::string> names;
  for (const output::Measure& measure : all) names.push_back(measure.name);
  return all[parseChoice("--metric", name, names)];
}

std::size_t memoryLimit(const CompareOptions& options) {
  return parseBytes("--max-memory", options.maxMemory).value_or(0);
}

io::Image readInput(const std::string& file, const std::optional<std::string>& layer, std::size_t maxMemory) {
  MemoryBudget budget(file, maxMemory);
  const std::vector<std::byte> bytes = readFile(file, budget);
  if (render::isFilmFile(bytes))
    throw FileError(file, "is a film; use --z-test to compare two films, or 'quintet merge' to write its image");
  return layer ? io::decodeExrLayer(bytes, file, *layer, budget) : io::decodeImage(bytes, file, budget);
}

void writePng(const std::string& file, const io::Image& image) {
  if (file.empty()) return;
  const std::vector<std::byte> bytes = io::encodePng(image);
  const ProtectedWrite protect;
  writeFile(file, bytes);
}

void checkPng(const std::string& option, const std::string& file) {
  if (file.empty()) return;
  if (file == "-") throw UsageError(fmt::format("{}: standard output is used for the numbers", option));
  if (output::fileKind(file) != output::FileKind::png)
    throw UsageError(fmt::format("{}: {}: the extension must be .png", option, file));
  checkWritable(file);
}

int compareFilms(const CompareOptions& options) {
  render::ZTestOptions test;
  test.level = parseReal("--level", options.level, 1e-12, 0.5).value_or(test.level);
  test.block = static_cast<std::uint32_t>(parseInteger("--block", options.block, 4, 4096).value_or(test.block));
  test.tolerance = parseReal("--tolerance", options.tolerance, 0, 1).value_or(test.tolerance);
  const job::FilmComparison comparison =
      job::compareFilms(options.a, options.b, options.mayDiffer, test, memoryLimit(options));
  if (!options.output.empty())
    writePng(options.output, io::colorMap(render::zTestMap(comparison.test, comparison.films[0].film.region)));
  writeFile("-", options.json ? output::comparisonJson(comparison) : output::comparisonText(comparison));
  if (!comparison.test.rejected) return 0;
  return printFailure(fmt::format("{} and {}: different images at level {}: {}", options.a, options.b, test.level,
                                  output::rejectionText(comparison)),
                      kRuntimeError);
}

int compareImages(const CompareOptions& options) {
  const std::optional<double> limit = parseReal("--max", options.max, 0.0, 1e30);
  io::Image a = readInput(options.a, options.layer, memoryLimit(options));
  io::Image b = readInput(options.b, options.layer, memoryLimit(options));
  if (const auto gamma = parseReal("--gamma-b", options.gammaB, 0.1, 10.0))
    b = io::decodePower(b, static_cast<float>(*gamma));
  if (options.resize) io::resizeToSmaller(a, b);
  const io::Comparison comparison = io::compareImages(a, b);
  const io::Image map = io::colorMap(comparison.flipMap);
  writePng(options.output, map);
  if (!options.sideBySide.empty()) writePng(options.sideBySide, io::sideBySide(a, b, map));
  writeFile("-", options.json ? output::comparisonJson(comparison, options.a, options.b, {a.width, a.height})
                              : output::comparisonText(comparison));

  const std::vector<output::Measure> all = output::measures(comparison);
  const output::Measure& measure = findMeasure(all, options.metric);
  if (!limit || measure.meets(*limit)) return 0;
  return printFailure(fmt::format("{} and {}: {} {:.6g} is {} than {:.6g}", options.a, options.b, measure.name,
                                  measure.value, measure.largerIsBetter ? "less" : "more", *limit),
                      kRuntimeError);
}

}  // namespace

OptionTable compareOptions() {
  CompareOptions options;
  return declareCompare(options).withoutTargets();
}

int compareCommand(Arguments arguments) {
  const std::optional<CompareOptions> options = parseCompare(arguments);
  if (!options) return 0;
  findMeasure(output::measures({}), options->metric);
  checkPng("-o", options->output);
  checkPng("--side-by-side", options->sideBySide);
  return options->zTest ? compareFilms(*options) : compareImages(*options);
}

}  // namespace quintet::cli
