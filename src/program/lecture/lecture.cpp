// SPDX-License-Identifier: Apache-2.0
#include "program/lecture/lecture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <deque>
#include <filesystem>

#include "program/description/generated_glsl.h"
#include "program/lecture/stage.h"
#include "shader/include_resolver.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;
using shader::Stage;

constexpr const char* kRay = "ray";
constexpr std::array<std::string_view, 3> kUserTypes{"RayPayloadType", "HitAttributeType", "CallableDataType"};

// Returns the name with the characters replaced that #line "…" does not allow.
std::string quotable(std::string name) {
  for (char& c : name)
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  return name;
}

// Returns whether a file of the program is GLSL rather than a scene or an image.
bool isShaderText(const std::string& name, const std::string& text) {
  return !name.ends_with(".toml") && text.size() <= kMaxLectureBytes && text.find('\0') == text.npos;
}

// Builds a Program from the text of a lecture-form file.
class Builder {
 public:
  // `text` must outlive this object.
  Builder(Program& program, const std::string& text, const std::string& file)
      : program_(program), file_(file), source_(text), errors_(text, program.path(file)) {}

  void build() {
    source_.file = quotable(program_.path(file_));
    source_.split = splitLecture(source_, errors_);
    source_.uniforms = findUniforms(source_, errors_);
    readIncludes();
    findImplicitNames();
    addParameters();
    const auto has = [&](Stage stage) {
      return std::ranges::find(source_.split.mains, stage, &LectureMain::stage) != source_.split.mains.end();
    };
    source_.hasAnyHit = has(Stage::anyHit);
    source_.hasIntersection = has(Stage::intersection);
    program_.diagnostics = errors_.all();
    if (program_.diagnostics.empty()) addStages();
  }

 private:
  // Finds what included files contribute: types of the user, names, and whether the program uses the library.
  void readIncludes() {
    for (const auto& [name, text] : program_.files)
      if (isShaderText(name, text)) includes_.emplace_back(text);
    for (std::size_t i = 0; i < source_.tokens.size(); ++i) {
      const Token& token = source_.tokens[i];
      if (token.kind != TokenKind::directive || token.inactive) continue;
      const std::string_view line = source_.textOf(i);
      if (directiveOf(line).name != "include") continue;
      for (const std::string_view type : kUserTypes)
        if (std::ranges::any_of(reachable(line), [&](const LectureText* text) { return text->definesType(type); }))
          source_.includedTypes.emplace_back(i, type);
    }
    source_.includesLibrary = includesLibrary(source_.text) || std::ranges::any_of(includes_, [](const LectureText& t) {
                                return includesLibrary(t.text);
                              });
  }

  static bool includesLibrary(std::string_view text) {
    return std::ranges::any_of(shader::findIncludes(text), [](const shader::IncludeDirective& include) {
      return include.name.starts_with("quintet/");
    });
  }

  // Returns the files that the text includes, directly or indirectly.
  std::vector<const LectureText*> reachable(std::string_view including) const {
    std::vector<const LectureText*> found;
    std::deque<std::string_view> open{including};
    while (!open.empty()) {
      const std::string_view text = open.front();
      open.pop_front();
      for (const shader::IncludeDirective& include : shader::findIncludes(text)) {
        const auto file = program_.files.find(fs::path(include.name).lexically_normal().generic_string());
        if (file == program_.files.end()) continue;
        const auto known =
            std::ranges::find_if(includes_, [&](const LectureText& t) { return t.text.data() == file->second.data(); });
        if (known == includes_.end() || std::ranges::find(found, &*known) != found.end()) continue;
        found.push_back(&*known);
        open.push_back(known->text);
      }
    }
    return found;
  }

  bool isDeclared(std::string_view name) const {
    return source_.declares(name) ||
           std::ranges::any_of(includes_, [&](const LectureText& t) { return t.declares(name); });
  }

  void findImplicitNames() {
    std::set<std::string_view> words = source_.words();
    for (const LectureText& include : includes_) words.merge(include.words());
    for (const std::string_view word : words)
      if (const auto uniform = implicitUniform(word); uniform && !isDeclared(word))
        source_.implicit.push_back(*uniform);
    source_.declaresPi = words.count("PI") > 0 && !isDeclared("PI");
  }

  void addParameters() {
    for (const LectureUniform& uniform : source_.uniforms) addParameter(uniform);
    for (const LectureUniform& uniform : source_.implicit) addParameter(uniform);
  }

  void addParameter(const LectureUniform& uniform) {
    const std::string& name = uniform.parameter.name;
    if (isPredeclared(name)) return;
    if (!isIdentifier(name) || isReservedWord(name)) {
      errors_.add("Q015", uniform.begin, fmt::format("a uniform cannot have the name '{}'", name));
      return;
    }
    const auto known = std::ranges::find(program_.parameters, name, &Parameter::name);
    if (known != program_.parameters.end()) {
      if (known->type != uniform.parameter.type)
        errors_.add("Q015", uniform.begin, fmt::format("uniform '{}' is declared twice with different types", name));
      return;
    }
    const std::string& image = uniform.parameter.defaultImage;
    if (!image.empty() && !program_.files.count(image)) {
      errors_.add("Q015", uniform.begin, fmt::format("file '{}' not found next to {}", image, file_));
      return;
    }
    program_.parameters.push_back(uniform.parameter);
  }

  std::string addFile(const std::string& name, std::string text) {
    program_.files[name] = std::move(text);
    return name;
  }

  // Returns "recursion: N" of a comment "// gsnShaderOptions": the bound for programs whose hit or miss shaders trace rays
  // that can reach them again. The check derives the depth of all other programs (check/check.h).
  std::optional<std::uint32_t> recursion() const {
    constexpr std::string_view kOptions = "gsnShaderOptions", kRecursion = "recursion:";
    const auto traces = [&](const LectureMain& main) {
      const std::string_view body = source_.text.substr(main.begin, main.end - main.begin);
      return main.stage != Stage::rayGeneration && body.find("traceRayEXT") != body.npos;
    };
    if (std::ranges::none_of(source_.split.mains, traces)) return {};
    for (std::size_t i = 0; i < source_.tokens.size(); ++i) {
      if (source_.tokens[i].kind != TokenKind::comment) continue;
      const std::string_view comment = source_.textOf(i);
      const std::size_t at = comment.find(kOptions) == comment.npos ? comment.npos : comment.find(kRecursion);
      if (at == comment.npos) continue;
      const int depth = std::atoi(std::string(comment.substr(at + kRecursion.size(), 8)).c_str());
      return static_cast<std::uint32_t>(std::clamp(depth, 2, 31));
    }
    return {};
  }

  void addStages() {
    program_.declaredRecursion = recursion();
    RayType ray;
    ray.name = kRay;
    HitShaders triangles, boxes;
    const auto& mains = source_.split.mains;
    std::size_t callables = 0;
    for (std::size_t i = 0; i < mains.size(); ++i) {
      const Stage stage = mains[i].stage;
      const std::string extension(shader::stageExtension(stage));
      const auto add = [&](const std::string& variant, bool forBoxes) {
        return addFile(file_ + variant + extension, lectureStage(source_, i, forBoxes));
      };
      switch (stage) {
        case Stage::rayGeneration: program_.rayGeneration = add("", false); break;
        case Stage::miss: ray.miss = add("", false); break;
        case Stage::intersection: boxes.intersection = add("", true); break;
        case Stage::closestHit:
          triangles.closestHit = add(".triangles", false);
          boxes.closestHit = add(".boxes", true);
          break;
        case Stage::anyHit:
          program_.anyHitForAll = true;
          triangles.anyHit = add(".triangles", false);
          boxes.anyHit = add(".boxes", true);
          break;
        case Stage::callable:
          program_.callables.push_back({"", add(fmt::format(".{}", callables++), false), {}, 0});
          break;
        case Stage::compute:
        case Stage::vertex:
        case Stage::fragment: break;
      }
    }
    if (ray.miss.empty())
      ray.miss = addFile(file_ + std::string(kStubMissExtension),
                         "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n");
    program_.rays = {ray};
    HitGroup& first = program_.hitGroups.emplace_back();
    first.name = "triangles";
    first.geometry = {first.name};
    first.shaders[kRay] = triangles;
    if (boxes.intersection.empty()) return;
    HitGroup& second = program_.hitGroups.emplace_back();
    second.name = "procedural";
    second.geometry = {second.name};
    second.shaders[kRay] = boxes;
  }

  Program& program_;
  const std::string& file_;
  LectureSource source_;
  LectureErrors errors_;
  std::vector<LectureText> includes_;
};

// Returns the file that a comment "// scene: FILE" names, if it is among `files`.
std::string sceneNamedIn(const std::string& text, const std::map<std::string, std::string>& files) {
  constexpr std::string_view kScene = "scene:";
  for (const Token& token : tokenize(text)) {
    if (token.kind != TokenKind::comment) continue;
    std::string_view words = textOf(text, token).substr(2);
    words.remove_prefix(std::min(words.find_first_not_of(" \t*"), words.size()));
    if (!words.starts_with(kScene)) continue;
    words.remove_prefix(kScene.size());
    words.remove_prefix(std::min(words.find_first_not_of(" \t"), words.size()));
    const std::string name(words.substr(0, words.find_first_of(" \t\r\n*")));
    if (files.count(name)) return name;
  }
  return {};
}

// Returns the first sentence of the comment at the start of the file, after its license, without its period. A title of less than 40
// characters, such as "Lesson 05: shadow", includes the sentence after it.
std::string descriptionOf(const std::string& text) {
  std::string words;
  for (const Token& token : tokenize(text)) {
    if (token.kind != TokenKind::comment) break;
    std::string_view comment = textOf(text, token);
    if (comment.find("gsnShaderOptions") != comment.npos) continue;
    if (comment.find("SPDX-License-Identifier") != comment.npos) continue;
    if (!comment.starts_with("//") || comment.find("scene:") != comment.npos) break;
    comment.remove_prefix(std::min(comment.find_first_not_of("/ \t"), comment.size()));
    words.append(words.empty() ? "" : " ").append(comment);
  }
  std::size_t end = words.find(". ");
  if (end != words.npos && end < 40) end = words.find(". ", end + 1);
  return words.substr(0, end);
}

}  // namespace

Program parseLecture(const std::string& text, const std::string& file, const std::string& origin,
                     std::map<std::string, std::string> siblings) {
  Program program;
  program.name = file.ends_with(kLectureExtension) ? file.substr(0, file.size() - kLectureExtension.size()) : file;
  program.origin = origin;
  program.description = descriptionOf(text);
  program.accumulation = Accumulation::program;
  program.descriptionFile = file;
  program.outputs = {{.name = "image", .kind = OutputKind::display, .help = "Value that gsnSetPixel writes"}};
  program.files = std::move(siblings);
  const std::string body = text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
  if (body.size() > kMaxLectureBytes) {
    program.diagnostics.push_back({Severity::error, program.path(file), 0, 0, "Q016", "the file is larger than 1 MiB"});
  } else {
    Builder(program, body, file).build();
  }
  program.files[file] = body;
  program.scene = sceneNamedIn(body, program.files);
  if (const std::string own = program.name + ".scene.toml"; program.scene.empty() && program.files.count(own))
    program.scene = own;
  chooseDefaultScene(program);
  return program;
}

void explainLectureNames(std::vector<Diagnostic>& diagnostics, shader::Stage stage) {
  if (stage != Stage::rayGeneration && stage != Stage::miss && stage != Stage::callable) return;
  for (Diagnostic& d : diagnostics) {
    for (const std::string_view name : {"hit", "baryCoord"}) {
      if (d.text != fmt::format("'{}' : undeclared identifier", name)) continue;
      d.id = "Q204";
      d.text = fmt::format(
          "'{}' is not available in a {} shader: only intersection, any-hit and closest-hit shaders have a hit", name,
          shader::stageName(stage));
    }
  }
}

}  // namespace quintet::program
