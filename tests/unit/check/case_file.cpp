// SPDX-License-Identifier: Apache-2.0
#include "case_file.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <regex>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"

namespace quintet::test {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSection = "//--- ", kWithout = "without ", kRepaired = "repaired/", kExtension = ".case";

struct Line {
  int number = 0;  // in the case file
  std::string text;
};

// "    // FIX: text"
struct Fix {
  enum class Kind { replacement, insertion, deletion };
  Kind kind = Kind::replacement;
  std::string text;       // with the indentation of the mark
  std::size_t count = 1;  // lines that a deletion removes
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& name, const CaseFiles& defaults)
      : text_(text), name_(name), defaults_(defaults) {}

  Case parse() {
    result_.name = name_;
    readSections();
    for (const auto& [name, lines] : sections_)
      if (!name.starts_with(kRepaired)) expand(name, lines);
    for (const auto& [name, lines] : sections_)
      if (name.starts_with(kRepaired)) addRepaired(name.substr(kRepaired.size()), lines);
    addDefaults();
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& text) const {
    throw Error(fmt::format("{}{}:{}: {}", name_, kExtension, line, text));
  }

  void readSections() {
    std::vector<Line>* section = nullptr;
    int number = 0;
    for (std::size_t begin = 0; begin < text_.size();) {
      const std::size_t end = text_.find('\n', begin);
      ++number;
      if (end == text_.npos) fail(number, "the last line does not end with a line break");
      const std::string line(text_.substr(begin, end - begin));
      begin = end + 1;
      if (line.starts_with(kSection))
        section = startSection(number, line.substr(kSection.size()));
      else if (section)
        section->push_back({number, line});
      else
        fail(number, "this line is in no section; a section starts with '//--- NAME'");
    }
    if (sections_.empty()) fail(std::max(number, 1), "the case has no section");
  }

  // Returns the lines of the new section; null after `without`.
  std::vector<Line>* startSection(int number, const std::string& name) {
    static const std::regex kName("(repaired/)?[A-Za-z0-9_][A-Za-z0-9_.]*");
    if (name.starts_with(kWithout)) {
      const std::string file = name.substr(kWithout.size());
      if (!defaults_.contains(file)) fail(number, "'" + file + "' is not a default file");
      without_.emplace(file, number);
      return nullptr;
    }
    if (!std::regex_match(name, kName)) fail(number, "'" + name + "' is not the name of a file");
    const auto [at, isNew] = sections_.emplace(name, std::vector<Line>());
    if (!isNew) fail(number, "the section '" + name + "' already exists");
    starts_[name] = number;
    return &at->second;
  }

  std::optional<Fix> fixIn(const Line& line) const {
    if (line.text.find(" FIX") == line.text.npos) return {};
    static const std::regex kAny("\\s*(//|#) FIX\\b.*"),
        kFix("(\\s*)(?://|#) FIX(?:(-INSERT)?:(?: (.*))?|(-DELETE)(?: ([1-9][0-9]?))?)");
    if (!std::regex_match(line.text, kAny)) return {};
    std::smatch match;
    if (!std::regex_match(line.text, match, kFix))
      fail(line.number, "unknown mark; write 'FIX: text', 'FIX-INSERT: text', 'FIX-DELETE' or 'FIX-DELETE COUNT'");
    if (match[4].matched) {
      Fix fix{Fix::Kind::deletion, {}, 1};
      if (match[5].matched) std::from_chars(&*match[5].first, &*match[5].first + match[5].length(), fix.count);
      return fix;
    }
    const std::string text = match[3].str();
    return Fix{match[2].matched ? Fix::Kind::insertion : Fix::Kind::replacement,
               text.empty() ? text : match[1].str() + text};
  }

  // Both versions of a file: with the mistake, and without its EXPECT marks and with its fixes.
  void expand(const std::string& name, const std::vector<Line>& lines) {
    struct Kept {
      std::string text;
      bool original = true;
    };
    std::string mistaken;
    std::vector<Kept> kept;
    bool differs = false, afterExpectation = false;
    const auto remove = [&](const Line& mark, std::size_t count) {
      if (afterExpectation)
        fail(mark.number, "the line before is an EXPECT mark; a fix follows the line that it changes");
      if (count > kept.size()) fail(mark.number, "the section has too few lines before the mark");
      for (; count > 0; --count, kept.pop_back())
        if (!kept.back().original) fail(mark.number, "a fix cannot change a line that another fix adds");
    };
    for (const Line& line : lines) {
      if (const std::optional<Fix> fix = fixIn(line)) {
        differs = true;
        if (fix->kind != Fix::Kind::insertion) remove(line, fix->count);
        if (fix->kind != Fix::Kind::deletion) kept.push_back({fix->text, false});
        afterExpectation = false;
        continue;
      }
      mistaken += line.text + '\n';
      result_.lines[name].push_back(line.number);
      const std::optional<std::string> text = withoutExpectation(line.text);
      differs |= text != line.text;
      if (text) kept.push_back({*text});
      afterExpectation = !text;
    }
    result_.files[name] = std::move(mistaken);
    if (!differs) return;
    const auto other = starts_.find(std::string(kRepaired) + name);
    if (other != starts_.end() && std::ranges::any_of(kept, [](const Kept& line) { return !line.original; }))
      fail(other->second, "'" + name + "' has FIX marks, too");
    std::string& repaired = result_.fixed[name];
    for (const Kept& line : kept) repaired += line.text + '\n';
  }

  // Returns the line without its EXPECT mark; empty if it has nothing else.
  static std::optional<std::string> withoutExpectation(const std::string& line) {
    if (line.find(" EXPECT") == line.npos) return line;
    static const std::regex kMark("\\s*(//|#) EXPECT(\\+1)? Q[0-9]{3}$");
    std::string rest = std::regex_replace(line, kMark, "");
    if (rest.empty()) return {};
    return rest;
  }

  void addRepaired(const std::string& name, const std::vector<Line>& lines) {
    std::string text;
    for (const Line& line : lines) {
      if (fixIn(line)) fail(line.number, "a repaired section cannot have FIX marks");
      text += line.text + '\n';
    }
    if (const auto old = result_.files.find(name); old != result_.files.end() && old->second == text)
      fail(starts_.at(std::string(kRepaired) + name), "the repaired version is equal to the section '" + name + "'");
    result_.fixed[name] = text;
  }

  // A default file belongs to the case if the case, or a default file that belongs to it, has its name in quotes.
  void addDefaults() {
    std::string names(text_);
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& [name, text] : defaults_) {
        if (result_.files.contains(name) || without_.contains(name) || names.find('"' + name + '"') == names.npos)
          continue;
        result_.files[name] = text;
        names += text;
        changed = true;
      }
    }
    for (const auto& [name, number] : without_) {
      if (result_.files.contains(name)) fail(number, "the case has a section '" + name + "'");
      if (names.find('"' + name + '"') == names.npos)
        fail(number, "no file of the case names '" + name + "': remove this line");
    }
  }

  std::string_view text_;
  const std::string& name_;
  const CaseFiles& defaults_;
  std::map<std::string, std::vector<Line>> sections_;
  std::map<std::string, int> starts_, without_;  // the lines of the case file
  Case result_;
};

CaseFiles filesIn(const fs::path& folder) {
  CaseFiles files;
  if (!fs::is_directory(folder)) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().filename().string()] = readTextFile(entry.path());
  return files;
}

}  // namespace

CaseFiles Case::allFixed() const {
  CaseFiles all = fixed;
  all.insert(files.begin(), files.end());
  return all;
}

std::string Case::locationOf(const std::string& file, int line) const {
  const auto found = lines.find(file);
  if (found == lines.end() || line < 1 || line > static_cast<int>(found->second.size())) return {};
  return fmt::format("{}{}:{}", name, kExtension, found->second[static_cast<std::size_t>(line - 1)]);
}

Case parseCase(std::string_view text, const std::string& name, const CaseFiles& defaults) {
  return Parser(text, name, defaults).parse();
}

Case readCase(const fs::path& file) {
  return parseCase(readTextFile(file), file.stem().string(), filesIn(file.parent_path().parent_path() / "default"));
}

std::vector<fs::path> casesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == kExtension) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

void writeCase(const Case& program, const fs::path& folder) {
  const auto write = [](const CaseFiles& files, const fs::path& to) {
    if (files.empty()) return;
    fs::create_directories(to);
    for (const auto& [name, text] : files) writeFile(to / name, text);
  };
  write(program.files, folder);
  write(program.fixed, folder / "repaired");
}

}  // namespace quintet::test
