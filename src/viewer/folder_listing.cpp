// SPDX-License-Identifier: Apache-2.0
#include "viewer/folder_listing.h"

#include <algorithm>
#include <system_error>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace quintet::viewer {

std::vector<FolderEntry> listFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<FolderEntry> entries;
  auto entry = std::filesystem::directory_iterator(folder, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    FolderEntry item;
    item.name = entry->path().filename().string();
    std::error_code ignored;  // a link to a missing file is not a folder
    item.folder = entry->is_directory(ignored);
    item.use = useOfFile(entry->path());
    if (!item.name.starts_with('.') && (item.folder || item.use != FileUse::unknown))
      entries.push_back(std::move(item));
    entry.increment(error);
  }
  if (error) throw FileError(folder, fmt::format("cannot read the folder: {}", error.message()));
  std::ranges::sort(entries, {},
                    [](const FolderEntry& item) { return std::tuple(!item.folder, lowerCase(item.name), item.name); });
  return entries;
}

}  // namespace quintet::viewer
