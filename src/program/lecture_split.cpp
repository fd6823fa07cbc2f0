#include "program/lecture_split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "program/parameter.h"

namespace quintet::program {
namespace {

using shader::Stage;

constexpr std::size_t kNone = std::string_view::npos;
constexpr std::size_t kMaxMains = 64;
constexpr std::size_t kMaxErrors = 50;

struct Marker {
  std::string_view name;  // as the lectures write it
  std::string_view key;   // letters only
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

// A comment that may name a stage.
struct Comment {
  std::size_t begin = 0;
  std::string key;      // its letters in upper case, without SHADER at the end
  bool formal = false;  // begins with /**
  bool saysShader = false;

  std::optional<Stage> stage() const {
    if (!formal && !saysShader) return {};
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
    result.saysShader = true;
    result.key.resize(result.key.size() - kShader.size());
  }
  return result;
}

class Splitter {
 public:
  Splitter(std::string_view text, const std::vector<Token>& tokens, LectureErrors& errors)
      : text_(text), tokens_(tokens), errors_(errors) {}

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

  bool isMark(std::size_t i, char c) const {
    return i < tokens_.size() && tokens_[i].kind == TokenKind::mark && text_[tokens_[i].begin] == c;
  }
  bool isWord(std::size_t i, std::string_view word) const {
    return i < tokens_.size() && tokens_[i].kind == TokenKind::word && textOf(text_, tokens_[i]) == word;
  }
  std::size_t code(std::size_t from) const { return nextCode(tokens_, from); }

  // The '{' of a definition "void main() {" that begins at token i; tokens_.size(): it does not.
  std::size_t mainAt(std::size_t i) const {
    if (!isWord(i, "void")) return tokens_.size();
    std::size_t at = code(i + 1);
    if (!isWord(at, "main")) return tokens_.size();
    at = code(at + 1);
    if (!isMark(at, '(')) return tokens_.size();
    at = code(at + 1);
    if (isWord(at, "void")) at = code(at + 1);
    if (!isMark(at, ')')) return tokens_.size();
    at = code(at + 1);
    return isMark(at, '{') ? at : tokens_.size();
  }

  // False if braces do not match: there are no trustworthy stages then.
  bool findMains() {
    std::size_t outermost = kNone;  // token of the '{' that opened the current definition
    for (std::size_t i = code(0); i < tokens_.size(); i = code(i + 1)) {
      const Token& token = tokens_[i];
      const std::size_t open = mainAt(i);
      if (open < tokens_.size() && token.braces > 0 && outermost != kNone) {
        errors_.add(
            "Q014", tokens_[outermost].begin,
            fmt::format("this '{{' has no '}}' before the main() in line {}", placeOf(text_, token.begin).line));
        return false;
      }
      if (open < tokens_.size()) found_.push_back({i, open, tokens_.size()});
      if (found_.size() > kMaxMains) {
        errors_.add("Q013", token.begin, fmt::format("more than {} main() are no program", kMaxMains));
        return false;
      }
      if (isMark(i, '{') && token.braces <= 0) outermost = i;
      if (isMark(i, '}') && token.braces <= 0) {
        errors_.add("Q014", token.begin, "this '}' has no '{'");
        return false;
      }
      if (isMark(i, '}') && token.braces == 1) {
        outermost = kNone;
        if (!found_.empty() && found_.back().close == tokens_.size() && i > found_.back().open) found_.back().close = i;
      }
    }
    if (outermost != kNone) errors_.add("Q014", tokens_[outermost].begin, "this '{' has no '}'");
    return outermost == kNone;
  }

  // Comments among the tokens first … last - 1.
  std::vector<Comment> comments(std::size_t first, std::size_t last) const {
    std::vector<Comment> result;
    for (std::size_t i = first; i < last; ++i)
      if (tokens_[i].kind == TokenKind::comment && !tokens_[i].dead) result.push_back(readComment(text_, tokens_[i]));
    return result;
  }

  // The marker is looked for at the beginning of the body, then before the main(), then anywhere in the body.
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
    errors_.add("Q011", stage.begin,
                "this main() has no marker that says its stage, such as /**** CLOSEST-HIT SHADER ****/");
    add(stage, false);
  }

  void reportUnknown(const Comment& comment) {
    std::vector<std::string> keys;
    for (const Marker& marker : kMarkers) keys.emplace_back(marker.key);
    const std::string nearest = nearestName(comment.key.substr(0, 64), keys);
    std::string hint = "; there are RAY GENERATION, CLOSEST-HIT, MISS, INTERSECTION, ANY-HIT and CALLABLE";
    for (const Marker& marker : kMarkers)
      if (marker.key == nearest) hint = fmt::format("; did you mean /**** {} ****/?", marker.name);
    errors_.add("Q012", comment.begin, "this marker names no stage" + hint);
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
                    fmt::format("a second {} shader; the first is in line {}", shader::stageName(mains[i].stage),
                                placeOf(text_, mains[k].begin).line));
        break;
      }
    }
    if (!hasRayGeneration && std::ranges::all_of(known_, [](bool known) { return known; }))
      errors_.add("Q010", 0, "there is no ray generation shader: a main() marked /**** RAY GENERATION SHADER ****/");
  }

  void addRegion(std::size_t begin, std::size_t end, int owner) {
    if (begin < end) result_.regions.push_back({begin, end, owner});
  }

  // The text between mains, with the COMMON sections cut out of it.
  void addBetween(std::size_t begin, std::size_t end, int owner) {
    std::size_t start = kNone;  // of the COMMON section that is open
    for (auto at = std::ranges::lower_bound(tokens_, begin, {}, &Token::begin); at != tokens_.end() && at->end <= end;
         ++at) {
      const Token& token = *at;
      if (token.kind != TokenKind::comment || token.dead) continue;
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

  std::string_view text_;
  const std::vector<Token>& tokens_;
  LectureErrors& errors_;
  std::vector<Main> found_;
  std::vector<bool> known_;
  LectureSplit result_;
};

}  // namespace

void LectureErrors::add(std::string id, std::size_t offset, std::string problem, shader::Severity severity) {
  if (all_.size() >= kMaxErrors) return;
  const Place place = placeOf(text_, offset);
  all_.push_back({severity, file_, place.line, place.column, std::move(id), std::move(problem)});
}

int LectureSplit::ownerOf(std::size_t offset) const {
  const auto after = std::ranges::upper_bound(regions, offset, {}, &LectureRegion::begin);
  return after == regions.begin() ? kCommonText : std::prev(after)->owner;
}

LectureSplit splitLecture(std::string_view text, const std::vector<Token>& tokens, LectureErrors& errors) {
  return Splitter(text, tokens, errors).split();
}

}  // namespace quintet::program
