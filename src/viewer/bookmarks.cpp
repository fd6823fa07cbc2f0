// SPDX-License-Identifier: Apache-2.0
#include "viewer/bookmarks.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"

namespace quintet::viewer {
namespace {

using nlohmann::json;

json toJson(const vec3& v) { return {v.x, v.y, v.z}; }

vec3 toVec3(const json& value) {
  const auto numbers = value.get<std::vector<float>>();
  if (numbers.size() != 3) throw json::other_error::create(501, "a point has three numbers", nullptr);
  return {numbers[0], numbers[1], numbers[2]};
}

json toJson(const Bookmark& bookmark) {
  const job::CameraRequest& camera = bookmark.camera;
  json object{{"name", bookmark.name}, {"up", toJson(camera.up)}};
  if (!camera.name.empty()) object["camera"] = camera.name;
  if (camera.lookFrom) object["from"] = toJson(*camera.lookFrom);
  if (camera.lookAt) object["at"] = toJson(*camera.lookAt);
  if (camera.verticalFov) object["fov"] = *camera.verticalFov;
  if (camera.apertureRadius) object["aperture"] = *camera.apertureRadius;
  if (camera.focusDistance) object["focus"] = *camera.focusDistance;
  return object;
}

Bookmark fromJson(const json& object) {
  Bookmark bookmark;
  bookmark.name = object.at("name").get<std::string>();
  job::CameraRequest& camera = bookmark.camera;
  camera.up = toVec3(object.at("up"));
  if (object.contains("camera")) camera.name = object["camera"].get<std::string>();
  const auto point = [&](const char* name, std::optional<vec3>& target) {
    if (object.contains(name)) target = toVec3(object[name]);
  };
  const auto number = [&](const char* name, std::optional<float>& target) {
    if (object.contains(name)) target = object[name].get<float>();
  };
  point("from", camera.lookFrom);
  point("at", camera.lookAt);
  number("fov", camera.verticalFov);
  number("aperture", camera.apertureRadius);
  number("focus", camera.focusDistance);
  return bookmark;
}

}  // namespace

Bookmarks Bookmarks::read(const std::filesystem::path& file) {
  Bookmarks result;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return result;
  try {
    const json object = parseJson(file, readTextFile(file));
    for (const auto& [scene, list] : object.items())
      for (const json& item : list) result.byScene_[scene].push_back(fromJson(item));
  } catch (const json::exception& failure) {
    throw FileError(file, fmt::format("the bookmarks are invalid: {}", failure.what()));
  }
  return result;
}

void Bookmarks::write(const std::filesystem::path& file) const {
  json object = json::object();
  for (const auto& [scene, bookmarks] : byScene_)
    for (const Bookmark& bookmark : bookmarks) object[scene].push_back(toJson(bookmark));
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) throw FileError(file.parent_path(), fmt::format("cannot create the folder: {}", error.message()));
  writeFile(file, object.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

const std::vector<Bookmark>& Bookmarks::of(const std::string& scene) const {
  static const std::vector<Bookmark> kNone;
  const auto found = byScene_.find(scene);
  return found == byScene_.end() ? kNone : found->second;
}

std::string Bookmarks::add(const std::string& scene, const job::CameraRequest& camera) {
  std::vector<Bookmark>& list = byScene_[scene];
  std::string name;
  for (std::size_t number = 1; name.empty(); ++number) {
    const std::string candidate = fmt::format("Bookmark {}", number);
    if (std::ranges::find(list, candidate, &Bookmark::name) == list.end()) name = candidate;
  }
  list.push_back({name, camera});
  return name;
}

void Bookmarks::rename(const std::string& scene, std::size_t index, const std::string& name) {
  byScene_.at(scene).at(index).name = name;
}

void Bookmarks::remove(const std::string& scene, const Bookmark& bookmark) {
  const auto list = byScene_.find(scene);
  if (list == byScene_.end()) return;
  const auto found = std::ranges::find(list->second, bookmark);
  if (found != list->second.end()) list->second.erase(found);
  if (list->second.empty()) byScene_.erase(list);
}

}  // namespace quintet::viewer
