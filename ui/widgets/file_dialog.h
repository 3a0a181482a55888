#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace handloop::ui {

/// Asks for a file: a list of the folder's matching files and a line to type into.
class FileDialog {
 public:
  enum class Purpose { open, save };
  /// `endings` like {".toml"}; `start` a file or folder.
  void ask(std::string title, Purpose purpose, std::vector<std::string> endings, const std::filesystem::path& start);
  bool open() const { return open_; }
  /// Once a frame; the chosen path in the frame it is chosen.
  std::optional<std::filesystem::path> show();

 private:
  void list();

  std::string title_;
  Purpose purpose_ = Purpose::open;
  std::vector<std::string> endings_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> folders_, files_;
  std::string typed_;
  bool open_ = false, opening_ = false;
};

}  // namespace handloop::ui
