// SPDX-License-Identifier: Apache-2.0
#include "lab/named_files.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"
#include "base/text.h"
#include "base/toml_value.h"
#include "lab/little_endian.h"
#include "lab/project_folder.h"
#include "lab/request_target.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "shader/include_resolver.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxText = std::size_t{64} << 20;  // bytes

void collectTexts(const TomlValue& value, std::vector<std::string>& names) {
  if (value.kind == TomlValue::Kind::text) names.push_back(value.text);
  for (const TomlValue& element : value.elements) collectTexts(element, names);
  for (const TomlMember& member : value.members) collectTexts(member.value, names);
}

// The values of all members "uri", also of extensions. Depth is limited by parseJson().
void collectUris(const nlohmann::json& value, std::vector<std::string>& names) {
  for (const auto& [key, member] : value.items()) {
    if (key == "uri" && member.is_string() && !member.get_ref<const std::string&>().starts_with("data:")) {
      const std::string uri = member.get<std::string>();
      names.push_back(uri);
      if (const auto decoded = decodePercent(uri)) names.push_back(*decoded);
    }
    if (member.is_structured()) collectUris(member, names);
  }
}

// The JSON of a glTF file, which a binary one has in its first chunk.
std::string gltfJson(const fs::path& file) {
  constexpr std::size_t kJsonOffset = 20, kLength = 12;
  std::ifstream stream(file, std::ios::binary);
  std::string header(kJsonOffset, '\0');
  stream.read(header.data(), static_cast<std::streamsize>(header.size()));
  if (stream.gcount() != static_cast<std::streamsize>(kJsonOffset) || !header.starts_with("glTF"))
    return readTextFile(file);
  std::string json(std::min<std::size_t>(integerAt(header, kLength, 4), kMaxText), '\0');
  stream.read(json.data(), static_cast<std::streamsize>(json.size()));
  json.resize(static_cast<std::size_t>(stream.gcount()));
  return json;
}

// As the file writes them: relative to its folder.
std::vector<std::string> namesIn(const fs::path& file) {
  std::vector<std::string> names;
  std::error_code error;
  const std::string name = lowerCase(file.filename().string());
  try {
    if (name.ends_with(".glb") || name.ends_with(".gltf")) {
      collectUris(parseJson(gltfJson(file)), names);
    } else if (name.ends_with(".scene.toml")) {
      if (fs::file_size(file, error) <= kMaxText) collectTexts(parseToml(readTextFile(file), file), names);
    } else if (fs::file_size(file, error) <= program::kMaxLectureBytes) {
      const std::string text = readTextFile(file);
      for (const shader::IncludeDirective& include : shader::findIncludes(text))
        if (include.quoted) names.emplace_back(include.name);
    }
    if (name.ends_with(program::kLectureExtension))
      for (const auto& [part, text] : program::loadProgram(file.string()).files) names.push_back(part);
  } catch (const Error&) {  // the page shows what is wrong with it
  } catch (const nlohmann::json::exception&) {
  }
  return names;
}

}  // namespace

std::vector<std::string> namedFiles(const fs::path& folder, const std::string& file) {
  std::set<std::string> found{file};
  std::deque<std::string> open{file};
  while (!open.empty()) {
    const fs::path current = open.front();
    open.pop_front();
    for (const std::string& written : namesIn(folder / current)) {
      // An include can also be relative to the program.
      for (const fs::path& base : {current.parent_path(), fs::path()}) {
        const std::string name = (base / written).lexically_normal().generic_string();
        std::error_code error;
        if (found.size() == kMaxNamedFiles || !isFileName(name) || !fs::is_regular_file(folder / name, error)) continue;
        if (found.insert(name).second) open.push_back(name);
      }
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace quintet::lab
