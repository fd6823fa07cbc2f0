// SPDX-License-Identifier: Apache-2.0
#include "program/lecture/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace quintet::program {
namespace {

using shader::Stage;

constexpr std::size_t kMaxExtensions = 64;
constexpr std::string_view kPi = "const float PI = 3.14159265358979323846;\n";

bool isConditional(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames{"if", "ifdef", "ifndef", "elif", "else", "endif"};
  return std::ranges::find(kNames, name) != kNames.end();
}

// A text that keeps its line breaks while parts of it are blanked and words are inserted.
class Patch {
 public:
  explicit Patch(std::string_view text) : text_(text) {}
  void blank(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < std::min(end, text_.size()); ++i)
      if (text_[i] != '\n' && text_[i] != '\r') text_[i] = ' ';
  }
  void restore(std::string_view original, std::size_t begin, std::size_t end) {
    text_.replace(begin, end - begin, original.substr(begin, end - begin));
  }
  void insert(std::size_t at, std::string words) { insertions_.emplace_back(at, std::move(words)); }
  std::string finish() {
    std::ranges::stable_sort(insertions_, {}, [](const auto& entry) { return entry.first; });
    std::string result;
    std::size_t done = 0;
    for (const auto& [at, words] : insertions_) {
      result.append(text_, done, at - done).append(words);
      done = at;
    }
    return result.append(text_, done);
  }

 private:
  std::string text_;
  std::vector<std::pair<std::size_t, std::string>> insertions_;
};

class StageWriter {
 public:
  StageWriter(const LectureSource& source, std::size_t main, bool boxes)
      : s_(source),
        index_(static_cast<int>(main)),
        main_(source.split.mains[main]),
        boxes_(boxes),
        patch_(source.text) {}

  std::string write() {
    blankOthers();
    moveDirectives();
    for (const LectureUniform& uniform : s_.uniforms) patch_.blank(uniform.begin, uniform.end);
    declareTypes();
    if (main_.stage == Stage::intersection && hasHitAttribute_)
      macros_ = "#undef reportIntersectionEXT\n#define reportIntersectionEXT(t, kind) gsnReport_(t, kind)\n";
    patch_.insert(main_.body, " gsnBegin_();");
    return prelude() + fmt::format("#line 1 \"{}\"\n", s_.file) + patch_.finish() + "\n";
  }

 private:
  bool kept(std::size_t offset) const {
    const int owner = s_.split.ownerOf(offset);
    return owner == kCommonText || owner == index_;
  }
  bool isHit() const { return main_.stage == Stage::closestHit || main_.stage == Stage::anyHit; }
  bool traces() const {
    return main_.stage == Stage::rayGeneration || main_.stage == Stage::closestHit || main_.stage == Stage::miss;
  }

  void blankOthers() {
    for (const LectureRegion& region : s_.split.regions)
      if (region.owner != kCommonText && region.owner != index_) patch_.blank(region.begin, region.end);
    restoreConditionals();
    for (const auto& [begin, end] : s_.split.unusedFunctions[static_cast<std::size_t>(index_)]) {
      patch_.blank(begin, end);
      for (auto at = std::ranges::lower_bound(s_.tokens, begin, {}, &Token::begin);
           at != s_.tokens.end() && at->begin < end; ++at)
        if (at->kind == TokenKind::directive && isConditional(directiveOf(textOf(s_.text, *at)).name))
          patch_.restore(s_.text, at->begin, at->end);
    }
  }

  // Restores conditionals that span several regions, so that #if and #endif match.
  void restoreConditionals() {
    std::vector<std::vector<std::size_t>> open;
    const auto close = [&](const std::vector<std::size_t>& group) {
      const auto region = [&](std::size_t token) {
        return std::ranges::upper_bound(s_.split.regions, s_.tokens[token].begin, {}, &LectureRegion::begin);
      };
      if (std::ranges::all_of(group, [&](std::size_t token) { return region(token) == region(group.front()); })) return;
      for (const std::size_t token : group) patch_.restore(s_.text, s_.tokens[token].begin, s_.tokens[token].end);
    };
    for (std::size_t i = 0; i < s_.tokens.size(); ++i) {
      if (s_.tokens[i].kind != TokenKind::directive) continue;
      const std::string_view name = directiveOf(s_.textOf(i)).name;
      if (!isConditional(name)) continue;
      if (name.starts_with("if")) open.emplace_back();
      if (open.empty()) continue;
      open.back().push_back(i);
      if (name != "endif") continue;
      close(open.back());
      open.pop_back();
    }
  }

  // Removes #version, which the prelude has, and moves #extension lines before everything else, as GLSL requires.
  void moveDirectives() {
    for (const Token& token : s_.tokens) {
      if (token.kind != TokenKind::directive || !kept(token.begin)) continue;
      const std::string_view line = textOf(s_.text, token);
      const std::string_view name = directiveOf(line).name;
      if (name != "version" && name != "extension") continue;
      if (name == "extension" && !token.inactive && line.find('\n') == line.npos && extensionCount_++ < kMaxExtensions)
        extensions_ += fmt::format("#line {} \"{}\"\n{}\n", positionOf(s_.text, token.begin).line, s_.file, line);
      patch_.blank(token.begin, token.end);
    }
  }

  // Declares `payload`, `hit` and `callableData` after each definition of their types, in the same line.
  void declareTypes() {
    for (const auto& [type, words] : {std::pair<std::string_view, std::string>{"RayPayloadType", payload()},
                                      {"HitAttributeType", hitAttribute()},
                                      {"CallableDataType", callableData()}}) {
      if (words.empty()) continue;
      std::vector<std::size_t> offsets = definitions(type);
      for (const auto& [token, name] : s_.includedTypes)
        if (name == type && kept(s_.tokens[token].begin)) offsets.push_back(nextLine(s_.tokens[token].end));
      for (const std::size_t offset : offsets) patch_.insert(offset, words);
      if (type == "HitAttributeType") hasHitAttribute_ = !offsets.empty();
    }
  }

  std::size_t nextLine(std::size_t offset) const {
    const std::size_t newline = s_.text.find('\n', offset);
    return newline == s_.text.npos ? s_.text.size() : newline + 1;
  }

  // Returns the offsets after "struct NAME { … };" and after the line "#define NAME …".
  std::vector<std::size_t> definitions(std::string_view name) const {
    std::vector<std::size_t> result;
    const auto& tokens = s_.tokens;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      if (tokens[i].inactive || !kept(tokens[i].begin)) continue;
      if (tokens[i].kind == TokenKind::directive) {
        const Directive line = directiveOf(s_.textOf(i));
        if (line.name != "define" || !line.rest.starts_with(name)) continue;
        const std::string_view rest = line.rest.substr(name.size());
        if (!rest.empty() && (rest[0] == ' ' || rest[0] == '\t')) result.push_back(nextLine(tokens[i].end));
      } else if (tokens[i].braces == 0 && s_.isWord(i, "struct")) {
        std::size_t at = s_.nextCode(i + 1);
        if (at == tokens.size() || s_.textOf(at) != name) continue;
        while (at < tokens.size() && !(s_.textOf(at) == ";" && tokens[at].braces == 0)) at = s_.nextCode(at + 1);
        if (at == tokens.size()) break;
        result.push_back(tokens[at].end);
      }
    }
    return result;
  }

  std::string payload() const {
    switch (main_.stage) {
      case Stage::rayGeneration: return " layout(location = 0) rayPayloadEXT RayPayloadType payload;";
      case Stage::closestHit:
      case Stage::anyHit:
      case Stage::miss: return " layout(location = 0) rayPayloadInEXT RayPayloadType payload;";
      default: return {};
    }
  }

  // In an intersection shader, `hit` becomes the attribute only with the report, and on drivers where a rejected report
  // overwrites the attribute of the closest hit so far (docs/design/quirks.md), only if the report is accepted.
  std::string hitAttribute() const {
    if (main_.stage == Stage::intersection)
      return " HitAttributeType hit = {}; hitAttributeEXT HitAttributeType gsnHitAttribute_;"
             " bool gsnReport_(float t, uint hitKind) {"
             " if (!gsnCorruptsAttributes_) { gsnHitAttribute_ = hit; return gsnReportRaw_(t, hitKind); }"
             " if (!gsnInRange_(t)) return false;"
             " const HitAttributeType old = gsnHitAttribute_; gsnHitAttribute_ = hit;"
             " const bool accepted = gsnReportRaw_(t, hitKind);"
             " if (accepted) gsnNearest_ = t; else gsnHitAttribute_ = old;"
             " return accepted; }";
    if (!isHit()) return {};
    return boxes_ ? " hitAttributeEXT HitAttributeType hit;" : " HitAttributeType hit = {};";
  }

  std::string callableData() const {
    if (main_.stage == Stage::callable) return " layout(location = 0) callableDataInEXT CallableDataType callableData;";
    return traces() ? " layout(location = 0) callableDataEXT CallableDataType callableData;" : "";
  }

  std::string prelude() const {
    std::string text =
        "#version 460\n"
        "#extension GL_EXT_ray_tracing : require\n"
        "#extension GL_EXT_ray_flags_primitive_culling : require\n"
        "#extension GL_EXT_null_initializer : require\n"
        "#extension GL_GOOGLE_cpp_style_line_directive : require\n" +
        extensions_;
    for (const auto& [name, wanted] : {std::pair<std::string_view, bool>{"OPEN", s_.includesLibrary},
                                       {"TRACES", traces()},
                                       {"HIT", isHit() || main_.stage == Stage::intersection},
                                       {"CANDIDATES", s_.hasAnyHit || s_.hasIntersection},
                                       {"TRIANGLES", isHit() && !boxes_},
                                       {"RAY_GENERATION", main_.stage == Stage::rayGeneration},
                                       {"CLOSEST_HIT", main_.stage == Stage::closestHit},
                                       {"INTERSECTION", main_.stage == Stage::intersection}})
      if (wanted) text += fmt::format("#define QUINTET_GSN_{} 1\n", name);
    text += "#include <quintet/gsn.glsl>\n#include <quintet/generated/program.glsl>\n";
    return text + inputs();
  }

  // Declares uniforms and predeclared inputs as variables, which gsnBegin_ fills.
  std::string inputs() const {
    std::string getters, variables, loads;
    int count = 0;
    std::set<std::string_view> names;
    const auto add = [&](const LectureUniform& uniform) {
      const Parameter& p = uniform.parameter;
      const bool image = p.type == ParameterType::image, boolean = p.type == ParameterType::boolean;
      const std::string_view type = image ? "gsnImage" : boolean ? "bool" : glslType(p.type);
      const std::string value = (image ? "gsnImage(parameters." : "parameters.") + p.name +
                                (image     ? ")"
                                 : boolean ? " != 0u"
                                           : "");
      getters += fmt::format("{} gsnInput{}_() {{ return {}; }}\n", type, count, value);
      variables += fmt::format("{} {};\n", type, p.name);
      loads += fmt::format(" {} = gsnInput{}_();", p.name, count++);
    };
    for (const LectureUniform& uniform : s_.uniforms)
      if (kept(uniform.begin) && !isPredeclared(uniform.parameter.name) && names.insert(uniform.parameter.name).second)
        add(uniform);
    for (const LectureUniform& uniform : s_.implicit) add(uniform);
    if (s_.declaresPi) variables += kPi;
    return getters + "#include <quintet/gsn/names_end.glsl>\n" + macros_ + variables +
           "void gsnBegin_() { gsnLoadBuiltIns_();" + loads + " }\n";
  }

  const LectureSource& s_;
  const int index_;
  const LectureMain& main_;
  const bool boxes_;
  Patch patch_;
  std::string extensions_;
  std::size_t extensionCount_ = 0;
  bool hasHitAttribute_ = false;
  std::string macros_;
};

}  // namespace

std::string lectureStage(const LectureSource& source, std::size_t main, bool boxes) {
  return StageWriter(source, main, boxes).write();
}

}  // namespace quintet::program
