#include "sim/scene_file.h"

#include <mujoco/mujoco.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>
#include <sstream>
#include <string>
#include <system_error>

#include "models/errors.h"

namespace handloop::sim {
namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError(path.string() +
                     ": cannot be read; scenes are looked for there ($HANDLOOP_SCENES names another folder)");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void leave_out_visuals(std::string& text) {
  constexpr std::string_view kKeep = "discardvisual=\"false\"";
  constexpr std::string_view kDiscard = "discardvisual=\"true\"";
  if (const auto at = text.find(kKeep); at != std::string::npos) text.replace(at, kKeep.size(), kDiscard);
}

}  // namespace

void ModelDeleter::operator()(mjModel_* model) const noexcept {
  mj_deleteModel(model);
}
void DataDeleter::operator()(mjData_* data) const noexcept {
  mj_deleteData(data);
}

std::filesystem::path scenes_directory() {
  if (const char* chosen = std::getenv("HANDLOOP_SCENES"); chosen != nullptr && *chosen != '\0') return chosen;
  // An installed program brings its own, wherever it was installed to.
  std::error_code unreadable;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  const auto beside = program.parent_path().parent_path() / "share/handloop/scenes";
  if (!unreadable && std::filesystem::exists(beside)) return beside;
  const std::filesystem::path source = HANDLOOP_SOURCE_SCENES;
  return std::filesystem::exists(source) ? source : std::filesystem::path(HANDLOOP_INSTALLED_SCENES);
}

ModelPtr load_scene(std::string_view file, bool with_visuals) {
  const auto path = scenes_directory() / file;
  std::string text = read_text(path);
  if (!with_visuals) leave_out_visuals(text);
  // the compiler of MuJoCo keeps its parser's state in globals
  static std::mutex compiling;
  const std::lock_guard lock(compiling);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* kName = "scene.xml";
  mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), kName)], text.data(), text.size());
  std::array<char, 1000> complaint{};
  ModelPtr model(mj_loadXML(kName, files.get(), complaint.data(), static_cast<int>(complaint.size())));
  mj_deleteVFS(files.get());
  if (!model) throw InputError(path.string() + ": " + complaint.data());
  return model;
}

DataPtr make_data(const mjModel_* model) {
  DataPtr data(mj_makeData(model));
  if (!data) throw std::bad_alloc();
  return data;
}

}  // namespace handloop::sim
