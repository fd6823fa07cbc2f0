// SPDX-License-Identifier: Apache-2.0
// `explain-pixel`: text, JSON, differences, and errors.
#include <gmock/gmock.h>

#include <regex>

#include "base/file.h"
#include "base/parse.h"
#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class ExplainPixel : public CliTest {
 protected:
  RunResult explain(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"explain-pixel", "scene.gltf", "--pixel", "16,12", "--size",
                                       "32x24",         "--env",      "1,1,1",   "--spp", "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
};

TEST_F(ExplainPixel, PrintsTheTreeAsText) {
  const RunResult result = explain({"--sample", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("scene.gltf: pixel 16,12 of 32x24, sample 2 of 4, seed 0\n"));
  EXPECT_THAT(result.out, HasSubstr("\nContributions\n"));
  EXPECT_THAT(result.out, HasSubstr("\nRay 1: radiance, "));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("The sum is not")));
}

// The page shows what the command prints, up to numbers, which depend on the driver.
TEST_F(ExplainPixel, PrintsWhatItsPageShows) {
  const auto withoutNumbers = [](const std::string& text) {
    std::string result = std::regex_replace(text, std::regex("-?[0-9]+(\\.[0-9]+)?(e[-+]?[0-9]+)?"), "#");
    return std::regex_replace(result, std::regex(" +"), " ");
  };
  const std::string page = readTextFile(QUINTET_SOURCE_ROOT "/docs/explain-pixel.md");
  const std::size_t begin = page.find("    default scene: pixel 200,150");
  ASSERT_NE(begin, page.npos);
  std::string shown;
  for (const std::string& line : splitText(page.substr(begin), '\n')) {
    if (!line.empty() && !line.starts_with("    ")) break;
    shown += line.empty() ? "\n" : line.substr(4) + "\n";
  }
  const RunResult result = quintet({"explain-pixel", "--pixel", "200,150", "--size", "400x300"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto comparable = [&](const std::string& text) {
    std::vector<std::string> lines;
    for (const std::string& line : splitText(withoutNumbers(text), '\n'))
      if (!line.empty() && !line.starts_with("program pathtracer on ")) lines.push_back(line);
    return lines;
  };
  EXPECT_EQ(comparable(result.out), comparable(shown));
}

TEST_F(ExplainPixel, PrintsJsonAndComparesWithIt) {
  const RunResult first = explain({"--json"});
  ASSERT_EQ(first.status, 0) << first.err;
  const auto json = nlohmann::json::parse(first.out);
  EXPECT_EQ(json["pixel"], nlohmann::json({16, 12}));
  EXPECT_EQ(json["program"], "pathtracer");
  EXPECT_THAT(json["command"].get<std::string>(), HasSubstr("quintet explain-pixel scene.gltf --pixel 16,12"));
  EXPECT_EQ(json["events"][1]["type"], "ray");
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(json["contributionSum"][i].get<double>(), json["outputs"][0]["value"][i].get<double>(), 1e-5);

  write(folder_ / "a.json", first.out);
  const RunResult same = explain({"--against", "a.json"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("events are equal"));
  const RunResult other = explain({"--against", "a.json", "--seed", "1", "--json"});
  EXPECT_EQ(other.status, 1);
  const auto difference = nlohmann::json::parse(other.out);
  EXPECT_EQ(difference["equal"], false);
  EXPECT_EQ(difference["facts"][0]["location"], "seed");
  EXPECT_EQ(difference["first"]["location"], "camera: film");
}

TEST_F(ExplainPixel, WritesAnImageWithTheRays) {
  const RunResult plain = explain();
  const RunResult result = explain({"--image", "rays.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, plain.out) << "the text stays the same";
  const RunResult render =
      quintet({"render", "scene.gltf", "--size", "32x24", "--env", "1,1,1", "--spp", "4", "-o", "plain.png"});
  ASSERT_EQ(render.status, 0) << render.err;
  const io::Image image = io::readImage(folder_ / "rays.png"), expected = io::readImage(folder_ / "plain.png");
  ASSERT_EQ(image.width, 32u);
  ASSERT_EQ(image.channels, 3u);
  const auto pixel = [](const io::Image& from, std::uint32_t x, std::uint32_t y) {
    const auto samples = from.pixel<std::uint8_t>(x, y);
    return std::vector<int>(samples.begin(), samples.end());
  };
  EXPECT_EQ(pixel(image, 16, 12), (std::vector<int>{255, 255, 255})) << "the marker of the camera ray";
  EXPECT_EQ(pixel(image, 0, 0), pixel(expected, 0, 0)) << "away from the rays";
  EXPECT_NE(pixel(expected, 16, 12), pixel(image, 16, 12));

  expectError(explain({"--image", "rays.exr"}), 2, {"--image: 'rays.exr' must be a PNG file"});
  expectError(explain({"--image", "-"}), 2, {"--image requires a file"});
  expectError(explain({"--image", "missing/rays.png"}), 1, {"missing"});
}

TEST_F(ExplainPixel, PrintsTheExplanationAlsoIfTheImageFails) {
  write(folder_ / "flat.rt.glsl",
        "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(1.0, 0.0, 0.0, 1.0));\n}\n");
  const RunResult result = explain({"--program", "flat.rt.glsl", "--image", "rays.png", "--json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(nlohmann::json::parse(result.out)["program"], "flat") << "one object";
  EXPECT_THAT(result.err, HasSubstr("not that of the scene's camera"));
}

// The image shows the frame that was explained.
TEST_F(ExplainPixel, DrawsOverTheExplainedFrame) {
  write(folder_ / "count.rt.glsl",
        "#include <quintet/camera.glsl>\n/**** COMMON START ****/\nstruct RayPayloadType {\n  vec3 color;\n};\n"
        "/**** COMMON END ****/\n"
        "void main() { /**** RAY GENERATION SHADER ****/\n"
        "  const Ray ray = cameraRay(vec2(gl_LaunchIDEXT.xy) + 0.5, vec2(0.5));\n"
        "  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, ray.origin, 0.0, ray.direction, 100.0, 0);\n"
        "  gsnSetPixel(vec4(float(frameID) / 4.0, float(frameSize) / 8.0, 0.0, 1.0));\n}\n"
        "void main() { /**** CLOSEST-HIT SHADER ****/\n}\n"
        "void main() { /**** MISS SHADER ****/\n}\n");
  const RunResult result = explain({"--program", "count.rt.glsl", "--sample", "1", "--image", "rays.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  const io::Image image = io::readImage(folder_ / "rays.png");
  const auto corner = image.pixel<std::uint8_t>(0, 0);
  EXPECT_EQ(std::vector<int>(corner.begin(), corner.end()), (std::vector<int>{64, 128, 0})) << "frame 1 of 4";
}

TEST_F(ExplainPixel, RejectsWrongRequests) {
  expectError(quintet({"explain-pixel", "scene.gltf"}), 2, {"no pixel given; use --pixel X,Y"});
  expectError(quintet({"explain-pixel", "scene.gltf", "--pixel", "5"}), 2, {"--pixel: '5' must be X,Y"});
  expectError(explain({"--sample", "4"}), 2, {"--sample 4", "samples 0 to 3"});
  expectError(explain({"--tolerance", "0.1"}), 2, {"--tolerance requires --against"});
  expectError(explain({"--against", "missing.json"}), 1, {"missing.json"});
  write(folder_ / "wrong.json", "{}");
  expectError(explain({"--against", "wrong.json"}), 1, {"wrong.json", "not an explanation"});
  expectError(quintet({"explain-pixel", "scene.gltf", "--pixel", "400,2", "--size", "32x24"}), 2,
              {"pixel 400,2 is not inside the image of 32x24"});
  expectError(quintet({"explain-pixel", "scene.gltf", "--env", "none", "--pixel", "5000,2"}), 2,
              {"pixel 5000,2 is not inside the image of"});
  expectError(explain({"--frame", "3"}), 2, {"neither keyframes nor an animation"});
}

}  // namespace
}  // namespace quintet::test
