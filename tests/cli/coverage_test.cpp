// SPDX-License-Identifier: Apache-2.0
// The error that `render --until-error` states covers the real error of path traced images, measured against a reference
// with many samples.
#include <cmath>
#include <cstdio>
#include <string>

#include "demo/test_scenes.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

class StatedErrorOfPathTracer : public CliTest {
 protected:
  StatedErrorOfPathTracer() { write(folder_ / "cornell.glb", demo::testScenes()[0].make()); }

  nlohmann::json render(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render",  "cornell.glb", "--size",     "12x10", "-o",
                                       "out.exr", "-q",          "--exr-type", "float", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
  }
};

// docs/cli.md, "The stated error".
double realError(const io::Image& image, const io::Image& reference) {
  const auto luminance = [](std::span<const float> p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; };
  const double pixels = double(reference.width) * reference.height;
  double mean = 0, sum = 0;
  for (std::uint32_t y = 0; y < reference.height; ++y)
    for (std::uint32_t x = 0; x < reference.width; ++x) mean += luminance(reference.pixel<float>(x, y)) / pixels;
  for (std::uint32_t y = 0; y < reference.height; ++y)
    for (std::uint32_t x = 0; x < reference.width; ++x) {
      const auto a = image.pixel<float>(x, y), b = reference.pixel<float>(x, y);
      const double l = luminance(b);
      for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(double(a[c]) - double(b[c]), 2) / 3 / (l * l + 0.01 * mean * mean) / pixels;
    }
  return std::sqrt(sum);
}

// The image has one tile, so that error.tiles equals error.image. Both must hold in 90 % of the renders.
TEST_F(StatedErrorOfPathTracer, CoversTheRealError) {
  constexpr int kRuns = 20;
  constexpr const char* kTarget = "0.3";  // about 70 samples: the reference with 2048 has a sixth of the error
  render({"--spp", "2048", "--seed", "1000"});
  const io::Image reference = readImage("out.exr");
  for (const bool adaptive : {false, true}) {
    int covered = 0, reached = 0;
    double stated = 0, real = 0, samples = 0;
    for (int seed = 0; seed < kRuns; ++seed) {
      std::vector<std::string> more{"--until-error", kTarget, "--seed", std::to_string(seed)};
      if (adaptive) more.push_back("--adaptive");
      const nlohmann::json json = render(more);
      const double error = realError(readImage("out.exr"), reference), upper = json.at("error").at("image");
      EXPECT_EQ(json.at("error").at("reached"), true);
      covered += error <= upper && error <= json.at("error").at("tiles").get<double>();
      reached += error <= std::stod(kTarget);
      stated += upper / kRuns;
      real += error / kRuns;
      samples += json.at("samples").get<double>() / kRuns;
    }
    std::printf("  %s: covered %d of %d, target reached %d; stated %.4f, real %.4f, %.1f samples\n",
                adaptive ? "adaptive" : "uniform", covered, kRuns, reached, stated, real, samples);
    EXPECT_GE(covered, 18) << adaptive;
    EXPECT_GE(reached, 18) << adaptive;
    EXPECT_LT(stated, 2.5 * real) << "the bound is too loose: " << adaptive;
  }
}

}  // namespace
}  // namespace quintet::test
