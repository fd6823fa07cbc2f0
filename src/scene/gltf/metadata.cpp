// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/metadata.h"

#include <fmt/format.h>

#include <map>
#include <string>

#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

using nlohmann::json;

// JSON pointers of the objects that refer to each packet, separated by ", ".
std::map<std::size_t, std::string> findObjects(const json& checked) {
  std::map<std::size_t, std::string> objects;
  const auto note = [&](const json& object, const std::string& location) {
    const json::json_pointer pointer(fmt::format("/extensions/{}/packet", kXmp));
    if (!object.contains(pointer)) return;
    std::string& list = objects[object[pointer].get<std::size_t>()];
    list += (list.empty() ? "" : ", ") + location;
  };
  note(checked["asset"], "/asset");
  for (const char* kind : {"scenes", "nodes", "meshes", "materials", "images"})
    if (const auto array = checked.find(kind); array != checked.end())
      for (std::size_t i = 0; i < array->size(); ++i) note((*array)[i], fmt::format("/{}/{}", kind, i));
  return objects;
}

// One line for a value: the elements of a list, the texts of language alternatives with their languages.
std::string textOf(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_structured()) return value.dump();
  if (value.is_object() && value.contains("@value")) {
    const std::string text = textOf(value["@value"]);
    return value.contains("@language") ? fmt::format("{} ({})", text, textOf(value["@language"])) : text;
  }
  std::string list;
  for (const auto& [key, element] : value.items())
    if (key != "@type") list += (list.empty() ? "" : ", ") + textOf(element);
  return list;
}

bool isStructure(const json& value) {
  return value.is_object() && !value.contains("@list") && !value.contains("@set") && !value.contains("@value") &&
         !(value.contains("@type") && value["@type"] == "rdf:Alt");
}

void addProperties(const json& object, const std::string& prefix, const std::string& owner,
                   std::vector<MetadataEntry>& entries) {
  for (const auto& [key, value] : object.items()) {
    if (key == "@context") continue;
    if (isStructure(value))
      addProperties(value, prefix + key + "/", owner, entries);
    else
      entries.push_back({owner, prefix + key, textOf(value)});
  }
}

}  // namespace

std::vector<MetadataEntry> readMetadata(const json& checked) {
  std::vector<MetadataEntry> entries;
  const json::json_pointer pointer(fmt::format("/extensions/{}/packets", kXmp));
  if (!checked.contains(pointer)) return entries;
  const json& packets = checked[pointer];
  std::map<std::size_t, std::string> objects = findObjects(checked);
  for (std::size_t i = 0; i < packets.size(); ++i)
    if (packets[i].is_object()) addProperties(packets[i], "", objects[i], entries);
  return entries;
}

}  // namespace quintet::scene
