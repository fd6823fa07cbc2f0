// SPDX-License-Identifier: Apache-2.0
#include "program/lecture/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "base/suggestion.h"
#include "shader/stage_builtins.h"

namespace quintet::program {
namespace {

using shader::Stage;

constexpr std::size_t kNone = std::string_view::npos;
constexpr std::size_t kMaxMains = 64;

struct Marker {
  std::string_view name;  // as in the lectures
  std::string_view key;   // letters only, without SHADER
  Stage stage;
};
constexpr Marker kMarkers[] = {
    {"RAY GENERATION SHADER", "RAYGENERATION", Stage::rayGeneration},
    {"RAYGEN SHADER", "RAYGEN", Stage::rayGeneration},
    {"CLOSEST-HIT SHADER", "CLOSESTHIT", Stage::closestHit},
    {"MISS SHADER", "MISS", Stage::miss},
    {"INTERSECTION SHADER", "INTERSECTION", Stage::intersection},
    {"ANY-HIT SHADER", "ANYHIT", Stage::anyHit},
    {"CALLABLE SHADER", "CALLABLE", Stage::callable},
};

// A comment that can be a stage marker.
struct Comment {
  std::size_t begin = 0;
  std::string key;         // its letters in upper case, without SHADER at the end
  bool formal = false;     // starts with /**
  bool hasShader = false;  // ends with SHADER

  std::optional<Stage> stage() const {
    if (!formal && !hasShader) return {};
    for (const Marker& marker : kMarkers)
      if (marker.key == key) return marker.stage;
    return {};
  }
};

Comment readComment(std::string_view text, const Token& token) {
  constexpr std::string_view kShader = "SHADER";
  const std::string_view comment = textOf(text, token);
  Comment result{token.begin, {}, comment.starts_with("/**"), false};
  for (const char c : comment) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || byte >= 0x80) result.key += static_cast<char>(std::toupper(byte));
  }
  if (result.key.ends_with(kShader)) {
    result.hasShader = true;
    result.key.resize(result.key.size() - kShader.size());
  }
  return result;
}

class Splitter {
 public:
  Splitter(const LectureText& source, LectureErrors& errors)
      : source_(source), text_(source.text), tokens_(source.tokens), errors_(errors) {}

  LectureSplit split() {
    if (findMains()) {
      for (std::size_t i = 0; i < found_.size(); ++i) nameStage(i);
      checkStages();
    }
    makeRegions();
    return std::move(result_);
  }

 private:
  struct Main {
    std::size_t first;  // token "void"
    std::size_t open;   // token '{'
    std::size_t close;  // token '}'
  };

  bool isMark(std::size_t i, char c) const { return source_.isMark(i, c); }
  std::size_t code(std::size_t from) const { return source_.nextCode(from); }

  // Returns the '{' of the definition "void main() {" that starts at token i; tokens_.size() if none does.
  std::size_t mainAt(std::size_t i) const {
    if (!source_.isWord(i, "void")) return tokens_.size();
    std::size_t at = code(i + 1);
    if (!source_.isWord(at, "main")) return tokens_.size();
    at = code(at + 1);
    if (!isMark(at, '(')) return tokens_.size();
    at = code(at + 1);
    if (source_.isWord(at, "void")) at = code(at + 1);
    if (!isMark(at, ')')) return tokens_.size();
    at = code(at + 1);
    return isMark(at, '{') ? at : tokens_.size();
  }

  // Returns false if braces do not match or the file has too many main() functions. The stages are then unreliable.
  bool findMains() {
    std::size_t outermost = kNone;  // the '{' that opened the current definition
    for (std::size_t i = code(0); i < tokens_.size(); i = code(i + 1)) {
      const Token& token = tokens_[i];
      const std::size_t open = mainAt(i);
      if (open < tokens_.size() && token.braces > 0 && outermost != kNone) {
        errors_.add("Q014", tokens_[outermost].begin,
                    fmt::format("this '{{' has no matching '}}' before the main() in line {}",
                                positionOf(text_, token.begin).line));
        return false;
      }
      if (open < tokens_.size()) found_.push_back({i, open, tokens_.size()});
      if (found_.size() > kMaxMains) {
        errors_.add("Q013", token.begin, fmt::format("more than {} main() functions", kMaxMains));
        return false;
      }
      if (isMark(i, '{') && token.braces <= 0) outermost = i;
      if (isMark(i, '}') && token.braces <= 0) {
        errors_.add("Q014", token.begin, "this '}' has no matching '{'");
        return false;
      }
      if (isMark(i, '}') && token.braces == 1) {
        outermost = kNone;
        if (!found_.empty() && found_.back().close == tokens_.size() && i > found_.back().open) found_.back().close = i;
      }
    }
    if (outermost != kNone) errors_.add("Q014", tokens_[outermost].begin, "this '{' has no matching '}'");
    return outermost == kNone;
  }

  // Returns the active comments among the tokens first … last - 1.
  std::vector<Comment> comments(std::size_t first, std::size_t last) const {
    std::vector<Comment> result;
    for (std::size_t i = first; i < last; ++i)
      if (tokens_[i].kind == TokenKind::comment && !tokens_[i].inactive)
        result.push_back(readComment(text_, tokens_[i]));
    return result;
  }

  // Finds the stage of a main(): the marker at the start of the body, else before the main(), else anywhere in the body.
  void nameStage(std::size_t index) {
    const Main& main = found_[index];
    const std::vector<Comment> leading = comments(main.first, code(main.open + 1));
    std::vector<Comment> before = comments(index == 0 ? 0 : found_[index - 1].close + 1, main.first);
    std::ranges::reverse(before);
    const std::vector<Comment> inside = comments(main.open, main.close);
    LectureMain stage{Stage::rayGeneration, tokens_[main.first].begin, tokens_[main.open].end, tokens_[main.close].end};
    for (const std::vector<Comment>* group : {&leading, static_cast<const std::vector<Comment>*>(&before), &inside}) {
      for (const Comment& comment : *group) {
        const std::optional<Stage> named = comment.stage();
        if (!named || (group == &inside && !comment.formal)) continue;
        stage.stage = *named;
        add(stage);
        return;
      }
    }
    for (const std::vector<Comment>* group : {&leading, static_cast<const std::vector<Comment>*>(&before)}) {
      for (const Comment& comment : *group) {
        if (!comment.formal || comment.key.starts_with("COMMON")) continue;
        reportUnknown(comment);
        add(stage, false);
        return;
      }
    }
    errors_.add("Q011", stage.begin, "this main() has no stage marker such as /**** CLOSEST-HIT SHADER ****/");
    add(stage, false);
  }

  void reportUnknown(const Comment& comment) {
    std::vector<std::string> keys;
    for (const Marker& marker : kMarkers) keys.emplace_back(marker.key);
    const std::string nearest = nearestName(comment.key.substr(0, 64), keys);
    std::string hint = "; available: RAY GENERATION, CLOSEST-HIT, MISS, INTERSECTION, ANY-HIT, CALLABLE";
    for (const Marker& marker : kMarkers)
      if (marker.key == nearest) hint = fmt::format("; did you mean /**** {} ****/?", marker.name);
    errors_.add("Q012", comment.begin, "unknown stage marker" + hint);
  }

  void add(const LectureMain& main, bool known = true) {
    result_.mains.push_back(main);
    known_.push_back(known);
  }

  void checkStages() {
    bool hasRayGeneration = false;
    const auto& mains = result_.mains;
    for (std::size_t i = 0; i < mains.size(); ++i) {
      hasRayGeneration = hasRayGeneration || mains[i].stage == Stage::rayGeneration;
      if (!known_[i] || mains[i].stage == Stage::callable) continue;
      for (std::size_t k = 0; k < i; ++k) {
        if (!known_[k] || mains[k].stage != mains[i].stage) continue;
        errors_.add("Q013", mains[i].begin,
                    fmt::format("duplicate {} shader; the first one is in line {}", shader::stageName(mains[i].stage),
                                positionOf(text_, mains[k].begin).line));
        break;
      }
    }
    if (!hasRayGeneration && std::ranges::all_of(known_, [](bool known) { return known; }))
      errors_.add("Q010", 0, "no ray generation shader: mark a main() with /**** RAY GENERATION SHADER ****/");
  }

  void addRegion(std::size_t begin, std::size_t end, int owner) {
    if (begin < end) result_.regions.push_back({begin, end, owner});
  }

  // Adds the text between two mains; its COMMON sections become common text.
  void addBetween(std::size_t begin, std::size_t end, int owner) {
    std::size_t start = kNone;  // offset of the open COMMON section
    for (auto at = std::ranges::lower_bound(tokens_, begin, {}, &Token::begin); at != tokens_.end() && at->end <= end;
         ++at) {
      const Token& token = *at;
      if (token.kind != TokenKind::comment || token.inactive) continue;
      const std::string key = readComment(text_, token).key;
      if (key == "COMMONSTART" && start == kNone) {
        addRegion(begin, token.begin, owner);
        start = begin = token.begin;
      } else if (key == "COMMONEND" && start != kNone) {
        addRegion(start, token.end, kCommonText);
        begin = token.end;
        start = kNone;
      }
    }
    addRegion(begin, end, start != kNone ? kCommonText : owner);
  }

  void makeRegions() {
    std::size_t at = 0;
    const auto& mains = result_.mains;
    for (std::size_t i = 0; i < mains.size(); ++i) {
      if (i == 0)
        addRegion(0, mains[0].begin, kCommonText);
      else
        addBetween(at, mains[i].begin, static_cast<int>(i));
      addRegion(mains[i].begin, mains[i].end, static_cast<int>(i));
      at = mains[i].end;
    }
    if (mains.empty())
      addRegion(0, text_.size(), kCommonText);
    else
      addBetween(at, text_.size(), static_cast<int>(mains.size()) - 1);
  }

  const LectureText& source_;
  std::string_view text_;
  const std::vector<Token>& tokens_;
  LectureErrors& errors_;
  std::vector<Main> found_;
  std::vector<bool> known_;
  LectureSplit result_;
};

using Words = std::set<std::string_view>;

struct Function {
  std::string_view name;
  TextRange range;
  Words words;  // in its head and body
};

// Reads the definitions of functions and macros, and the words that they use.
class FunctionReader {
 public:
  FunctionReader(const LectureText& source, const LectureSplit& split)
      : source_(source), text_(source.text), tokens_(source.tokens), split_(split) {}

  // Returns the function definitions at the outermost level of the common text: a ')' followed by a '{', with the text
  // around them that belongs to the definition.
  std::vector<Function> functions() const {
    std::vector<Function> found;
    std::size_t start = kNone;     // first token of the current declaration
    std::size_t name = kNone;      // the word before its first '('
    std::size_t previous = kNone;  // the previous code token
    for (std::size_t i = source_.nextCode(0); i < tokens_.size(); i = source_.nextCode(i + 1)) {
      const Token& token = tokens_[i];
      if (token.braces == 0 && start == kNone) start = i;
      if (token.braces == 0 && token.parens == 0 && isMark(i, '(') && name == kNone) name = previous;
      if (token.braces == 0 && isMark(i, '{') && isMark(previous, ')') && name != kNone && isCommon(start))
        open(found, start, name);
      const bool ends = (token.braces == 0 && isMark(i, ';')) || (token.braces == 1 && isMark(i, '}'));
      if (ends && token.braces == 1 && !found.empty() && found.back().range.second == 0)
        found.back().range.second = token.end;
      if (ends) start = name = kNone;
      previous = i;
    }
    std::erase_if(found, [](const Function& f) { return f.range.second == 0; });
    for (Function& f : found) f.words = words(f.range);
    return found;
  }

  Words words(const TextRange& range) const {
    Words result;
    for (auto at = std::ranges::lower_bound(tokens_, range.first, {}, &Token::begin);
         at != tokens_.end() && at->begin < range.second; ++at)
      addWords(*at, result);
    return result;
  }

  // Adds the words of a token; conditionals count too.
  void addWords(const Token& token, Words& words) const {
    if (token.kind == TokenKind::word) words.insert(textOf(text_, token));
    if (token.kind == TokenKind::directive && directiveOf(textOf(text_, token)).name != "define")
      words.merge(wordsOfLine(textOf(text_, token)));
  }

  // Returns the macros as functions that use the words of their line.
  std::vector<Function> macros() const {
    std::vector<Function> found;
    for (const Token& token : tokens_) {
      const Directive line = token.kind == TokenKind::directive ? directiveOf(textOf(text_, token)) : Directive{};
      if (line.name != "define") continue;
      const std::string_view name = line.rest.substr(0, line.rest.find_first_of(" \t(\\"));
      found.push_back({name, {token.begin, token.end}, wordsOfLine(textOf(text_, token))});
    }
    return found;
  }

 private:
  static Words wordsOfLine(std::string_view line) {
    Words words;
    line.remove_prefix(1);  // the '#'
    for (const Token& part : tokenize(line))
      if (part.kind == TokenKind::word) words.insert(textOf(line, part));
    return words;
  }
  bool isMark(std::size_t i, char c) const { return source_.isMark(i, c); }
  bool isCommon(std::size_t i) const { return split_.ownerOf(tokens_[i].begin) == kCommonText; }

  void open(std::vector<Function>& found, std::size_t start, std::size_t name) const {
    if (tokens_[name].kind == TokenKind::word)
      found.push_back({textOf(text_, tokens_[name]), {tokens_[start].begin, 0}, {}});
  }

  const LectureText& source_;
  std::string_view text_;
  const std::vector<Token>& tokens_;
  const LectureSplit& split_;
};

// Returns all words that `words` reach through the functions.
Words closure(Words words, const std::multimap<std::string_view, const Function*>& byName) {
  std::vector<std::string_view> open(words.begin(), words.end());
  while (!open.empty()) {
    const std::string_view word = open.back();
    open.pop_back();
    const auto [first, last] = byName.equal_range(word);
    for (auto at = first; at != last; ++at)
      for (const std::string_view inner : at->second->words)
        if (words.insert(inner).second) open.push_back(inner);
  }
  return words;
}

// Returns false if the lecture form has the name only in other stages.
bool exists(std::string_view name, Stage stage) {
  const bool hit = stage == Stage::anyHit || stage == Stage::closestHit;
  const bool traces = stage == Stage::rayGeneration || stage == Stage::closestHit || stage == Stage::miss;
  if (name == "payload") return hit || traces;
  if (name == "hit") return hit || stage == Stage::intersection;
  if (name == "baryCoord") return hit;
  if (name == "callableData") return traces || stage == Stage::callable;
  if (name == "topLevelAS") return traces;
  if (name == "gsnSetPixel" || name == "gsnGetPreviousPixel") return stage == Stage::rayGeneration;
  const shader::StageBuiltIn* builtIn = shader::findStageBuiltIn(name);
  return !builtIn || builtIn->availableIn(stage);
}

// Returns the stage that compiles a function that no stage uses, so that its errors are found: one in which all its
// names exist, the ray generation shader if possible. Nullopt if there is none.
std::optional<std::size_t> stageFor(const Words& words, const std::vector<LectureMain>& mains) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < mains.size(); ++i) {
    const Stage stage = mains[i].stage;
    if (!std::ranges::all_of(words, [&](std::string_view name) { return exists(name, stage); })) continue;
    if (stage == Stage::rayGeneration) return i;
    if (!found) found = i;
  }
  return found;
}

std::vector<std::vector<TextRange>> unusedFunctions(const LectureText& source, const LectureSplit& split) {
  const FunctionReader reader(source, split);
  const std::vector<Function> functions = reader.functions();
  std::multimap<std::string_view, const Function*> byName;
  for (const Function& f : functions) byName.emplace(f.name, &f);
  const std::vector<Function> macros = reader.macros();
  for (const Function& m : macros) byName.emplace(m.name, &m);

  // Words outside functions, by owner.
  std::vector<Words> own(split.mains.size());
  Words common;
  std::size_t next = 0;
  for (const Token& token : source.tokens) {
    while (next < functions.size() && functions[next].range.second <= token.begin) ++next;
    if (token.inactive || (next < functions.size() && functions[next].range.first <= token.begin)) continue;
    const int owner = split.ownerOf(token.begin);
    reader.addWords(token, owner == kCommonText ? common : own[static_cast<std::size_t>(owner)]);
  }
  Words everywhere;
  for (Words& words : own) {
    words.insert(common.begin(), common.end());
    words = closure(std::move(words), byName);
    everywhere.insert(words.begin(), words.end());
  }

  for (const Function& f : functions) {
    if (everywhere.count(f.name)) continue;
    const Words words = closure({f.name}, byName);
    if (const auto stage = stageFor(words, split.mains)) own[*stage].insert(words.begin(), words.end());
  }

  std::vector<std::vector<TextRange>> unused(split.mains.size());
  for (std::size_t i = 0; i < unused.size(); ++i)
    for (const Function& f : functions)
      if (!own[i].count(f.name)) unused[i].push_back(f.range);
  return unused;
}

}  // namespace

int LectureSplit::ownerOf(std::size_t offset) const {
  const auto after = std::ranges::upper_bound(regions, offset, {}, &LectureRegion::begin);
  return after == regions.begin() ? kCommonText : std::prev(after)->owner;
}

LectureSplit splitLecture(const LectureText& source, LectureErrors& errors) {
  LectureSplit split = Splitter(source, errors).split();
  split.unusedFunctions = unusedFunctions(source, split);
  return split;
}

}  // namespace quintet::program
