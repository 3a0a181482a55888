#include "ui/views/scene_renderer.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/arm_picture.h"
#include "sim/phantom_scene.h"
#include "ui/widgets/theme.h"

namespace handloop::ui {
namespace {

using Eigen::Vector3d;

constexpr double kMetresPerNewton = 0.03;  ///< length of an arrow
constexpr int kPersonGroup = 2, kWallGroup = 3;

void add_arrow(mjvScene& scene, const Vector3d& from, const Vector3d& along, double width, const Colour& colour,
               int type = mjGEOM_ARROW) {
  const double length = along.norm();
  if (scene.ngeom >= scene.maxgeom || length < 1e-4) return;
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along / length).toRotationMatrix();
  std::array<mjtNum, 9> matrix;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.data()) = turn;
  // MuJoCo measures an arrow by its length, a capsule by its radius and half its length
  const bool arrow = type == mjGEOM_ARROW;
  const std::array<mjtNum, 3> size{width, arrow ? width : 0.5 * length, arrow ? length : 0.0};
  const Vector3d middle = arrow ? from : Vector3d(from + 0.5 * along);
  const std::array<mjtNum, 3> position{middle.x(), middle.y(), middle.z()};
  const std::array<float, 4> rgba{colour.r, colour.g, colour.b, colour.a};
  mjv_initGeom(&scene.geoms[scene.ngeom++], type, size.data(), position.data(), matrix.data(), rgba.data());
}

}  // namespace

struct SceneRenderer::Impl {
  sim::PhantomScene scene;
  sim::DataPtr data;
  models::PhantomParameterSet parameter_set;
  mjvCamera camera{};
  mjvOption option{};
  mjvScene shapes{};
  mjrContext context{};
  double aspect = 1.0;

  explicit Impl(const models::Scenario& scenario) {
    load(scenario);
    mjv_defaultOption(&option);
    option.geomgroup[kWallGroup] = 1;
    mjv_defaultScene(&shapes);
    mjv_makeScene(scene.model.get(), &shapes, 500);
    shapes.flags[mjRND_REFLECTION] = 0;
    mjr_defaultContext(&context);
    // nothing is drawn off the screen
    scene.model->vis.global.offwidth = scene.model->vis.global.offheight = 16;
    scene.model->vis.quality.offsamples = 0;
    scene.model->vis.quality.shadowsize = 1024;
    mjr_makeContext(scene.model.get(), &context, mjFONTSCALE_100);
    reset_camera();
  }
  ~Impl() {
    mjr_freeContext(&context);
    mjv_freeScene(&shapes);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void load(const models::Scenario& scenario) {
    scene = sim::load_phantom(scenario.device, true);
    data = sim::make_data(scene.model.get());
    parameter_set = scenario.device.parameter_set;
  }

  void reset_camera() {
    mjv_defaultCamera(&camera);
    camera.type = mjCAMERA_FREE;
    camera.azimuth = 122;
    camera.elevation = -14;
    camera.distance = 0.92;
    camera.lookat[0] = 0.20, camera.lookat[1] = 0.02, camera.lookat[2] = -0.06;
  }

  void pose(const SceneState& state, const models::Scenario& scenario) {
    const auto& q = state.joint_rad;
    mj_resetData(scene.model.get(), data.get());
    for (int i = 0; i < 3; ++i) data->qpos[scene.motor_dof[i]] = q[i];
    data->qpos[scene.elbow_dof] = q[2] - q[1];
    data->qpos[scene.coupler_dof] = q[1] - q[2];
    sim::PlantTruth truth;
    for (const auto axis : models::kAxes) {
      const int row = models::device_row(axis);
      truth.tip_m[static_cast<std::size_t>(axis)] = state.tip_m[row] - state.home_tip_m[row];
    }
    sim::pose_picture(scene, state.home_tip_m, truth, scenario.wall, data.get());
  }

  struct View {
    Vector3d position, forward, up, right;
    double half_height, half_width;  ///< at distance 1
  };
  View view() const {
    View v;
    const auto& left = shapes.camera[0];
    const auto& other = shapes.camera[1];
    for (int i = 0; i < 3; ++i) {
      v.position[i] = 0.5 * static_cast<double>(left.pos[i] + other.pos[i]);
      v.forward[i] = static_cast<double>(left.forward[i]);
      v.up[i] = static_cast<double>(left.up[i]);
    }
    v.right = v.forward.cross(v.up);
    v.half_height = static_cast<double>(left.frustum_top / left.frustum_near);
    v.half_width = v.half_height * aspect;
    return v;
  }
};

SceneRenderer::SceneRenderer(const models::Scenario& scenario) : impl_(std::make_unique<Impl>(scenario)) {}
SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::draw(const SceneState& state, const models::Scenario& scenario, const Viewport& where, bool dark) {
  auto& m = *impl_;
  if (where.width < 2 || where.height < 2) return;
  if (scenario.device.parameter_set != m.parameter_set) m.load(scenario);
  m.aspect = static_cast<double>(where.width) / where.height;
  m.pose(state, scenario);
  m.option.geomgroup[kPersonGroup] = scenario.arm.attached ? 1 : 0;
  m.shapes.flags[mjRND_SKYBOX] = dark ? 0 : 1;
  mjv_updateScene(m.scene.model.get(), m.data.get(), &m.option, nullptr, &m.camera, mjCAT_ALL, &m.shapes);
  const auto& colours = palette_of(Brightness::dark).series;
  const Vector3d tip =
      m.scene.model ? Vector3d(Eigen::Map<const Vector3d>(m.data->site_xpos + 3 * m.scene.tip_site)) : state.tip_m;
  add_arrow(m.shapes, tip, kMetresPerNewton * state.sensed_force_N, 0.0035, colours[1]);
  add_arrow(m.shapes, tip, kMetresPerNewton * state.wall_force_N, 0.0055, colours[2].faded(0.6f));
  if (state.pull_anchor_m) add_arrow(m.shapes, tip, *state.pull_anchor_m - tip, 0.0018, colours[4], mjGEOM_CAPSULE);
  mjr_setBuffer(mjFB_WINDOW, &m.context);
  mjr_render({where.left, where.bottom, where.width, where.height}, &m.shapes, &m.context);
}

void SceneRenderer::orbit(double right, double down) {
  mjv_moveCamera(impl_->scene.model.get(), mjMOUSE_ROTATE_H, right, 0, &impl_->shapes, &impl_->camera);
  mjv_moveCamera(impl_->scene.model.get(), mjMOUSE_ROTATE_V, 0, down, &impl_->shapes, &impl_->camera);
}

void SceneRenderer::pan(double right, double down) {
  mjv_moveCamera(impl_->scene.model.get(), mjMOUSE_MOVE_V, right, down, &impl_->shapes, &impl_->camera);
}

void SceneRenderer::zoom(double steps) {
  mjv_moveCamera(impl_->scene.model.get(), mjMOUSE_ZOOM, 0, -0.05 * steps, &impl_->shapes, &impl_->camera);
}

void SceneRenderer::reset_camera() {
  impl_->reset_camera();
}

std::array<double, 2> SceneRenderer::place_of(const Vector3d& point_m) const {
  const auto v = impl_->view();
  const Vector3d way = point_m - v.position;
  const double depth = std::max(way.dot(v.forward), 1e-6);
  return {0.5 + 0.5 * way.dot(v.right) / (depth * v.half_width), 0.5 - 0.5 * way.dot(v.up) / (depth * v.half_height)};
}

Vector3d SceneRenderer::point_at(const std::array<double, 2>& place, const Vector3d& at_depth_of_m) const {
  const auto v = impl_->view();
  const double depth = (at_depth_of_m - v.position).dot(v.forward);
  return v.position +
         depth * (v.forward + v.right * (2 * place[0] - 1) * v.half_width + v.up * (1 - 2 * place[1]) * v.half_height);
}

}  // namespace handloop::ui
