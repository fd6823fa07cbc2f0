// SPDX-License-Identifier: Apache-2.0
#include "shader/include_resolver.h"

#include <algorithm>
#include <cstdint>
#include <system_error>

#include "base/error.h"
#include "base/file.h"

namespace quintet::shader {
namespace {

namespace fs = std::filesystem;

// Shaders are small. The limit rejects wrong paths, such as a model or a log file.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 20;

// The preprocessor writes names into #line "name" directives, so they must not end that string.
std::string printable(std::string name) {
  for (char& c : name)
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  return name;
}

std::string normalized(const fs::path& path) { return path.lexically_normal().generic_string(); }
bool leavesItsRoot(const std::string& path) {
  return path.empty() || path.front() == '/' || path == ".." || path.starts_with("../");
}
bool inBrackets(std::string_view name) { return name.size() > 2 && name.front() == '<' && name.back() == '>'; }

std::size_t skipBlanks(std::string_view text, std::size_t at) {
  while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  return at;
}

}  // namespace

std::vector<IncludeDirective> findIncludes(std::string_view text) {
  constexpr std::string_view kInclude = "include";
  std::vector<IncludeDirective> found;
  for (std::size_t hash = text.find('#'); hash != text.npos; hash = text.find('#', hash + 1)) {
    std::size_t at = skipBlanks(text, hash + 1);
    if (text.substr(at, kInclude.size()) != kInclude) continue;
    at = skipBlanks(text, at + kInclude.size());
    if (at >= text.size() || (text[at] != '"' && text[at] != '<')) continue;
    const bool quoted = text[at] == '"';
    const std::size_t end = text.find_first_of(quoted ? "\"\n" : ">\n", at + 1);
    if (end == text.npos || text[end] == '\n') continue;
    found.push_back({text.substr(at + 1, end - at - 1), quoted});
  }
  return found;
}

IncludeResolver::IncludeResolver(const Source& source, const CompilerOptions& options,
                                 std::span<const EmbeddedFile> library)
    : source_(source), options_(options), library_(library) {
  root_.name =
      printable(source.name.empty() ? "<shader" + std::string(stageExtension(source.stage)) + ">" : source.name);
  root_.text = source.text;
  if (inBrackets(source.name)) {
    root_.libraryPath = normalized(source.name.substr(1, source.name.size() - 2));
  } else {
    root_.diskPath = source.name;
  }
}

const SourceFile* IncludeResolver::keep(SourceFile file) {
  file.name = printable(std::move(file.name));
  const auto [at, isNew] = files_.try_emplace(file.name);
  SourceFile& kept = at->second;
  if (isNew) {
    kept = std::move(file);
    if (!kept.diskPath.empty()) kept.text = kept.storage;
  }
  return &kept;
}

const SourceFile* IncludeResolver::inVirtualFiles(const std::string& name) {
  auto at = source_.virtualFiles.find(name);
  if (at == source_.virtualFiles.end()) at = source_.virtualFiles.find("<" + name + ">");
  if (at == source_.virtualFiles.end()) return nullptr;
  return keep({.name = "<" + name + ">", .libraryPath = name, .diskPath = {}, .text = at->second, .storage = {}});
}

const SourceFile* IncludeResolver::onDisk(const fs::path& path, const std::string& libraryPath) {
  const std::string name = printable(normalized(path));
  if (const auto known = files_.find(name); known != files_.end()) return &known->second;
  std::error_code failed;
  if (!fs::is_regular_file(path, failed) || fs::file_size(path, failed) > kMaxFileBytes || failed) return nullptr;
  try {
    return keep(
        {.name = name, .libraryPath = libraryPath, .diskPath = path, .text = {}, .storage = readTextFile(path)});
  } catch (const FileError&) {
    return nullptr;  // unreadable, or removed in the meantime
  }
}

// Returns a file that the program names itself; null if it does not exist or is outside of the include roots.
const SourceFile* IncludeResolver::ofProgram(const fs::path& path, const std::string& libraryPath) {
  return roots_.allows(path) ? onDisk(path, libraryPath) : nullptr;
}

const SourceFile* IncludeResolver::inLibrary(const std::string& name) {
  if (leavesItsRoot(name)) return fs::path(name).is_absolute() ? ofProgram(name, {}) : nullptr;
  if (const SourceFile* file = inVirtualFiles(name)) return file;
  if (!options_.libraryOverride.empty())
    if (const SourceFile* file = onDisk(options_.libraryOverride / name, name)) return file;
  const auto at = std::ranges::lower_bound(library_, std::string_view(name), {}, &EmbeddedFile::path);
  if (at != library_.end() && at->path == name)
    return keep({.name = "<" + name + ">", .libraryPath = name, .diskPath = {}, .text = at->data, .storage = {}});
  for (const fs::path& folder : options_.includeFolders)
    if (const SourceFile* file = onDisk(folder / name, name)) return file;
  return nullptr;
}

// A virtual file has the path that it would have on disk: a file of a program can include files outside of its folder.
std::optional<fs::path> IncludeResolver::folderOnDisk(const SourceFile& from) const {
  if (!from.diskPath.empty()) return from.diskPath.parent_path();
  if (from.libraryPath.empty() || !source_.virtualFiles.contains(from.libraryPath)) return std::nullopt;
  return fs::path(from.libraryPath).parent_path();
}

const SourceFile* IncludeResolver::resolve(const SourceFile& from, const IncludeDirective& include) {
  if (include.name.empty() || include.name.find('\0') != include.name.npos) return nullptr;
  const fs::path name(include.name);
  if (include.quoted && !name.is_absolute()) {
    const std::string inLibraryPath =
        from.libraryPath.empty() ? "" : normalized(fs::path(from.libraryPath).parent_path() / name);
    const std::optional<fs::path> folder = folderOnDisk(from);
    const std::string besideOnDisk = folder ? normalized(*folder / name) : "";
    for (const std::string& candidate : {inLibraryPath, besideOnDisk})
      if (!candidate.empty())
        if (const SourceFile* file = inVirtualFiles(candidate)) return file;
    if (!besideOnDisk.empty())
      if (const SourceFile* file = ofProgram(besideOnDisk, leavesItsRoot(inLibraryPath) ? "" : inLibraryPath))
        return file;
    if (!inLibraryPath.empty())
      if (const SourceFile* file = inLibrary(inLibraryPath)) return file;
  }
  return inLibrary(normalized(name));
}

const SourceFile* IncludeResolver::find(std::string_view name) const {
  if (name == root_.name) return &root_;
  const auto at = files_.find(name);
  return at == files_.end() ? nullptr : &at->second;
}

std::string_view IncludeResolver::textOf(std::string_view name) const {
  if (const SourceFile* file = find(name)) return file->text;
  const auto at = source_.virtualFiles.find(std::string(name));
  return at == source_.virtualFiles.end() ? std::string_view() : std::string_view(at->second);
}

std::vector<const SourceFile*> IncludeResolver::files() const {
  std::vector<const SourceFile*> all{&root_};
  for (const auto& [name, file] : files_) all.push_back(&file);
  return all;
}

std::vector<std::string> IncludeResolver::searchedFolders(const SourceFile& from, bool quoted) const {
  std::vector<std::string> folders;
  if (const std::optional<fs::path> folder = folderOnDisk(from); quoted && folder) {
    const std::string name = normalized(*folder);
    folders.push_back(name.empty() ? "." : name);
  }
  if (!options_.libraryOverride.empty()) folders.push_back(options_.libraryOverride.generic_string());
  folders.push_back(library_.empty() ? "the built-in library (empty)" : "the built-in library");
  for (const fs::path& folder : options_.includeFolders) folders.push_back(folder.generic_string());
  return folders;
}

}  // namespace quintet::shader
