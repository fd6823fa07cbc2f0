// SPDX-License-Identifier: Apache-2.0
// Cameras that the user has kept, for each scene, as a JSON file in the user's configuration folder.
#ifndef QUINTET_VIEWER_BOOKMARKS_H
#define QUINTET_VIEWER_BOOKMARKS_H

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "job/request.h"

namespace quintet::viewer {

struct Bookmark {
  std::string name;
  job::CameraRequest camera;
  bool operator==(const Bookmark&) const = default;
};

class Bookmarks {
 public:
  // The bookmarks in `file`; none if it does not exist. Throws FileError.
  static Bookmarks read(const std::filesystem::path& file);
  // Throws FileError.
  void write(const std::filesystem::path& file) const;

  // `scene`: an absolute path, or the name of a built-in scene.
  const std::vector<Bookmark>& of(const std::string& scene) const;
  // Names it "Bookmark 1", "Bookmark 2", …: the first free one. Returns the name.
  std::string add(const std::string& scene, const job::CameraRequest& camera);
  // `index` is that in of(scene).
  void rename(const std::string& scene, std::size_t index, const std::string& name);
  // The first one that is equal, if there is one.
  void remove(const std::string& scene, const Bookmark& bookmark);

 private:
  std::map<std::string, std::vector<Bookmark>> byScene_;
};

}  // namespace quintet::viewer
#endif
