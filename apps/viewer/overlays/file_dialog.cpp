// SPDX-License-Identifier: Apache-2.0
#include "overlays/file_dialog.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "base/error.h"
#include "base/text.h"
#include "gui/widgets.h"

namespace quintet::viewer {
namespace {

constexpr int kMostFramesUntilFocus = 8;

const char* useText(const FolderEntry& entry) {
  switch (entry.use) {
    case FileUse::scene: return "scene";
    case FileUse::program: return "program";
    case FileUse::environment: return "environment";
    case FileUse::reference: return "reference image";
    case FileUse::explanation: return "explanation";
    case FileUse::unknown: break;
  }
  return "";
}

}  // namespace

void FileDialog::open() { show(Purpose::open, {}); }
void FileDialog::openReference() { show(Purpose::reference, {}); }
void FileDialog::save(const std::string& name) { show(Purpose::save, name); }
void FileDialog::saveExplanation(const std::string& name) { show(Purpose::saveExplanation, name); }

void FileDialog::show(Purpose purpose, const std::string& name) {
  purpose_ = purpose;
  name_ = name;
  visible_ = focus_ = true;
  framesUntilFocus_ = kMostFramesUntilFocus;
  enter(folder_);
}

// Stays in the current folder if the new one cannot be read.
void FileDialog::enter(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path target = folder.empty() ? std::filesystem::current_path(error) : folder;
  target = std::filesystem::absolute(target, error).lexically_normal();
  try {
    entries_ = listFolder(target);
    folder_ = target;
    confirmed_.clear();
    error_.clear();
  } catch (const Error& failure) {
    error_ = failure.what();
  }
}

void FileDialog::list() {
  for (const FolderEntry& entry : entries_) {
    const std::string label = entry.folder ? entry.name + "/" : entry.name;
    if (ImGui::Selectable(label.c_str(), entry.name == name_, ImGuiSelectableFlags_AllowDoubleClick)) {
      const bool twice = ImGui::IsMouseDoubleClicked(0);
      if (!entry.folder || entry.use == FileUse::program) name_ = entry.name;
      if (twice && entry.folder && entry.use != FileUse::program)
        return enter(folder_ / entry.name);  // changes entries_
      if (twice && (!entry.folder || opensFile())) chosen_ = folder_ / entry.name;
    }
    const char* use = useText(entry);
    const float width = ImGui::CalcTextSize(use).x;
    ImGui::SameLine(std::max(ImGui::GetWindowWidth() - width - 2.0f * ImGui::GetStyle().ScrollbarSize, 0.0f));
    ImGui::TextDisabled("%s", use);
  }
}

std::optional<std::filesystem::path> FileDialog::choose(const std::filesystem::path& path) {
  if (opensFile()) {
    std::error_code error;
    if (useOfFile(path) == FileUse::unknown && std::filesystem::is_directory(path, error)) {
      enter(path);
      name_.clear();
      return std::nullopt;
    }
    if (!std::filesystem::exists(path, error)) {
      error_ = fmt::format("{}: file not found", path.string());
      return std::nullopt;
    }
  } else if (purpose_ == Purpose::saveExplanation) {
    if (lowerCase(path.extension().string()) != ".json") {
      error_ = "the name must end with .json";
      return std::nullopt;
    }
  } else {
    const std::string extension = lowerCase(path.extension().string());
    if (extension != ".png" && extension != ".exr" && extension != ".hdr") {
      error_ = "the name must end with .png, .exr or .hdr";
      return std::nullopt;
    }
  }
  std::error_code error;
  if (!opensFile() && path != confirmed_ && std::filesystem::exists(path, error)) {
    error_ = fmt::format("{}: the file exists; save again to replace it", path.filename().string());
    confirmed_ = path;
    focus_ = true;  // so that Enter saves again
    return std::nullopt;
  }
  visible_ = false;
  return path;
}

std::optional<std::filesystem::path> FileDialog::draw(float scale) {
  if (!visible_) return std::nullopt;
  framesUntilFocus_ = std::max(framesUntilFocus_ - 1, 0);
  chosen_.reset();
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const bool opens = opensFile();
  ImGui::SetNextWindowPos({0.5f * display.x, 0.5f * display.y}, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(620.0f * scale, display.x), std::min(480.0f * scale, display.y)},
                           ImGuiCond_Appearing);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6.0f * scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0f);
  const bool isImage = purpose_ == Purpose::save;
  const char* title = purpose_ == Purpose::reference ? "Compare with an image###files"
                      : opens                        ? "Open###files"
                      : isImage                      ? "Save the image###files"
                                                     : "Save the explanation###files";
  if (ImGui::Begin(title, &visible_, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
    if (button("Up", "The parent folder")) enter(folder_.parent_path());
    ImGui::SameLine();
    ImGui::TextUnformatted(folder_.string().c_str());
    ImGui::BeginChild("entries", {0, -2.5f * ImGui::GetFrameHeightWithSpacing()}, true);
    list();
    ImGui::EndChild();
    if (!error_.empty())
      ImGui::TextWrapped("%s", error_.c_str());
    else
      ImGui::TextDisabled("%s", purpose_ == Purpose::reference
                                    ? "An image in any format: PNG, JPEG, WebP, OpenEXR, Radiance HDR, KTX2."
                                : opens   ? "You can also type a path."
                                : isImage ? "PNG as displayed. OpenEXR and HDR have linear values."
                                          : "JSON, as quintet explain-pixel --json writes it.");
    if (focus_) ImGui::SetKeyboardFocusHere();
    focus_ = false;
    const char* action = opens ? "Open" : "Save";
    const float actionWidth = ImGui::CalcTextSize(action).x + 2.0f * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(-actionWidth - ImGui::GetStyle().ItemSpacing.x);
    const bool entered = ImGui::InputText("##name", &name_, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemActive()) framesUntilFocus_ = 0;
    ImGui::SameLine();
    if ((button(action, "", !name_.empty()) || entered) && !name_.empty()) chosen_ = folder_ / name_;
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  return chosen_ ? choose(*chosen_) : std::nullopt;
}

}  // namespace quintet::viewer
