#include "program/lecture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>

#include "program/glsl_names.h"
#include "program/lecture_stage.h"
#include "shader/include_resolver.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;
using shader::Stage;

constexpr std::size_t kMaxBytes = kMaxLectureBytes;
constexpr const char* kRay = "ray";
constexpr std::array<std::string_view, 3> kUserTypes{"RayPayloadType", "HitAttributeType", "CallableDataType"};

// A name that can stand in #line "…".
std::string quotable(std::string name) {
  for (char& c : name)
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  return name;
}

// Beside the program's text lie scenes and pictures, too.
bool isShaderText(const std::string& name, const std::string& text) {
  return !name.ends_with(".toml") && text.size() <= kMaxBytes && text.find('\0') == text.npos;
}

bool definesType(const LectureText& source, std::string_view name) {
  for (std::size_t i = 0; i < source.tokens.size(); ++i) {
    const Token& token = source.tokens[i];
    if (token.dead || token.kind != TokenKind::word || textOf(source.text, token) != "struct") continue;
    const std::size_t next = nextCode(source.tokens, i + 1);
    if (next < source.tokens.size() && textOf(source.text, source.tokens[next]) == name) return true;
  }
  return source.declares(name);
}

class Builder {
 public:
  Builder(Program& program, const std::string& text) : program_(program), errors_(text, source_.file) {
    source_.text = text;
  }

  void build(const std::string& file) {
    source_.file = quotable(program_.path(file));
    errors_ = LectureErrors(source_.text, program_.path(file));
    source_.tokens = tokenize(source_.text);
    source_.split = splitLecture(source_.text, source_.tokens, errors_);
    source_.unused = unusedFunctions(source_.text, source_.tokens, source_.split);
    source_.uniforms = findUniforms(source_.text, source_.tokens, errors_);
    lookIntoIncludes();
    findImplicitNames();
    addParameters();
    const auto has = [&](Stage stage) {
      return std::ranges::find(source_.split.mains, stage, &LectureMain::stage) != source_.split.mains.end();
    };
    source_.hasAnyHit = has(Stage::anyHit);
    source_.hasIntersection = has(Stage::intersection);
    program_.diagnostics = errors_.all();
    if (program_.diagnostics.empty()) addStages(file);
  }

 private:
  // What included files tell: types of the user's, names, and whether the library is wanted.
  void lookIntoIncludes() {
    for (const auto& [name, text] : program_.files)
      if (isShaderText(name, text)) includes_.push_back({text, tokenize(text)});
    for (std::size_t i = 0; i < source_.tokens.size(); ++i) {
      const Token& token = source_.tokens[i];
      if (token.kind != TokenKind::directive || token.dead) continue;
      const std::string_view line = textOf(source_.text, token);
      if (directiveOf(line).name != "include") continue;
      for (const std::string_view type : kUserTypes)
        if (std::ranges::any_of(reachable(std::string(line)),
                                [&](const LectureText* text) { return definesType(*text, type); }))
          source_.includedTypes.emplace_back(i, type);
    }
    source_.opensLibrary = includesLibrary(source_.text) ||
                           std::ranges::any_of(includes_, [](const LectureText& t) { return includesLibrary(t.text); });
  }

  static bool includesLibrary(std::string_view text) {
    return std::ranges::any_of(shader::findIncludes(text), [](const shader::IncludeDirective& include) {
      return include.name.starts_with("quintet/");
    });
  }

  // The included files that the text's includes lead to.
  std::vector<const LectureText*> reachable(const std::string& line) const {
    std::vector<const LectureText*> found;
    std::deque<std::string_view> open{line};
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
    source_.givesPi = words.count("PI") > 0 && !isDeclared("PI");
  }

  void addParameters() {
    std::vector<const LectureUniform*> taken;
    const auto add = [&](const LectureUniform& uniform) {
      const std::string& name = uniform.parameter.name;
      if (isLectureName(name)) return;
      if (!isIdentifier(name) || isReservedWord(name)) {
        errors_.add("Q015", uniform.begin, fmt::format("'{}' cannot be the name of a uniform", name));
        return;
      }
      for (const LectureUniform* other : taken) {
        if (other->parameter.name != name) continue;
        if (other->parameter.type != uniform.parameter.type)
          errors_.add("Q015", uniform.begin, fmt::format("the uniform '{}' is there twice, with two types", name));
        return;
      }
      const std::string& image = uniform.parameter.defaultImage;
      if (!image.empty() && !program_.files.count(image)) {
        errors_.add("Q015", uniform.begin,
                    fmt::format("there is no file '{}' beside {}", image, program_.descriptionFile));
        return;
      }
      taken.push_back(&uniform);
      program_.parameters.push_back(uniform.parameter);
    };
    for (const LectureUniform& uniform : source_.uniforms) add(uniform);
    for (const LectureUniform& uniform : source_.implicit) add(uniform);
  }

  std::string addFile(const std::string& name, std::string text) {
    program_.files[name] = std::move(text);
    return name;
  }

  // "recursion: N" of // gsnShaderOptions: the bound of programs whose hit or miss shaders trace rays that come back to
  // them. What follows from the shaders themselves is derived (check.h).
  std::optional<std::uint32_t> recursion() const {
    constexpr std::string_view kOptions = "gsnShaderOptions", kRecursion = "recursion:";
    const auto traces = [&](const LectureMain& main) {
      const std::string_view body = source_.text.substr(main.begin, main.end - main.begin);
      return main.stage != Stage::rayGeneration && body.find("traceRayEXT") != body.npos;
    };
    if (std::ranges::none_of(source_.split.mains, traces)) return {};
    for (const Token& token : source_.tokens) {
      if (token.kind != TokenKind::comment) continue;
      const std::string_view comment = textOf(source_.text, token);
      const std::size_t at = comment.find(kOptions) == comment.npos ? comment.npos : comment.find(kRecursion);
      if (at == comment.npos) continue;
      const int depth = std::atoi(std::string(comment.substr(at + kRecursion.size(), 8)).c_str());
      return static_cast<std::uint32_t>(std::clamp(depth, 2, 31));
    }
    return {};
  }

  void addStages(const std::string& file) {
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
        return addFile(file + variant + extension, lectureStage(source_, i, forBoxes));
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
        case Stage::compute: break;
      }
    }
    if (ray.miss.empty())
      ray.miss = addFile(file + std::string(kStubMissExtension),
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
  LectureSource source_;
  LectureErrors errors_;
  std::vector<LectureText> includes_;
};

// What a comment "// scene: FILE" says, if the file is there.
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

// The first sentence of the comment at the beginning: "Lesson 05: shadow." of "// Lesson 05: shadow. At each …"
std::string descriptionOf(const std::string& text) {
  std::string words;
  for (const Token& token : tokenize(text)) {
    if (token.kind != TokenKind::comment) break;
    std::string_view comment = textOf(text, token);
    if (comment.find("gsnShaderOptions") != comment.npos) continue;
    if (!comment.starts_with("//") || comment.find("scene:") != comment.npos) break;
    comment.remove_prefix(std::min(comment.size(), std::size_t{3}));
    words.append(words.empty() ? "" : " ").append(comment);
  }
  std::size_t end = words.find(". ");
  // "Lesson 05: shadow. At each surface …": a title of few words takes the sentence after it along.
  if (end != words.npos && end < 40) end = words.find(". ", end + 1);
  return words.substr(0, end);
}

}  // namespace

Program parseLecture(const std::string& text, const std::string& file, const std::string& origin,
                     std::map<std::string, std::string> included) {
  Program program;
  program.name = file.ends_with(kLectureExtension) ? file.substr(0, file.size() - kLectureExtension.size()) : file;
  program.origin = origin;
  program.description = descriptionOf(text);
  program.accumulation = Accumulation::program;
  program.descriptionFile = file;
  program.outputs = {{.name = "picture", .kind = OutputKind::display, .help = "what gsnSetPixel writes"}};
  program.files = std::move(included);
  const std::string body = text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
  if (body.size() > kMaxBytes) {
    program.diagnostics.push_back(
        {shader::Severity::error, program.path(file), 0, 0, "Q016", "the file is larger than 1 MiB"});
  } else {
    Builder(program, body).build(file);
  }
  program.files[file] = body;
  program.scene = sceneNamedIn(body, program.files);
  if (const std::string own = program.name + ".scene.toml"; program.scene.empty() && program.files.count(own))
    program.scene = own;
  chooseDefaultScene(program);
  return program;
}

}  // namespace quintet::program
