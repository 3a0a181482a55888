#include "ui/widgets/file_dialog.h"

#include <imgui.h>

#include <algorithm>

#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace fs = std::filesystem;

void FileDialog::ask(std::string title, Purpose purpose, std::vector<std::string> endings, const fs::path& start) {
  title_ = std::move(title);
  purpose_ = purpose;
  endings_ = std::move(endings);
  std::error_code error;
  const auto absolute = fs::absolute(start.empty() ? fs::path(".") : start, error).lexically_normal();
  const bool is_folder = fs::is_directory(absolute, error);
  folder_ = is_folder ? absolute : absolute.parent_path();
  typed_ = is_folder ? "" : absolute.filename().string();
  open_ = opening_ = true;
  list();
}

void FileDialog::list() {
  folders_.clear();
  files_.clear();
  std::error_code error;
  for (fs::directory_iterator entry(folder_, fs::directory_options::skip_permission_denied, error), end;
       !error && entry != end; entry.increment(error)) {
    const auto name = entry->path().filename().string();
    if (name.starts_with(".")) continue;
    if (std::error_code ignored; entry->is_directory(ignored)) {
      folders_.push_back(entry->path());
    } else if (std::ranges::find(endings_, entry->path().extension().string()) != endings_.end()) {
      files_.push_back(entry->path());
    }
  }
  std::ranges::sort(folders_);
  std::ranges::sort(files_);
}

std::optional<fs::path> FileDialog::show() {
  if (!open_) return std::nullopt;
  if (opening_) ImGui::OpenPopup(title_.c_str());
  const auto& display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * display.x, 0.5f * display.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(px(560), display.x - 20), std::min(px(420), display.y - 20)});
  std::optional<fs::path> chosen;
  if (!ImGui::BeginPopupModal(title_.c_str(), nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove))
    return chosen;
  note(folder_.string());
  ImGui::BeginChild("list", {0, -2.6f * ImGui::GetFrameHeight()}, true);
  std::optional<fs::path> enter;
  if (ImGui::Selectable("..")) enter = folder_.parent_path();
  for (const auto& folder : folders_) {
    if (ImGui::Selectable((folder.filename().string() + "/").c_str())) enter = folder;
  }
  for (const auto& file : files_) {
    const auto name = file.filename().string();
    if (ImGui::Selectable(name.c_str(), typed_ == name, ImGuiSelectableFlags_AllowDoubleClick)) {
      typed_ = name;
      if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) chosen = file;
    }
    mark("file." + name);
  }
  ImGui::EndChild();
  if (enter) {
    folder_ = *enter;
    list();
  }
  ImGui::SetNextItemWidth(-1);
  if (opening_) ImGui::SetKeyboardFocusHere();
  opening_ = false;
  const bool entered = text_field("##name", typed_);
  mark("control.file_name");
  if ((push_button("file_ok", purpose_ == Purpose::open ? "Open" : "Save", true, px(90)) || entered) &&
      !typed_.empty()) {
    const fs::path typed = typed_;
    chosen = typed.is_absolute() ? typed : folder_ / typed;
    if (purpose_ == Purpose::save && !chosen->has_extension() && !endings_.empty()) *chosen += endings_.front();
  }
  ImGui::SameLine();
  if (push_button("file_cancel", "Cancel", false, px(90))) open_ = false;
  if (chosen) open_ = false;
  if (!open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return chosen;
}

}  // namespace handloop::ui
