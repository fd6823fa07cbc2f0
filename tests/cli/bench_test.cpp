// SPDX-License-Identifier: Apache-2.0
// `bench`: the measurements are consistent, also those of any program.
#include <gmock/gmock.h>

#include "sky_program.h"

namespace quintet::test {
namespace {

class Bench : public CliTest {
 protected:
  nlohmann::json profile(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"bench",    "scene.gltf", "--size",    "32x24",
                                       "--repeat", "2",          "--profile", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }
};

TEST_F(Bench, CountsRaysByKind) {
  const nlohmann::json tracer = profile()["pathTracer"];
  const nlohmann::json& rays = tracer["rays"];
  EXPECT_EQ(rays["camera"]["rays"], 32 * 24);
  std::uint64_t sum = 0;
  for (const char* kind : {"camera", "continuation", "shadow"}) {
    const auto count = rays[kind]["rays"].get<std::uint64_t>();
    EXPECT_EQ(rays[kind]["hits"].get<std::uint64_t>() + rays[kind]["misses"].get<std::uint64_t>(), count) << kind;
    sum += count;
  }
  EXPECT_EQ(sum, tracer["raysPerSample"].get<std::uint64_t>());  // as the film counts
  EXPECT_EQ(tracer["replayedRays"], tracer["raysPerSample"]);
  // One quad: some rays hit it and some miss it, and each continuation ray starts at a hit.
  const auto hits = rays["camera"]["hits"].get<std::uint64_t>();
  EXPECT_GT(hits, 0u);
  EXPECT_GT(rays["camera"]["misses"].get<std::uint64_t>(), 0u);
  EXPECT_LE(rays["continuation"]["rays"].get<std::uint64_t>(),
            hits + rays["continuation"]["hits"].get<std::uint64_t>());
}

TEST_F(Bench, PassesAddUpToTheTotal) {
  const nlohmann::json p = profile()["profile"];
  for (const char* pass : {"uploadSeconds", "orderSeconds", "bottomLevelBuildSeconds", "topLevelBuildSeconds",
                           "beginBatchSeconds", "traceSeconds", "filmAddSeconds", "downloadSeconds", "toneMapSeconds"})
    EXPECT_GE(p["passes"].at(pass).get<double>(), 0.0) << pass;
  const double busy = p["deviceBusySeconds"], wall = p["wallSeconds"], trace = p["passes"]["traceSeconds"];
  EXPECT_GT(trace, 0.0);
  EXPECT_NEAR(
      busy, trace + p["passes"]["beginBatchSeconds"].get<double>() + p["passes"]["filmAddSeconds"].get<double>(), 1e-9);
  EXPECT_LE(busy + p["deviceIdleSeconds"].get<double>(), 1.05 * wall + 0.002);  // different clocks
  EXPECT_NEAR(p["busyShare"].get<double>(), busy / wall, 1e-6);
  EXPECT_NEAR(p["samplesPerSecond"].get<double>(), 32.0 * 24 * 4 * 2 / wall, 1.0);
  EXPECT_GE(p["launches"]["count"].get<int>(), 2);  // two batches
  EXPECT_LE(p["launches"]["medianInvocations"].get<double>(), 32 * 24);
  EXPECT_LE(p["launches"]["medianSeconds"].get<double>(), p["launches"]["largestSeconds"].get<double>());
}

TEST_F(Bench, ReportsThePipeline) {
  const nlohmann::json pipeline = profile({"--program", "naive"})["profile"]["pipeline"];
  const nlohmann::json& executables = pipeline["executables"];  // a text if the driver reports none
  EXPECT_TRUE((executables.is_object() && !executables.empty()) || executables.is_string()) << pipeline;
  EXPECT_TRUE(pipeline["stackBytes"].contains("ray generation")) << pipeline;
  EXPECT_GE(pipeline["stackBytes"].size(), 3u);  // ray generation, miss and hit group
  EXPECT_EQ(pipeline["payloadBytes"]["HitPayload"], 24)
      << pipeline;  // t, three indices and two coordinates, for opaque triangles
}

TEST_F(Bench, PrintsATable) {
  const RunResult result = quintet({"bench", "scene.gltf", "--size", "16x16", "--repeat", "1", "--profile"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* line : {"\npathTracer.ratio ", "\npathTracer.rays.shadow.hits ", "\nprofile.passes.filmAddSeconds ",
                           "\nprofile.launches.count "})
    EXPECT_NE(result.out.find(line), std::string::npos) << line;
  EXPECT_EQ(result.out.find("primitiveOrder"), std::string::npos);
}

// The program traces one ray per pixel, and none with traceClosest.
TEST_F(Bench, MeasuresAnyProgram) {
  writeSkyProgram(folder_ / "mine", "payload.color = vec3(0.5);");
  for (const std::vector<std::string>& program :
       {std::vector<std::string>{"mine", "scene.gltf"}, {"mine"}, {"lessons/10_sphere"}}) {
    std::vector<std::string> arguments{"bench", "--size", "64x48", "--repeat", "3", "--json"};
    arguments.insert(arguments.begin() + 1, program.begin(), program.end());
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["program"], program[0]);
    const nlohmann::json& launch = json["launch"];
    EXPECT_EQ(launch["count"], 3);
    EXPECT_GT(launch["minSeconds"].get<double>(), 0.0);
    EXPECT_LE(launch["minSeconds"].get<double>(), launch["medianSeconds"].get<double>());
    EXPECT_LE(launch["medianSeconds"].get<double>(), launch["maxSeconds"].get<double>());
    EXPECT_GE(launch["strips"].get<int>(), 1);
    EXPECT_GT(json["pipelineSeconds"].get<double>(), 0.0);
    EXPECT_NEAR(json["samplesPerSecond"].get<double>() * launch["medianSeconds"].get<double>(), 64 * 48, 0.1);
    EXPECT_TRUE(json["pipeline"]["stackBytes"].contains("ray generation")) << json;
    EXPECT_GE(json["rays"]["total"].get<int>(), 64 * 48) << json["rays"];
    std::uint64_t sum = 0;
    for (const auto& [type, count] : json["rays"]["byType"].items()) sum += count.get<std::uint64_t>();
    EXPECT_EQ(sum, json["rays"]["total"].get<std::uint64_t>());
  }
}

TEST_F(Bench, PrintsTheErrorsOfAProgram) {
  writeSkyProgram(folder_ / "bad", "payload.tint = vec3(0.5);");
  const RunResult result = quintet({"bench", "bad", "scene.gltf"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("'tint' : no such field"), std::string::npos) << result.err;
  const RunResult json = quintet({"bench", "bad", "scene.gltf", "--json"});
  EXPECT_EQ(json.status, 1);
  EXPECT_EQ(nlohmann::json::parse(json.out).at(0)["id"], "GLSL") << json.out;
}

TEST_F(Bench, ComparesTrianglesOnly) {
  const RunResult result =
      quintet({"bench", QUINTET_SOURCE_ROOT "/examples/scenes/spheres.scene.toml", "--size", "16x16"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, testing::HasSubstr("procedural geometry"));
  EXPECT_THAT(result.err, testing::HasSubstr("--profile measures all scenes"));
  EXPECT_THAT(result.err, testing::Not(testing::HasSubstr("Q601")));
}

TEST_F(Bench, ProfilesScenesThatCannotBeCompared) {
  const RunResult result = quintet({"bench", QUINTET_SOURCE_ROOT "/examples/scenes/spheres.scene.toml", "--profile",
                                    "--size", "16x16", "--repeat", "1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_THAT(json["pathTracer"]["notCompared"].get<std::string>(), testing::HasSubstr("procedural geometry"));
  EXPECT_GT(json["profile"]["samplesPerSecond"], 0.0);
}

TEST_F(Bench, ExplainsWhichFormAnOptionRequires) {
  writeSkyProgram(folder_ / "mine", "payload.color = vec3(0.5);");
  expectError(quintet({"bench", "mine", "--profile"}), 2, {"--profile requires", "bench SCENE"});
  expectError(quintet({"bench", "scene.gltf", "--set", "a=1"}), 2, {"--set requires", "bench PROGRAM"});
  expectError(quintet({"bench", "mine", "--set", "a=1"}), 2, {"'a'"});
  expectError(quintet({"bench", "scene.gltf", "--program", "mine", "--size", "16x16"}), 2,
              {"'mine'", "traceClosest", "quintet bench PROGRAM SCENE"});
}

}  // namespace
}  // namespace quintet::test
