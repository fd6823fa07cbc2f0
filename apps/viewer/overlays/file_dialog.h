// SPDX-License-Identifier: Apache-2.0
// A dialog that chooses a file to open, or a name to save the image or an explanation.
#ifndef QUINTET_APPS_VIEWER_OVERLAYS_FILE_DIALOG_H
#define QUINTET_APPS_VIEWER_OVERLAYS_FILE_DIALOG_H

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "viewer/folder_listing.h"

namespace quintet::viewer {

class FileDialog {
 public:
  enum class Purpose { open, reference, save, saveExplanation };

  // They start in the folder of the last choice.
  void open();
  void openReference();
  void save(const std::string& name);
  void saveExplanation(const std::string& name);
  void close() { visible_ = false; }
  bool visible() const { return visible_; }
  // The field for the name gets the focus in one of the next frames. Until then, characters must wait.
  bool awaitsFocus() const { return visible_ && framesUntilFocus_ > 0; }
  Purpose purpose() const { return purpose_; }

  // Draws the dialog. Returns the path when the user has chosen one; the dialog is then closed. `scale`: size of text
  // and controls.
  std::optional<std::filesystem::path> draw(float scale);

 private:
  bool opensFile() const { return purpose_ == Purpose::open || purpose_ == Purpose::reference; }
  void show(Purpose purpose, const std::string& name);
  void enter(const std::filesystem::path& folder);
  void list();  // shows entries_
  std::optional<std::filesystem::path> choose(const std::filesystem::path& path);

  bool visible_ = false, focus_ = false;
  int framesUntilFocus_ = 0;  // at most
  Purpose purpose_ = Purpose::open;
  std::filesystem::path folder_;
  std::string name_;
  std::string error_;
  std::filesystem::path confirmed_;  // the existing file that a second save replaces
  std::vector<FolderEntry> entries_;
  std::optional<std::filesystem::path> chosen_;  // by a double click in the list
};

}  // namespace quintet::viewer
#endif
