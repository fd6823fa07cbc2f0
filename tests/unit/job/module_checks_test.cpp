// SPDX-License-Identifier: Apache-2.0
// Raw modules from files: folders, groups files and their errors, and the shaders of public applications.
#include "job/module_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "shader/shader_test_support.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;
using shader::TemporaryFolder;
using testing::HasSubstr;

std::vector<std::uint32_t> compileRaw(const fs::path& file, const std::string& text, std::string& error) {
  shader::CompilerOptions options;
  options.optimize = false;
  const shader::Compiler compiler(options);
  shader::Source source;
  source.stage = *shader::stageOfFile(file);
  source.name = file.string();
  source.text = text;
  source.optimize = false;
  shader::Result result = compiler.compile(source);
  for (const Diagnostic& d : result.diagnostics)
    if (d.severity == Severity::error && error.empty()) error = d.format();
  return result.spirv;
}

void writeModule(const fs::path& file, const std::vector<std::uint32_t>& words) {
  writeFile(file, std::as_bytes(std::span(words)));
}

constexpr const char* kGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
void main() {
  traceRayEXT(tlas, 0, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color);
}
)";
constexpr const char* kMiss = R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 color;
void main() { color = vec3(0.5); }
)";

class ModuleFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    writeModule(folder() / "a.rgen.spv", compileRaw("a.rgen", kGeneration, error));
    writeModule(folder() / "a.rmiss.spv", compileRaw("a.rmiss", kMiss, error));
    ASSERT_EQ(error, "");
  }
  fs::path folder() const { return folder_.path(); }
  std::vector<Diagnostic> check(const std::string& groups = {}) {
    ModuleCheckRequest request{{folder().string()}, {}, {}};
    if (!groups.empty()) {
      request.groups = folder() / "groups.json";
      writeFile(request.groups, groups);
    }
    CheckObserver observer;
    return checkModuleFiles(request, observer).diagnostics();
  }
  std::string firstText(const std::string& groups) {
    const auto found = check(groups);
    return found.empty() ? "" : found[0].format();
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(ModuleFiles, LinksTheModulesOfAFolder) {
  const auto found = check();
  ASSERT_THAT(found, testing::SizeIs(1));
  EXPECT_EQ(found[0].id, "Q101");
  EXPECT_EQ(found[0].line, 7);
}

TEST_F(ModuleFiles, ReportsMistakesOfTheGroupsFileWithTheirPath) {
  EXPECT_THAT(firstText(R"({"ray_generation": "b.rgen.spv"})"),
              HasSubstr("/ray_generation: no module is named 'b.rgen.spv'"));
  EXPECT_THAT(firstText(R"({"ray_generation": "a.rmiss.spv"})"),
              HasSubstr("/ray_generation: 'a.rmiss.spv' has no ray generation shader"));
}

TEST_F(ModuleFiles, ReportsMalformedModulesAndContinues) {
  std::ofstream(folder() / "b.spv", std::ios::binary) << std::string("\x03\x02\x23\x07\0\0\0\0", 8);
  const auto found = check();
  ASSERT_THAT(found, testing::SizeIs(2));
  EXPECT_THAT(found[0].format(), HasSubstr("b.spv: error: this is not a valid SPIR-V module"));
  EXPECT_EQ(found[1].id, "Q101");
}

TEST(ModuleFilesRequest, ReportsAFolderWithoutModules) {
  const TemporaryFolder folder;
  CheckObserver observer;
  const CheckReport report = checkModuleFiles({{folder.path().string()}, {}, {}}, observer);
  ASSERT_THAT(report.diagnostics(), testing::SizeIs(1));
  EXPECT_THAT(report.diagnostics()[0].text, HasSubstr("contains no SPIR-V file"));
}

// The shaders of public applications ($QUINTET_SHARED/data/applications) with the groups that their hosts make
// (tests/check/applications). expected.txt lists the diagnostics that are true. tests/reference/run sets the variable; without
// it, the test is skipped.
TEST(ApplicationShaders, GiveNoFalseReports) {
  const char* shared = std::getenv("QUINTET_SHARED");
  if (!shared) GTEST_SKIP() << "QUINTET_SHARED is not set";
  const fs::path data = fs::path(shared) / "data/applications";
  const fs::path descriptions = fs::path(QUINTET_SOURCE_ROOT) / "tests/check/applications";
  std::vector<std::string> expected, found;
  std::ifstream list(descriptions / "expected.txt");
  for (std::string line; std::getline(list, line);)
    if (!line.empty() && !line.starts_with('#')) expected.push_back(line.substr(0, line.find("  ")));
  std::size_t checked = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(descriptions)) {
    if (entry.path().extension() != ".json") continue;
    const std::string stem = entry.path().stem().string(), source = stem.substr(0, stem.find('.')),
                      sample = stem.substr(stem.find('.') + 1);
    const TemporaryFolder folder;
    std::string error;
    for (const fs::directory_entry& file : fs::recursive_directory_iterator(data / source / "shaders")) {
      const bool inSample = file.path().string().find("/" + sample + "/") != std::string::npos;
      if (!inSample || !file.is_regular_file() || !shader::stageOfFile(file.path())) continue;
      const auto words = compileRaw(file.path(), readTextFile(file.path()), error);
      writeModule(folder.path() / (file.path().filename().string() + ".spv"), words);
    }
    if (!error.empty()) {
      std::cout << "not compiled: " << error << '\n';
      continue;
    }
    ++checked;
    CheckObserver observer;
    for (const bool described : {true, false}) {
      const ModuleCheckRequest request{{folder.path().string()}, described ? entry.path() : fs::path(), {}};
      for (const Diagnostic& d : checkModuleFiles(request, observer).diagnostics()) {
        const std::string line =
            sample + " " + d.id + " " + fs::path(d.file).filename().string() + ":" + std::to_string(d.line);
        if (std::ranges::find(found, line) == found.end()) found.push_back(line);
        if (std::ranges::find(expected, line) == expected.end()) ADD_FAILURE() << line << ": " << d.text;
      }
    }
  }
  EXPECT_GE(checked, 10u);
  for (const std::string& line : expected)
    EXPECT_NE(std::ranges::find(found, line), found.end()) << line << " is not reported any more";
}

}  // namespace
}  // namespace quintet::job
