// SPDX-License-Identifier: Apache-2.0
// Mutations of the built-in programs: the check must find at least 95 % of the mistakes that text replacement creates.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "base/parallel.h"
#include "check/scene_facts.h"
#include "check_test_support.h"
#include "job/scene_source.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "temp_folder.h"

namespace quintet::check {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAll = ".*";
constexpr const char* kLecture = ".*\\.rt\\.glsl";
constexpr const char* kFolder = ".*\\.(rgen|rchit|rmiss|rahit|rint|rcall)";

// Replaces the first `limit` matches of `pattern`, one at a time, in files whose names match `file`. Any of `ids`
// must be reported.
struct Mutation {
  std::string ids;
  const char* file;
  const char* pattern;
  const char* replacement;
  int limit = 3;
};

// Matches the start of a trace up to the argument that follows.
#define ARGUMENTS "(traceRayEXT\\([^;]*?)"

const Mutation kMutations[] = {
    // Folder form.
    {"Q101", kFolder, "(layout\\(location = [0-9]\\)) rayPayloadInEXT (\\w+) (\\w+);",
     "struct QMutant { vec2 first; $2 inner; };\n$1 rayPayloadInEXT QMutant qMutant;\n#define $3 qMutant.inner\n"},
    {"Q102", kFolder, "layout\\(location = [0-9]\\) rayPayloadInEXT", "layout(location = 9) rayPayloadInEXT"},
    {"Q103", kFolder, "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q104", ".*\\.rmiss", "\n  \\w+\\.\\w+ = [^;]*;", "\n"},
    {"Q202", kFolder, "hitAttributeEXT vec2 (\\w+);", "hitAttributeEXT vec4 qMutant;\n#define $1 qMutant.xy\n"},
    {"Q204", ".*\\.rmiss", "\nvoid main", "\nhitAttributeEXT vec2 qMutant;\nvoid main"},
    {"Q712", ".*\\.toml", "\n\\[\\[output\\]\\]", "\n[[output]]\nname = \"mutant\"\n\n[[output]]", 1},
    {"Q714", kFolder, "storeOutput\\((\\w+), pixel, loadOutput\\(\\w+, pixel\\) \\+ ", "storeOutput($1, pixel, "},
    {"Q402", ".*\\.toml", "max_recursion = [0-9]+", ""},
    {"Q501", kFolder, ARGUMENTS "(kRay_\\w+), kRayTypeCount", "$1$2 + kRayTypeCount, kRayTypeCount"},
    {"Q502", kFolder, ARGUMENTS "(kMiss_\\w+)", "$1$2 + kMissCount"},
    {"Q503", kFolder, ARGUMENTS "kRayTypeCount", "$1kRayTypeCount + 16u"},
    {"Q504", kFolder, ARGUMENTS "(kMiss_\\w+)", "$1$2 + 0x10000u"},
    {"Q506 Q101", kFolder, ARGUMENTS "kMiss_shadow", "$010u"},
    {"Q601", ".*\\.toml", "intersection = \"[^\"]*\", ", ""},
    {"Q602", ".*\\.toml", "geometry = \"(solids|csg|custom)\"", "geometry = \"triangles\""},
    {"Q604 Q104", ".*\\.toml", "\\{ any_hit = \"[^\"]*\" \\}", "{ }"},
    {"Q705", kFolder, "offsetOrigin\\(surface, [^)]*\\)", "surface.position"},
    {"Q706", ".*\\.rgen", "void main\\(\\) \\{", "void main() {\n  const float qMutant = gl_HitTEXT;\n"},
    {"Q706", ".*\\.rmiss", "void main\\(\\) \\{", "void main() {\n  const int qMutant = gl_PrimitiveID;\n"},
    {"Q707", ".*\\.(rgen|rmiss|rchit)", "void main\\(\\) \\{",
     "#extension GL_EXT_debug_printf : require\nvoid main() { debugPrintfEXT(\"here: %d\");\n"},
    {"Q801", ".*\\.toml", "(description = \"Lesson[\\s\\S]*?)\n\\[\\[ray\\]\\]",
     "$1\n[[miss]]\nname = \"mutant\"\nfile = \"<quintet/stages/shadow.rmiss>\"\n\n[[ray]]"},
    {"Q802", ".*\\.toml", "\n\\[\\[output\\]\\]",
     "\n[[hit_group]]\nname = \"mutant\"\nmaterial = \"no such material\"\n\n[[output]]", 1},
    // Lecture form.
    {"Q010", kLecture, "RAY GENERATION SHADER", "CALLABLE SHADER"},
    {"Q011", kLecture, "/\\*\\*\\*\\* [A-Z-]+ SHADER \\*\\*\\*\\*/", ""},
    {"Q012", kLecture, "(RAY GENERATION|MISS|CLOSEST-HIT) SHADER", "MUTANT SHADER"},
    {"Q013", kLecture, "void main\\(\\) \\{ /\\*\\*\\*\\* MISS SHADER",
     "void main() { /**** MISS SHADER ****/ }\nvoid main() { /**** MISS SHADER"},
    {"Q014", kLecture, "\n\\}\n", "\n\n"},
    {"Q015", kLecture, "uniform (\\w+) (\\w+);", "uniform mat4 $2;"},
    {"Q104", kLecture, "(MISS SHADER \\*\\*\\*\\*/[^}]*?\n)  payload\\.\\w+ = [^;]*;", "$1"},
    {"Q204", kLecture, "MISS SHADER \\*\\*\\*\\*/", "MISS SHADER ****/ vec2 qMutant = baryCoord;"},
    {"Q205", kLecture, "\n  hit\\.\\w+ = [^;]*;", ""},
    {"Q206", kLecture, "\n  reportIntersectionEXT\\([^;]*\\);", ""},
    {"Q304", kLecture, "callableData\\.(\\w+) = ", "vec3 qMutant_$1 = "},
    {"Q606", kLecture, "if \\([^;]*\\) ignoreIntersectionEXT", "ignoreIntersectionEXT"},
    {"Q712", kLecture, "gsnSetPixel\\([^;]*\\);", ""},
    {"Q302", kLecture, "executeCallableEXT\\([^;]*, 0\\)", "executeCallableEXT(100u, 0)"},
    {"Q401", kLecture, ", recursion: [0-9]+", ""},
    {"Q501", kLecture, ARGUMENTS "0u, 0u, 0u,", "$012u, 0u, 0u,"},
    {"Q502", kLecture, ARGUMENTS "0u, 0u, 0u,", "$010u, 0u, 3u,"},
    {"Q503", kLecture, ARGUMENTS "0u, 0u, 0u,", "$010u, 16u, 0u,"},
    {"Q504", kLecture, ARGUMENTS "0u, 0u, 0u,", "$010u, 0u, 0x10000u,"},
    {"Q701", kLecture, " d = gl_ObjectRayDirectionEXT", " d = normalize(gl_ObjectRayDirectionEXT)"},
    {"Q702", kLecture, "gsnGetNormal3x3Matrix\\(gl_InstanceID, normalMatrix\\);",
     "normalMatrix = mat3(gl_ObjectToWorldEXT);"},
    {"Q705", kLecture, " \\+ 0\\.001 \\* (normal|side), 0\\.0", ", 0.0"},
    {"Q717", kLecture, "origin, 0\\.0, direction,", "origin, 0.0, 2.0 * direction,"},
    {"Q718", kLecture, "frameID \\* samples \\+ s", "s"},
    {"Q719", kLecture, "payload\\.t = -1\\.0;", "payload.t = gl_RayTmaxEXT;"},
    {"Q706", kLecture, "RAY GENERATION SHADER \\*\\*\\*\\*/",
     "RAY GENERATION SHADER ****/ float qMutant = gl_HitTEXT;"},
    {"Q706", kLecture, "MISS SHADER \\*\\*\\*\\*/", "MISS SHADER ****/ int qMutant = gl_PrimitiveID;"},
    // Both.
    {"Q505", kAll, ARGUMENTS "0xFFu", "$010x1FFu"},
    {"Q605", kAll, ARGUMENTS "gl_RayFlags(None|Opaque)EXT", "$1gl_RayFlagsCullOpaqueEXT | gl_RayFlagsCullNoOpaqueEXT"},
};

std::string readText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Shipped {
  std::string name;
  Files files;
  std::string lecture;  // the file of the lecture form; empty for a program.toml
};

std::vector<Shipped> shippedPrograms() {
  const fs::path root = fs::path(QUINTET_SOURCE_ROOT) / "programs";
  std::map<std::string, Shipped> byFolder;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file()) continue;
    const std::string folder = fs::relative(entry.path().parent_path(), root), file = entry.path().filename();
    Shipped& shipped = byFolder[folder];
    shipped.name = folder;
    shipped.files[file] = readText(entry.path());
    if (file.ends_with(program::kLectureExtension)) shipped.lecture = file;
  }
  std::vector<Shipped> result;
  for (auto& [folder, shipped] : byFolder) result.push_back(std::move(shipped));
  return result;
}

program::Program parse(const Shipped& shipped, const Files& files) {
  const std::string origin = "<programs/" + shipped.name + ">";
  if (shipped.lecture.empty()) return program::parseProgram(files.at("program.toml"), shipped.name, origin, files);
  Files others = files;
  others.erase(shipped.lecture);
  return program::parseLecture(files.at(shipped.lecture), shipped.lecture, origin, others);
}

struct Mutant {
  const Mutation* mutation;
  std::string location;  // "program file: matched text"
  Files files;
};

std::vector<Mutant> mutantsOf(const Shipped& shipped) {
  std::vector<Mutant> mutants;
  for (const Mutation& mutation : kMutations) {
    int count = 0;
    const std::regex pattern(mutation.pattern), name(mutation.file);
    for (const auto& [file, text] : shipped.files) {
      if (!std::regex_match(file, name)) continue;
      for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end && count < mutation.limit;
           ++i, ++count) {
        const auto at = static_cast<std::size_t>(i->position()), length = static_cast<std::size_t>(i->length());
        Mutant mutant{&mutation, fmt::format("{} {}: {}", shipped.name, file, i->str().substr(0, 70)), shipped.files};
        mutant.files[file] = text.substr(0, at) + i->format(mutation.replacement) + text.substr(at + length);
        mutants.push_back(std::move(mutant));
      }
    }
  }
  return mutants;
}

// Returns the diagnostics of a mutant, one per line.
std::string checkMutant(const Shipped& shipped, const Files& files, const program::SceneFacts& scene,
                        const shader::Compiler& compiler) {
  try {
    return textOf(check(parse(shipped, files), compiler, &scene, {}));
  } catch (const FileError& error) {
    return std::string("rejected: ") + error.what();
  }
}

bool isCaught(const Mutation& mutation, const std::string& text) {
  if (text.starts_with("rejected")) return true;
  std::istringstream ids(mutation.ids);
  for (std::string id; ids >> id;)
    if (text.starts_with(id + " ") || text.find("\n" + id + " ") != std::string::npos) return true;
  return false;
}

TEST(Mutation, FindsMistakesInBuiltInPrograms) {
  const test::TempFolder cache;  // unchanged stages are compiled once
  const shader::Compiler compiler([&] {
    shader::CompilerOptions options;
    options.debugInfo = true;
    options.cacheFolder = cache.path();
    return options;
  }());
  std::size_t caught = 0, total = 0;
  std::string survivors;
  for (const Shipped& shipped : shippedPrograms()) {
    const program::Program program = parse(shipped, shipped.files);
    // Lessons use their own scenes, the others a scene with stone and leaves.
    const program::SceneFacts scene = program.scene.empty()
                                          ? sceneWith({{program::GeometryKind::triangles, false, "mesh", "stone"},
                                                       {program::GeometryKind::triangles, true, "mesh", "leaf"}})
                                          : check::sceneFacts(job::loadScene(job::chooseSceneSource({}, program)));
    const std::vector<Mutant> mutants = mutantsOf(shipped);
    std::vector<std::string> texts(mutants.size());
    parallelFor(mutants.size(),
                [&](std::size_t i) { texts[i] = checkMutant(shipped, mutants[i].files, scene, compiler); });
    for (std::size_t i = 0; i < mutants.size(); ++i) {
      ++total;
      if (isCaught(*mutants[i].mutation, texts[i]))
        ++caught;
      else
        survivors += fmt::format("{} {}\n    {}\n", mutants[i].mutation->ids, mutants[i].location, texts[i]);
    }
  }
  RecordProperty("mutants", static_cast<int>(total));
  RecordProperty("caught", static_cast<int>(caught));
  EXPECT_GT(total, 300u);
  EXPECT_GE(static_cast<double>(caught), 0.95 * static_cast<double>(total)) << survivors;
}

}  // namespace
}  // namespace quintet::check
