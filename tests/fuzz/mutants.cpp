// SPDX-License-Identifier: Apache-2.0
#include "mutants.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "check/case_file.h"

namespace quintet::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLecture = ".rt.glsl";
constexpr std::size_t kMaxFileBytes = 1u << 20;

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

Files filesOf(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.file_size() <= kMaxFileBytes)
      files[entry.path().filename()] = textOf(entry.path());
  return files;
}

// ---- Random numbers: the same on all platforms ----

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t count) { return count == 0 ? 0 : engine_() % count; }
  bool once(std::size_t in) { return below(in) == 0; }
  template <class Range>
  const auto& pick(const Range& range) {
    return *(std::begin(range) + static_cast<std::ptrdiff_t>(below(std::size(range))));
  }

 private:
  std::mt19937_64 engine_;
};

// ---- Tokens ----

struct Token {
  enum class Kind { word, number, sign, text };
  Kind kind = Kind::sign;
  std::size_t begin = 0, end = 0;
};

// Words, numbers and signs outside of comments; a directive is skipped.
std::vector<Token> tokensOf(std::string_view text) {
  std::vector<Token> tokens;
  const auto isWord = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  bool lineStart = true;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') lineStart = true;
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++i;
      continue;
    }
    if (c == '/' && i + 1 < text.size() && (text[i + 1] == '/' || text[i + 1] == '*')) {
      const std::size_t end = text[i + 1] == '/' ? text.find('\n', i) : text.find("*/", i + 2);
      i = end == text.npos ? text.size() : text[i + 1] == '/' ? end : end + 2;
      continue;
    }
    if (c == '#' && lineStart) {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    lineStart = false;
    Token token{Token::Kind::sign, i, i + 1};
    if (std::isdigit(static_cast<unsigned char>(c))) {
      token.kind = Token::Kind::number;
      while (token.end < text.size() && (isWord(text[token.end]) || text[token.end] == '.')) ++token.end;
    } else if (isWord(c)) {
      token.kind = Token::Kind::word;
      while (token.end < text.size() && isWord(text[token.end])) ++token.end;
    } else if (c == '"') {
      token.kind = Token::Kind::text;
      token.end = std::min(text.find('"', i + 1), text.size() - 1) + 1;
    }
    tokens.push_back(token);
    i = token.end;
  }
  return tokens;
}

class Editor {
 public:
  Editor(std::string& text, Random& random) : text_(text), random_(random), tokens_(tokensOf(text)) {}

  std::string_view at(std::size_t i) const {
    return std::string_view(text_).substr(tokens_[i].begin, tokens_[i].end - tokens_[i].begin);
  }

  // Makes one change; returns its description, or an empty text if it does not apply here.
  std::string mutate() {
    if (tokens_.size() < 4) return {};
    using Change = std::string (Editor::*)();
    static constexpr std::array<Change, 24> kChanges{
        &Editor::deleteStatement, &Editor::deleteStatement, &Editor::duplicateStatement, &Editor::moveStatement,
        &Editor::moveStatement,   &Editor::swapArguments,   &Editor::swapArguments,      &Editor::replaceArgument,
        &Editor::replaceArgument, &Editor::replaceArgument, &Editor::changeNumber,       &Editor::changeNumber,
        &Editor::changeNumber,    &Editor::changeType,      &Editor::changeQualifier,    &Editor::negateCondition,
        &Editor::emptyBlock,      &Editor::replaceWord,     &Editor::replaceWord,        &Editor::replaceSign,
        &Editor::addDeclaration,  &Editor::addStatement,    &Editor::addStatement,       &Editor::changeToken};
    return (this->*random_.pick(kChanges))();
  }

 private:
  static constexpr std::array<std::string_view, 26> kNumbers{
      "0",   "1",   "-1",   "2",     "7",    "31",         "64",          "255",        "256",
      "0u",  "1u",  "2u",   "15u",   "16u",  "0xFFu",      "0x100u",      "65536u",     "0xFFFFFFFFu",
      "0.0", "1.0", "-1.0", "1e-20", "1e30", "2147483647", "(0.0 / 0.0)", "(1.0 / 0.0)"};
  static constexpr std::array<std::string_view, 12> kTypes{"float", "int",  "uint", "vec2",  "vec3",   "vec4",
                                                           "bool",  "mat3", "mat4", "uvec2", "double", "uint64_t"};
  static constexpr std::array<std::string_view, 9> kQualifiers{
      "rayPayloadEXT",   "rayPayloadInEXT", "hitAttributeEXT", "callableDataEXT", "callableDataInEXT",
      "shaderRecordEXT", "uniform",         "buffer",          "shared"};

  void replace(std::size_t begin, std::size_t end, std::string_view with) { text_.replace(begin, end - begin, with); }

  std::vector<std::size_t> tokensWhere(const std::function<bool(std::size_t)>& test) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < tokens_.size(); ++i)
      if (test(i)) found.push_back(i);
    return found;
  }

  // First and last token of the statement that ends with the ';' at `last`: inside a function, outside of parentheses.
  struct Statement {
    std::size_t first = 0, last = 0;
  };
  std::vector<Statement> statements() const {
    std::vector<Statement> found;
    int braces = 0, parentheses = 0;
    std::size_t start = 0;
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const std::string_view t = at(i);
      if (t == "{" || t == "}") {
        braces += t == "{" ? 1 : -1;
        start = i + 1;
      } else if (t == "(" || t == ")") {
        parentheses += t == "(" ? 1 : -1;
      } else if (t == ";" && parentheses == 0) {
        if (braces > 0 && start < i) found.push_back({start, i});
        start = i + 1;
      }
    }
    return found;
  }
  std::string textOf(Statement s) const {
    return text_.substr(tokens_[s.first].begin, tokens_[s.last].end - tokens_[s.first].begin);
  }

  std::string deleteStatement() {
    const std::vector<Statement> all = statements();
    if (all.empty()) return {};
    const Statement s = random_.pick(all);
    replace(tokens_[s.first].begin, tokens_[s.last].end, ";");
    return "deleted a statement";
  }

  std::string duplicateStatement() {
    const std::vector<Statement> all = statements();
    if (all.empty()) return {};
    const Statement s = random_.pick(all);
    text_.insert(tokens_[s.last].end, " " + textOf(s));
    return "duplicated a statement";
  }

  std::string moveStatement() {
    const std::vector<Statement> all = statements();
    if (all.size() < 2) return {};
    const Statement from = random_.pick(all), to = random_.pick(all);
    if (from.first == to.first) return {};
    const std::string moved = textOf(from);
    const std::size_t target = tokens_[to.last].end, begin = tokens_[from.first].begin, end = tokens_[from.last].end;
    if (target > begin) {
      text_.insert(target, " " + moved);
      replace(begin, end, ";");
    } else {
      replace(begin, end, ";");
      text_.insert(target, " " + moved);
    }
    return "moved a statement";
  }

  // Offsets of the arguments of a random call: a word followed by parentheses.
  std::vector<std::pair<std::size_t, std::size_t>> arguments() {
    const auto calls = tokensWhere([&](std::size_t i) {
      return tokens_[i].kind == Token::Kind::word && i + 2 < tokens_.size() && at(i + 1) == "(" && at(i + 2) != ")" &&
             at(i) != "layout" && at(i) != "for" && at(i) != "if" && at(i) != "while";
    });
    if (calls.empty()) return {};
    // Calls of the ray tracing functions are the most interesting ones.
    std::vector<std::size_t> traces;
    for (const std::size_t call : calls)
      if (at(call).ends_with("EXT") || at(call).ends_with("Output")) traces.push_back(call);
    const std::size_t call = !traces.empty() && random_.once(2) ? random_.pick(traces) : random_.pick(calls);
    std::vector<std::pair<std::size_t, std::size_t>> found;
    int depth = 0;
    std::size_t start = tokens_[call + 1].end;
    for (std::size_t i = call + 1; i < tokens_.size(); ++i) {
      const std::string_view t = at(i);
      if (t == "(" || t == "[" || t == "{") ++depth;
      if (t == ")" || t == "]" || t == "}") --depth;
      if ((t == "," && depth == 1) || depth == 0) {
        found.emplace_back(start, tokens_[i].begin);
        start = tokens_[i].end;
      }
      if (depth == 0) return found;
    }
    return {};
  }

  std::string swapArguments() {
    const auto all = arguments();
    if (all.size() < 2) return {};
    const std::size_t first = random_.below(all.size() - 1), second = first + 1 + random_.below(all.size() - first - 1);
    const auto [aBegin, aEnd] = all[first];
    const auto [bBegin, bEnd] = all[second];
    const std::string a = text_.substr(aBegin, aEnd - aBegin), b = text_.substr(bBegin, bEnd - bBegin);
    replace(bBegin, bEnd, a);
    replace(aBegin, aEnd, b);
    return "swapped two arguments";
  }

  std::string replaceArgument() {
    const auto all = arguments();
    if (all.empty()) return {};
    const auto [begin, end] = random_.pick(all);
    const std::string old = text_.substr(begin, end - begin);
    static constexpr std::array<std::string_view, 8> kWrong{
        "vec3(0.0)", "vec3(0.0 / 0.0)",     "gl_LaunchIDEXT.x", "gl_LaunchIDEXT.yx",
        "1e38",      "gl_LaunchSizeEXT.xy", "vec4(1e30)",       "-vec3(1.0)"};
    const std::size_t kind = random_.below(4);
    const std::string with = kind == 0   ? std::string(random_.pick(kNumbers))
                             : kind == 1 ? "(" + old + ") * " + std::string(random_.pick(kNumbers))
                             : kind == 2 ? "(" + old + ") + " + std::string(random_.pick(kNumbers))
                                         : std::string(random_.pick(kWrong));
    replace(begin, end, " " + with);
    return "replaced an argument by " + with;
  }

  std::string changeNumber() {
    const auto all = tokensWhere([&](std::size_t i) { return tokens_[i].kind == Token::Kind::number; });
    if (all.empty()) return {};
    const Token token = tokens_[random_.pick(all)];
    const std::string old = text_.substr(token.begin, token.end - token.begin);
    std::string with(random_.pick(kNumbers));
    // Keep the kind of most numbers, so that the result compiles.
    const bool real = old.find('.') != old.npos, isUnsigned = old.ends_with('u');
    for (int tries = 0; tries < 20; ++tries) {
      const bool sameKind =
          (with.find('.') != with.npos || with.find('e') != with.npos) == real && with.ends_with('u') == isUnsigned;
      if (sameKind) break;
      with = random_.pick(kNumbers);
    }
    replace(token.begin, token.end, with);
    return "changed " + old + " to " + with;
  }

  std::string replaceOneOf(std::span<const std::string_view> words, std::string_view what) {
    const auto all = tokensWhere([&](std::size_t i) { return std::ranges::find(words, at(i)) != words.end(); });
    if (all.empty()) return {};
    const Token token = tokens_[random_.pick(all)];
    const std::string with(random_.pick(words));
    replace(token.begin, token.end, with);
    return "changed a " + std::string(what) + " to " + with;
  }
  std::string changeType() { return replaceOneOf(kTypes, "type"); }
  std::string changeQualifier() { return replaceOneOf(kQualifiers, "qualifier"); }

  std::string negateCondition() {
    const auto all = tokensWhere([&](std::size_t i) {
      return (at(i) == "if" || at(i) == "while") && i + 1 < tokens_.size() && at(i + 1) == "(";
    });
    if (all.empty()) return {};
    const std::size_t open = random_.pick(all) + 1;
    int depth = 0;
    for (std::size_t i = open; i < tokens_.size(); ++i) {
      depth += at(i) == "(" ? 1 : at(i) == ")" ? -1 : 0;
      if (depth != 0) continue;
      const std::size_t kind = random_.below(3);
      const std::string inner = text_.substr(tokens_[open].end, tokens_[i].begin - tokens_[open].end);
      replace(tokens_[open].end, tokens_[i].begin, kind == 0 ? "true" : kind == 1 ? "false" : "!(" + inner + ")");
      return "changed a condition";
    }
    return {};
  }

  std::string emptyBlock() {
    const auto all = tokensWhere([&](std::size_t i) { return at(i) == "{"; });
    if (all.empty()) return {};
    const std::size_t open = random_.pick(all);
    int depth = 0;
    for (std::size_t i = open; i < tokens_.size(); ++i) {
      depth += at(i) == "{" ? 1 : at(i) == "}" ? -1 : 0;
      if (depth != 0) continue;
      replace(tokens_[open].end, tokens_[i].begin, " ");
      return "emptied a block";
    }
    return {};
  }

  std::string replaceWord() {
    const auto all = tokensWhere([&](std::size_t i) { return tokens_[i].kind == Token::Kind::word; });
    if (all.size() < 2) return {};
    const Token token = tokens_[random_.pick(all)];
    const std::string with(at(random_.pick(all)));
    replace(token.begin, token.end, with);
    return "replaced a word by " + with;
  }

  std::string replaceSign() {
    static constexpr std::array<std::string_view, 8> kSigns{"+", "-", "*", "/", "<", ">", "%", "&"};
    return replaceOneOf(kSigns, "sign");
  }

  // A resource, variable or function that other changes can use.
  std::string addDeclaration() {
    static constexpr std::array<std::string_view, 10> kDeclarations{
        "layout(set = 0, binding = 2, rgba32f) uniform image2D fuzzImage;\nvoid fuzzUse() { imageStore(fuzzImage, "
        "ivec2(0), "
        "vec4(1.0)); }\n",
        "layout(set = 0, binding = 1) uniform sampler2D fuzzTexture;\nvec4 fuzzUse() { return textureLod(fuzzTexture, "
        "vec2(0.5), 0.0); }\n",
        "layout(set = 1, binding = 0) buffer FuzzBuffer { uint fuzzWords[]; };\nvoid fuzzUse() { fuzzWords[0] = 1u; "
        "}\n",
        "layout(set = 0, binding = 0) uniform FuzzBlock { vec4 fuzzColor; };\nvec4 fuzzUse() { return fuzzColor; }\n",
        "layout(push_constant) uniform FuzzPush { vec4 fuzzColor; };\nvec4 fuzzUse() { return fuzzColor; }\n",
        "layout(shaderRecordEXT, std430) buffer FuzzRecord { vec4 fuzzColor; };\nvec4 fuzzUse() { return fuzzColor; "
        "}\n",
        "layout(location = 7) rayPayloadEXT vec4 fuzzPayload;\nvoid fuzzUse() { fuzzPayload = vec4(1.0); }\n",
        "layout(location = 7) callableDataEXT vec4 fuzzData;\nvoid fuzzUse() { executeCallableEXT(gl_LaunchIDEXT.x, "
        "7); }\n",
        "float fuzzArray[64];\nvoid fuzzUse() { fuzzArray[gl_LaunchIDEXT.x * 1000u] = 1.0; }\n",
        "void fuzzUse() { float big[4096]; for (int i = 0; i < 4096; ++i) big[i] = float(i); }\n"};
    const std::size_t main = text_.find("void main()");
    if (main == text_.npos) return {};
    const std::size_t body = text_.find('{', main);
    if (body == text_.npos) return {};
    text_.insert(body + 1, " fuzzUse();");
    const std::string_view declaration = random_.pick(kDeclarations);
    text_.insert(main, declaration);
    return "added " + std::string(declaration.substr(0, declaration.find('\n')));
  }

  std::string addStatement() {
    static constexpr std::array<std::string_view, 20> kStatements{
        "payload.color = vec3(0.0 / 0.0);",
        "return;",
        "ignoreIntersectionEXT;",
        "terminateRayEXT;",
        "for (int fuzz = 0; fuzz < 100; ++fuzz) { }",
        "reportIntersectionEXT(-1.0, 0u);",
        "reportIntersectionEXT(gl_RayTminEXT, 255u);",
        "executeCallableEXT(gl_LaunchIDEXT.x, 0);",
        "executeCallableEXT(100000u, 0);",
        "storeOutput(gl_LaunchIDEXT.x, gl_LaunchIDEXT.yx * 1000u, vec4(1.0));",
        "storeOutput(0u, gl_LaunchIDEXT.xy + uvec2(0xFFFFu), vec4(1.0));",
        "addOutput(77u, uvec2(3u), vec4(1.0));",
        "gsnSetPixel(vec4(0.0));",
        "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.001, vec3(0.0, 0.0, -1.0), 1000.0, 0);",
        "traceRayEXT(topLevelAS, 0u, 0xFFu, 9u, 3u, 5u, vec3(0.0), 0.001, vec3(0.0, 0.0, -1.0), 1000.0, 0);",
        "traceRayEXT(topLevelAS, 0u, 0xFFu, gl_LaunchIDEXT.x, 1u, gl_LaunchIDEXT.y, vec3(0.0), 0.0, vec3(1.0), 1e30, "
        "0);",
        "traceRayEXT(topLevelAS, 0x2FFu, 0u, 0u, 1u, 0u, vec3(0.0 / 0.0), -1.0, vec3(0.0), -2.0, 0);",
        "float fuzzLocal[8]; fuzzLocal[gl_LaunchIDEXT.x * 77u] = 1.0;",
        "if (gl_LaunchIDEXT.x > 3u) return;",
        "while (gl_LaunchIDEXT.x == 99u) { }"};
    const std::vector<Statement> all = statements();
    if (all.empty()) return {};
    const std::string_view statement = random_.pick(kStatements);
    text_.insert(tokens_[random_.pick(all).last].end, " " + std::string(statement));
    return "added " + std::string(statement);
  }

  std::string changeToken() {
    const std::size_t i = random_.below(tokens_.size());
    const std::string token(at(i));
    switch (random_.below(3)) {
      case 0: replace(tokens_[i].begin, tokens_[i].end, ""); return "deleted " + token;
      case 1: text_.insert(tokens_[i].end, " " + token); return "duplicated " + token;
      default: break;
    }
    const std::string other(at(random_.below(tokens_.size())));
    replace(tokens_[i].begin, tokens_[i].end, other);
    return "replaced " + token + " by " + other;
  }

  std::string& text_;
  Random& random_;
  std::vector<Token> tokens_;
};

// ---- Descriptions ----

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string mutateDescription(std::string& text, const Files& files, Random& random) {
  std::vector<std::string> lines = linesOf(text);
  if (lines.empty()) return {};
  std::string change;
  const std::size_t i = random.below(lines.size());
  switch (random.below(5)) {
    case 0:
      change = "deleted '" + lines[i] + "'";
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    case 1: {
      const std::size_t k = random.below(lines.size());
      change = "swapped two lines";
      std::swap(lines[i], lines[k]);
      break;
    }
    case 2: {  // another file of the program
      const std::size_t begin = lines[i].find('"'), end = lines[i].find('"', begin + 1);
      if (begin == std::string::npos || end == std::string::npos) return {};
      auto file = files.begin();
      std::advance(file, static_cast<std::ptrdiff_t>(random.below(files.size())));
      lines[i].replace(begin + 1, end - begin - 1, file->first);
      change = "changed a name to " + file->first;
      break;
    }
    case 3: {
      static constexpr std::array<std::string_view, 5> kDepths{"1", "2", "5", "31", "32"};
      const std::string depth(random.pick(kDepths));
      const auto program = std::ranges::find(lines, "[program]");
      if (program == lines.end()) return {};
      lines.insert(program + 1, "max_recursion = " + depth);
      change = "added max_recursion = " + depth;
      break;
    }
    default: {
      std::string joined;
      for (const std::string& line : lines) joined += line + "\n";
      text = joined;
      return Editor(text, random).mutate();
    }
  }
  text.clear();
  for (const std::string& line : lines) text += line + "\n";
  return change;
}

}  // namespace

std::vector<Source> findSources(const fs::path& root) {
  std::vector<Source> sources;
  const auto add = [&](const fs::path& folder, const Files& files) {
    if (files.contains("program.toml")) {
      sources.push_back({folder, "", files});
      return;
    }
    for (const auto& [name, text] : files)
      if (name.ends_with(kLecture)) sources.push_back({folder / name, name, files});
  };
  for (const char* top : {"programs", "examples/programs"}) {
    if (!fs::exists(root / top)) continue;
    add(top, filesOf(root / top));
    for (const auto& entry : fs::recursive_directory_iterator(root / top))
      if (entry.is_directory()) add(fs::relative(entry.path(), root), filesOf(entry.path()));
  }
  for (const char* top : {"tests/check/mistakes", "tests/check/idioms"}) {
    if (!fs::exists(root / top)) continue;
    for (const fs::path& file : test::casesIn(root / top)) {
      const test::Case program = test::readCase(file);
      add(fs::path(top) / program.name, program.files);
      if (!program.fixed.empty()) add(fs::path(top) / program.name / "repaired", program.allFixed());
    }
  }
  std::ranges::sort(sources, {}, &Source::name);
  return sources;
}

Mutant makeMutant(const std::vector<Source>& sources, std::uint64_t seed, std::uint64_t number) {
  Random random(seed * 0x9E3779B97F4A7C15ull + number);
  Mutant mutant;
  mutant.source = &random.pick(sources);
  mutant.files = mutant.source->files;
  std::vector<std::string> shaders;
  for (const auto& [name, text] : mutant.files)
    if (!name.ends_with(".toml") && text.find('\0') == text.npos && name.find(".r") != name.npos)
      shaders.push_back(name);
  const std::size_t changes = 1 + random.below(3);
  for (std::size_t k = 0; k < changes;) {
    const bool description = mutant.files.contains("program.toml") && random.once(10);
    const std::string name = description || shaders.empty() ? "program.toml" : random.pick(shaders);
    const auto file = mutant.files.find(name);
    if (file == mutant.files.end()) break;
    const std::string change =
        description ? mutateDescription(file->second, mutant.files, random) : Editor(file->second, random).mutate();
    if (change.empty() && !random.once(20)) continue;  // does not apply: try another one
    mutant.changes += (k > 0 ? "; " : "") + name + ": " + change;
    ++k;
  }
  return mutant;
}

}  // namespace quintet::fuzz
