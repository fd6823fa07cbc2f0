// `quintet compare`: all measures of io/compare.h, a picture of the difference, and an exit status; or the test of two films.
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "cli.h"
#include "compare_films.h"
#include "io/codec.h"
#include "io/color.h"
#include "io/compare.h"
#include "io/exr.h"
#include "output.h"
#include "render/film_file.h"
#include "side_by_side.h"
#include "signals.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet compare out.png reference.png\n"
    "  quintet compare out.png reference.png --max 2            status 1 if mae8 is more than 2\n"
    "  quintet compare out.exr big.exr --resize --metric flip --max 0.05 -o difference.png\n"
    "  quintet compare a.exr b.exr --layer normal --metric rmse --max 1e-3\n"
    "  quintet compare out.png reference.png --json | jq .psnr\n"
    "  quintet compare a.qfilm b.qfilm --z-test                 the same picture but for noise? else status 1\n"
    "  quintet compare a.qfilm b.qfilm --z-test --may-differ program --may-differ parameter\n";

constexpr const char* kZTestGroup = "Films";

struct Options {
  std::string a, b, output, sideBySide, metric = "mae8", max, gammaB;
  std::string level, block, tolerance;
  std::vector<std::string> mayDiffer;
  bool zTest = false;
  std::optional<std::string> layer;
  bool resize = false;
  bool json = false;
};

struct Measure {
  const char* name;
  const char* meaning;
  double value;
  bool moreIsBetter = false;
};

std::array<Measure, 7> measures(const io::Comparison& c) {
  return {{{"mae8", "mean absolute difference, in steps of 1/255", c.mae8},
           {"max8", "largest difference, in steps of 1/255", c.max8},
           {"psnr", "peak signal to noise ratio, dB", c.psnr, true},
           {"rmse", "root mean square difference, linear light", c.rmse},
           {"relmse", "relative mean square error, linear light", c.relMse},
           {"flip", "mean FLIP error, 0 to 1", c.flip},
           {"alpha8", "mean absolute difference of alpha, in steps of 1/255", c.alphaMae8}}};
}

void addFilmOptions(CLI::App& app, Options& options) {
  app.add_flag("--z-test", options.zTest,
               "A and B are films (.qfilm) with different seeds: test whether they are the\n"
               "same picture but for noise; status 1 if not; -o writes |t| of each block")
      ->group(kZTestGroup);
  const auto add = [&app](const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group(kZTestGroup);
  };
  add("--level", options.level, "P", "With this probability at most, the same picture is rejected (default: 0.01)");
  add("--block", options.block, "N", "Test the means of blocks of N x N pixels (default: 8)");
  add("--tolerance", options.tolerance, "X", "A relative difference up to X is rounding (default: 1e-5)");
  app.add_option("--may-differ", options.mayDiffer,
                 "What may differ besides seed and number of samples: program, parameter,\n"
                 "shader library, ... (a name that films have, or its first word); may be repeated")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("NAME")
      ->group(kZTestGroup);
}

// Options that mean nothing here are refused.
void checkKind(const Options& options) {
  const auto refuse = [](const char* name, bool given, const char* problem) {
    if (given) throw UsageError(fmt::format("{}: {}", name, problem));
  };
  constexpr const char* kFilms = "needs --z-test";
  constexpr const char* kPictures = "is for pictures, not for --z-test";
  refuse("--level", !options.zTest && !options.level.empty(), kFilms);
  refuse("--block", !options.zTest && !options.block.empty(), kFilms);
  refuse("--tolerance", !options.zTest && !options.tolerance.empty(), kFilms);
  refuse("--may-differ", !options.zTest && !options.mayDiffer.empty(), kFilms);
  refuse("--max", options.zTest && !options.max.empty(), kPictures);
  refuse("--metric", options.zTest && options.metric != Options().metric, kPictures);
  refuse("--side-by-side", options.zTest && !options.sideBySide.empty(), kPictures);
  refuse("--gamma-b", options.zTest && !options.gammaB.empty(), kPictures);
  refuse("--layer", options.zTest && options.layer.has_value(), kPictures);
  refuse("--resize", options.zTest && options.resize, kPictures);
}

FilmComparison filmComparison(const Options& options) {
  FilmComparison result{options.a, options.b, options.output, options.mayDiffer, options.json, {}};
  const auto number = [](const char* name, const std::string& text, double unless, double min, double max) {
    return text.empty() ? unless : parseNumber(name, text, min, max);
  };
  result.test.level = number("--level", options.level, result.test.level, 1e-12, 0.5);
  const double block = number("--block", options.block, result.test.block, 4, 4096);
  if (block != std::floor(block)) throw UsageError(fmt::format("--block: {} is not a whole number", options.block));
  result.test.block = static_cast<std::uint32_t>(block);
  result.test.tolerance = number("--tolerance", options.tolerance, result.test.tolerance, 0, 1);
  return result;
}

std::optional<Options> parseOptions(Arguments arguments) {
  CLI::App app("Says how far picture A is from picture B, the reference.", "quintet compare");
  Options options;
  const auto add = [&app](const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form);
  };
  add("A", options.a, "", "The picture: PNG, JPEG, WebP, Radiance HDR or OpenEXR");
  add("B", options.b, "", "The reference");
  add("-o,--output", options.output, "FILE", "Write the FLIP error of each pixel as PNG, black (none) to yellow");
  add("--side-by-side", options.sideBySide, "FILE", "Write A, B and the error next to one another");
  add("--max", options.max, "VALUE", "Exit with status 1 if the metric is beyond this (psnr: below)");
  add("--metric", options.metric, "NAME", "For --max: mae8, max8, rmse, relmse, psnr, flip, alpha8 (default: mae8)");
  app.add_flag("--resize", options.resize, "Bring pictures of different sizes to the smaller size (box filter)");
  app.add_option("--layer", options.layer, "A layer of both OpenEXR files (beauty, normal), or one channel (depth.Z)")
      ->type_name("NAME");
  add("--gamma-b", options.gammaB, "X", "B is encoded by this power instead of the sRGB curve");
  app.add_flag("--json", options.json, "One JSON object instead of text");
  addFilmOptions(app, options);
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  if (options.b.empty()) throw UsageError("two pictures are needed; see 'quintet compare --help'");
  checkKind(options);
  return options;
}

const Measure& findMeasure(const std::array<Measure, 7>& all, const std::string& name) {
  std::vector<std::string> names;
  for (const Measure& measure : all) {
    if (name == measure.name) return measure;
    names.emplace_back(measure.name);
  }
  throw UsageError(fmt::format("--metric: there is no '{}'{}; there are {}", plain(name), suggestion(name, names),
                               fmt::join(names, ", ")));
}

io::Image readPicture(const std::string& file, const std::optional<std::string>& layer) {
  const std::vector<std::byte> bytes = readFile(file);
  if (render::isFilmFile(bytes))
    throw FileError(file, "is a film: --z-test compares two, 'quintet merge' makes its picture");
  return layer ? io::decodeExrLayer(bytes, file, *layer) : io::decodeImage(bytes, file);
}

// Display values of a pure power, as linear light.
io::Image fromGamma(io::Image image, float gamma) {
  if (image.encoding == io::ColorEncoding::linear) return image;
  image.encoding = io::ColorEncoding::linear;  // so that the values stay what they are
  io::Image result = io::toFloat(image);
  const auto samples = result.samples<float>();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool isAlpha = result.hasAlpha() && i % result.channels == result.channels - 1;
    if (!isAlpha) samples[i] = std::pow(samples[i], gamma);
  }
  return result;
}

void bringToOneSize(io::Image& a, io::Image& b) {
  if (a.width == b.width && a.height == b.height) return;
  const io::Image& smaller = a.pixelCount() <= b.pixelCount() ? a : b;
  const std::uint32_t width = smaller.width;
  const std::uint32_t height = smaller.height;
  for (io::Image* image : {&a, &b})
    if (image->width != width || image->height != height) *image = io::resizeBox(*image, width, height);
}

std::string report(const Options& options, const io::Image& a, const io::Comparison& comparison) {
  if (options.json) {
    nlohmann::ordered_json json{{"a", options.a}, {"b", options.b}, {"size", {a.width, a.height}}};
    for (const Measure& m : measures(comparison))
      json[m.name] =
          std::isfinite(m.value) ? nlohmann::ordered_json(m.value) : nlohmann::ordered_json();  // psnr of equals
    json["nonFinitePixels"] = comparison.nonFinitePixels;
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  }
  std::string text;
  for (const Measure& m : measures(comparison)) text += fmt::format("{:<8}{:<12.6g}{}\n", m.name, m.value, m.meaning);
  if (comparison.nonFinitePixels > 0)
    text += fmt::format("{} pixels hold NaN or infinity\n", comparison.nonFinitePixels);
  return text;
}

void writePng(const std::string& file, const io::Image& image) {
  const std::vector<std::byte> bytes = io::encodePng(image);
  const ProtectedWrite protect;
  writeFile(file, bytes);
}

void checkPicture(const std::string& option, const std::string& file) {
  if (file.empty()) return;
  if (outputKind(file) != OutputKind::png)
    throw UsageError(fmt::format("{}: {}: the extension must be .png", option, file));
  if (file == "-") throw UsageError(fmt::format("{}: the standard output has the numbers", option));
  checkWritable(file);
}

}  // namespace

int compareCommand(Arguments arguments) {
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  findMeasure(measures({}), options->metric);
  std::optional<double> limit;
  if (!options->max.empty()) limit = parseNumber("--max", options->max, 0.0, 1e30);
  checkPicture("-o", options->output);
  checkPicture("--side-by-side", options->sideBySide);
  if (options->zTest) {
    compareFilms(filmComparison(*options));
    return 0;
  }

  io::Image a = readPicture(options->a, options->layer);
  io::Image b = readPicture(options->b, options->layer);
  if (!options->gammaB.empty())
    b = fromGamma(std::move(b), static_cast<float>(parseNumber("--gamma-b", options->gammaB, 0.1, 10.0)));
  if (options->resize) bringToOneSize(a, b);
  const io::Comparison comparison = io::compareImages(a, b);
  if (!options->output.empty()) writePng(options->output, io::colorMap(comparison.flipMap));
  if (!options->sideBySide.empty()) writePng(options->sideBySide, sideBySide(a, b, io::colorMap(comparison.flipMap)));
  writeFile("-", report(*options, a, comparison));

  const auto all = measures(comparison);
  const Measure& measure = findMeasure(all, options->metric);
  if (limit && !(measure.moreIsBetter ? measure.value >= *limit : measure.value <= *limit))
    throw Error(fmt::format("{} and {}: {} {:.6g} is {} than {:.6g}", options->a, options->b, measure.name,
                            measure.value, measure.moreIsBetter ? "less" : "more", *limit));
  return 0;
}

}  // namespace quintet::app
