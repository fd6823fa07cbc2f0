// SPDX-License-Identifier: Apache-2.0
// Opens what the user chose or dropped, and stores settings and bookmarks.
#ifndef QUINTET_APPS_VIEWER_VIEW_FILES_H
#define QUINTET_APPS_VIEWER_VIEW_FILES_H

#include <filesystem>
#include <functional>
#include <string>

#include "view_state.h"

namespace quintet::viewer {

// The key of the bookmarks of the session's scene: an absolute path, or the name of the program whose own scene it is.
std::string sceneKey(const Snapshot& snapshot);

// A scene or program replaces the current one; the program stays with a new scene, and the scene with a new program,
// which can be undone. An environment, a reference image or an explanation is used for the current scene. Other files
// cause a message.
void openFile(ViewState& state, const std::string& path);
// The image to compare with: a file of any format.
void useReference(ViewState& state, const std::string& path);
// One of Settings::recentFiles. If it no longer exists, this is a message, and the session continues.
void openRecent(ViewState& state, const std::string& file);
// A built-in program on its own scene.
void openLesson(ViewState& state, const std::string& program);

// Reads the scene file again with a change of how it is read, such as another material variant. The view, the program and
// its parameters stay; edits of materials, lights and objects are lost, and so are the steps of undo.
void reopenScene(ViewState& state, const std::function<void(job::RenderRequest&)>& change);

// As JSON, with the command that explains the pixel if it is known. Errors become messages.
void saveExplanation(ViewState& state, const std::filesystem::path& file);

// Settings and bookmarks. A file that cannot be read is renamed and causes a message, and the defaults are used.
void readStoredFiles(ViewState& state);
// These read the file of the bookmarks again, because another window can have changed it. Errors become messages.
void addBookmark(ViewState& state);
void removeBookmark(ViewState& state, const Bookmark& bookmark);
void storeSettings(ViewState& state);

}  // namespace quintet::viewer
#endif
