#include "program/lecture_functions.h"

#include <algorithm>
#include <map>
#include <set>

namespace quintet::program {
namespace {

using Words = std::set<std::string_view>;

struct Function {
  std::string_view name;
  TextRange range;
  Words words;  // in its body and its head
};

class Reader {
 public:
  Reader(std::string_view text, const std::vector<Token>& tokens, const LectureSplit& split)
      : text_(text), tokens_(tokens), split_(split) {}

  // Definitions at the outermost level of the common text: a ')' followed by a '{', and what is around them.
  std::vector<Function> functions() const {
    std::vector<Function> found;
    std::size_t start = kNone;     // of the declaration that is being read
    std::size_t name = kNone;      // the word before its first '('
    std::size_t previous = kNone;  // code token
    for (std::size_t i = nextCode(tokens_, 0); i < tokens_.size(); i = nextCode(tokens_, i + 1)) {
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

  // Of conditionals, too.
  void addWords(const Token& token, Words& words) const {
    if (token.kind == TokenKind::word) words.insert(textOf(text_, token));
    if (token.kind == TokenKind::directive && directiveOf(textOf(text_, token)).name != "define")
      words.merge(wordsOfLine(textOf(text_, token)));
  }

  // A macro is as good as a function that names what its line names.
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
  static constexpr std::size_t kNone = std::string_view::npos;

  static Words wordsOfLine(std::string_view line) {
    Words words;
    line.remove_prefix(1);  // the '#'
    for (const Token& part : tokenize(line))
      if (part.kind == TokenKind::word) words.insert(textOf(line, part));
    return words;
  }
  bool isMark(std::size_t i, char c) const {
    return i < tokens_.size() && tokens_[i].kind == TokenKind::mark && text_[tokens_[i].begin] == c;
  }
  bool isCommon(std::size_t i) const { return split_.ownerOf(tokens_[i].begin) == kCommonText; }

  void open(std::vector<Function>& found, std::size_t start, std::size_t name) const {
    if (tokens_[name].kind == TokenKind::word)
      found.push_back({textOf(text_, tokens_[name]), {tokens_[start].begin, 0}, {}});
  }

  std::string_view text_;
  const std::vector<Token>& tokens_;
  const LectureSplit& split_;
};

// Names that `words` lead to over the functions.
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

}  // namespace

std::vector<std::vector<TextRange>> unusedFunctions(std::string_view text, const std::vector<Token>& tokens,
                                                    const LectureSplit& split) {
  const Reader reader(text, tokens, split);
  const std::vector<Function> functions = reader.functions();
  std::multimap<std::string_view, const Function*> byName;
  for (const Function& f : functions) byName.emplace(f.name, &f);
  const std::vector<Function> macros = reader.macros();
  for (const Function& m : macros) byName.emplace(m.name, &m);

  // What stands outside the functions, by owner.
  std::vector<Words> own(split.mains.size());
  Words common;
  std::size_t next = 0;
  for (const Token& token : tokens) {
    while (next < functions.size() && functions[next].range.second <= token.begin) ++next;
    if (token.dead || (next < functions.size() && functions[next].range.first <= token.begin)) continue;
    const int owner = split.ownerOf(token.begin);
    reader.addWords(token, owner == kCommonText ? common : own[static_cast<std::size_t>(owner)]);
  }
  Words everywhere;
  for (Words& words : own) {
    words.insert(common.begin(), common.end());
    words = closure(std::move(words), byName);
    everywhere.insert(words.begin(), words.end());
  }

  std::vector<std::vector<TextRange>> unused(split.mains.size());
  for (std::size_t i = 0; i < unused.size(); ++i) {
    const bool first = split.mains[i].stage == shader::Stage::rayGeneration;
    for (const Function& f : functions)
      if (!own[i].count(f.name) && !(first && !everywhere.count(f.name))) unused[i].push_back(f.range);
  }
  return unused;
}

}  // namespace quintet::program
