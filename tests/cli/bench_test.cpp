// SPDX-License-Identifier: Apache-2.0
// `bench --profile`: the measurements are consistent.
#include "fixtures.h"

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

}  // namespace
}  // namespace quintet::test
