// SPDX-License-Identifier: Apache-2.0
// quintet_equal_time A B: compares the error of two builds of quintet that render for the same time.
//
// A long reference of each scene is rendered once and kept. Then both builds alternately render several seeds with as
// many samples as fit into --seconds. Startup, compilation and the first batch are excluded: the seconds per sample are
// the difference between a run of N samples and a run of 4 samples. The product of error and time compensates for small
// differences in time.
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/file.h"
#include "equal_time_error.h"
#include "equal_time_render.h"
#include "io/codec.h"

namespace quintet::bench {
namespace {

constexpr std::uint32_t kReferenceSeed = 0x9E3779B9u;
constexpr std::uint64_t kShort = 4;  // samples of the run that measures the fixed cost

struct Options {
  std::filesystem::path a, b, scenes, list, out = "equal_time", references;
  std::string size = "320x180", clock = "device";
  double seconds = 2, referenceSeconds = 60;
  std::uint64_t referenceSamples = 0, samples = 0;
  std::uint32_t seeds = 4;
  std::vector<std::string> only, more;
  bool referencesOnly = false;
  Clock time() const { return clock == "cpu" ? Clock::cpu : Clock::device; }
};

// Measurements of one build on one scene.
struct Side {
  RenderCall call;
  double once = 0;  // seconds of a run of kShort samples
  std::uint64_t samples = 0;
  std::vector<double> perSample, relMse, trimmed, flip, mean;
  double seconds() const { return estimate(perSample).mean * static_cast<double>(samples); }
  double product(const std::vector<double>& errors) const { return estimate(errors).mean * seconds(); }
};

RenderCost renderSamples(Side& side, std::uint64_t samples, std::uint32_t seed) {
  side.call.samples = samples;
  side.call.seed = seed;
  return render(side.call);
}

// Measures the fixed cost and chooses the number of samples.
void calibrate(Side& side, const Options& options) {
  renderSamples(side, kShort, 1);  // fills the shader caches
  side.once = std::min(renderSamples(side, kShort, 1).seconds(options.time()),
                       renderSamples(side, kShort, 2).seconds(options.time()));
  side.samples = options.samples;
  if (options.samples > 0) return;
  double perSample = 0;
  std::uint64_t samples = 4 * kShort;
  for (;; samples *= 4) {  // until the run is long enough to measure
    const double spent = renderSamples(side, samples, 1).seconds(options.time()) - side.once;
    perSample = spent / static_cast<double>(samples - kShort);
    if (spent > 0.25 * options.seconds || samples >= (1u << 20)) break;
  }
  side.samples = std::clamp<std::uint64_t>(
      static_cast<std::uint64_t>(options.seconds / std::max(perSample, 1e-9) + 0.5), 2 * kShort, 1u << 22);
}

void measure(Side& side, std::uint32_t seed, const io::Image& reference, const Options& options) {
  const double spent = renderSamples(side, side.samples, seed).seconds(options.time());
  const auto samples = static_cast<double>(side.samples);
  side.perSample.push_back(side.samples > 2 * kShort ? (spent - side.once) / (samples - kShort) : spent / samples);
  const ImageError error = imageError(io::readImage(side.call.output), reference, middleExposure(reference));
  side.relMse.push_back(error.relMse);
  side.trimmed.push_back(error.trimmed);
  side.flip.push_back(error.flip);
  side.mean.push_back(error.mean);
}

std::filesystem::path referenceOf(const BenchScene& scene, const Options& options) {
  const std::filesystem::path file = options.references / fmt::format("{}_{}.exr", scene.name, options.size);
  if (std::filesystem::exists(file)) return file;
  RenderCall call{options.b,
                  &scene,
                  options.size,
                  options.referenceSamples,
                  options.referenceSamples > 0 ? 0.0 : options.referenceSeconds,
                  kReferenceSeed,
                  file,
                  options.more};
  const RenderCost cost = render(call);
  fmt::print(stderr, "{}: reference of {} samples, {:.1f} s on the device\n", scene.name, cost.samples,
             cost.deviceSeconds);
  return file;
}

std::string row(const BenchScene& scene, const Side& a, const Side& b) {
  const auto both = [](const Estimate& e) { return fmt::format("{:.3g} ± {:.0f} %", e.mean, 100 * e.error / e.mean); };
  return fmt::format("| {} | {} / {} | {:.2f} / {:.2f} | {} | {} | **{:.2f}** | {:.2f} | {:.3f} / {:.3f} |\n",
                     scene.name, a.samples, b.samples, a.seconds(), b.seconds(), both(estimate(a.relMse)),
                     both(estimate(b.relMse)), a.product(a.relMse) / b.product(b.relMse),
                     a.product(a.trimmed) / b.product(b.trimmed), estimate(a.flip).mean, estimate(b.flip).mean);
}

std::string compareScene(const BenchScene& scene, const Options& options) {
  const io::Image reference = io::readImage(referenceOf(scene, options));
  if (options.referencesOnly) return "";
  Side a, b;
  a.call = {options.a, &scene, options.size, 0, 0.0, 0, options.out / "a.exr", options.more};
  b.call = {options.b, &scene, options.size, 0, 0.0, 0, options.out / "b.exr", options.more};
  calibrate(a, options);
  calibrate(b, options);
  for (std::uint32_t seed = 1; seed <= options.seeds; ++seed) {
    measure(a, seed, reference, options);
    measure(b, seed, reference, options);
    if (seed > 1) continue;
    const io::Image images =
        sideBySide(io::readImage(a.call.output), io::readImage(b.call.output), reference, middleExposure(reference));
    writeFile(options.out / (scene.name + ".png"), io::encodePng(images));
  }
  const Estimate meanA = estimate(a.mean), meanB = estimate(b.mean);
  fmt::print(stderr, "{}: mean luminance relative to the reference: A {:.4f} ± {:.4f}, B {:.4f} ± {:.4f}\n", scene.name,
             meanA.mean, meanA.error, meanB.mean, meanB.error);
  for (const Side* side : {&a, &b}) std::filesystem::remove(side->call.output);
  return row(scene, a, b);
}

void declare(CLI::App& app, Options& options) {
  app.add_option("A", options.a, "First quintet binary, such as the previous version")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("B", options.b, "Second quintet binary; also renders the references")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--scenes", options.scenes, "Folder with the output of quintet_make_scenes")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--list", options.list, "List of names, files and options (default: scenes.txt in --scenes)");
  app.add_option("--only", options.only, "Scenes of the list to render, separated by commas")->delimiter(',');
  app.add_option("--references", options.references,
                 "Folder of the references; missing ones are rendered (default: OUT)");
  app.add_option("--out", options.out, "Folder for images: A | B | reference, first seed")->capture_default_str();
  app.add_option("--size", options.size, "Image size, WxH")->capture_default_str();
  app.add_option("--seconds", options.seconds, "Seconds per render")->capture_default_str();
  app.add_option("--spp", options.samples, "Number of samples per pixel of both builds, instead of --seconds")
      ->check(CLI::Range(1, 1 << 22));
  app.add_option("--seeds", options.seeds, "Number of renders per build")->capture_default_str();
  app.add_option("--reference-seconds", options.referenceSeconds, "Seconds per reference")->capture_default_str();
  app.add_option("--reference-spp", options.referenceSamples,
                 "Number of samples per pixel of a reference, instead of seconds");
  app.add_flag("--references-only", options.referencesOnly, "Render the missing references and exit");
  app.add_option("--clock", options.clock,
                 "Clock: device (time stamps), or cpu (processor time, for a busy machine without a GPU)")
      ->check(CLI::IsMember({"device", "cpu"}))
      ->capture_default_str();
  app.add_option("--more", options.more, "Additional option for every render, such as --more=--device=h200")
      ->expected(1)
      ->take_all();
}

int run(const Options& given) {
  Options options = given;
  if (options.references.empty()) options.references = options.out;
  if (options.list.empty()) options.list = options.scenes / "scenes.txt";
  for (const auto& folder : {options.out, options.references}) std::filesystem::create_directories(folder);
  fmt::print(
      "| scene | samples per pixel A / B | seconds A / B | relMSE A | relMSE B | A / B of relMSE × s | of 99.9 % of "
      "the pixels | FLIP A / B |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const BenchScene& scene : readScenes(options.list, options.scenes)) {
    if (!options.only.empty() && std::ranges::find(options.only, scene.name) == options.only.end()) continue;
    fmt::print("{}", compareScene(scene, options));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace quintet::bench

int main(int argc, char** argv) {
  CLI::App app("Compare the error of two builds of quintet at equal time. Prints a table; above 1, B is better.");
  quintet::bench::Options options;
  quintet::bench::declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    return quintet::bench::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_equal_time: {}\n", error.what());
    return 1;
  }
}
