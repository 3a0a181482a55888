#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

struct mjModel_;
struct mjData_;

namespace handloop::sim {

struct ModelDeleter {
  void operator()(mjModel_* model) const noexcept;
};
struct DataDeleter {
  void operator()(mjData_* data) const noexcept;
};
using ModelPtr = std::unique_ptr<mjModel_, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData_, DataDeleter>;

/// Folder of the MJCF scenes: $HANDLOOP_SCENES, else share/handloop/scenes beside the running program's bin, else the
/// source tree's, else where they were to be installed.
std::filesystem::path scenes_directory();

/// Compiles a scene of that folder ("phantom.xml"). Without visuals, shapes that only show are left out: the physics is
/// the same bits and steps cost a fifth less. Throws InputError naming the file and MuJoCo's complaint. Thread-safe.
ModelPtr load_scene(std::string_view file, bool with_visuals);

/// Workspace for a model. Throws std::bad_alloc.
DataPtr make_data(const mjModel_* model);

}  // namespace handloop::sim
