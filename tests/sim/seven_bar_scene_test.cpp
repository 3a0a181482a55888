#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "sim/scene_file.h"

/// The linkage of Kazerooni and Her with the lengths and sections we assume, against closed forms.
namespace handloop::sim {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

struct Linkage {
  ModelPtr model = load_scene("seven_bar.xml", false);
  DataPtr data = make_data(model.get());

  int dof(const char* joint) const { return model->jnt_dofadr[mj_name2id(model.get(), mjOBJ_JOINT, joint)]; }

  /// Absolute angles of links 3 and 6; the other joints follow from both parallelograms.
  void pose(double th3, double th6) {
    mj_resetData(model.get(), data.get());
    data->qpos[dof("th1")] = data->qpos[dof("th3")] = th3;
    data->qpos[dof("th6")] = th6;
    data->qpos[dof("link2")] = -th3;
    data->qpos[dof("link6")] = th6 - th3;
    data->qpos[dof("link5")] = th3 - th6;
    mj_forward(model.get(), data.get());
  }

  MatrixXd motion() const {
    MatrixXd map = MatrixXd::Zero(model->nv, 2);
    map(dof("th1"), 0) = map(dof("th3"), 0) = map(dof("link5"), 0) = 1;
    map(dof("link2"), 0) = map(dof("link6"), 0) = -1;
    map(dof("th6"), 1) = map(dof("link6"), 1) = 1;
    map(dof("link5"), 1) = -1;
    return map;
  }

  Matrix2d mass_matrix() const {
    MatrixXd full(model->nv, model->nv);
    mj_fullM(model.get(), full.data(), data->qM);
    return motion().transpose() * full * motion();
  }
  Vector2d gravity() const {
    return motion().transpose() * Eigen::Map<const Eigen::VectorXd>(data->qfrc_bias, model->nv);
  }
  double gap() const {
    double square = 0;
    for (int i = 0; i < data->ne; ++i) square += data->efc_pos[i] * data->efc_pos[i];
    return std::sqrt(square);
  }
};

TEST(SevenBarScene, HasSevenLinksEightRevolutesAndTwoDegreesOfFreedom) {
  const Linkage linkage;
  EXPECT_EQ(linkage.model->nv + linkage.model->neq, 8);  // six joints in the trees and two loop closures
  const MatrixXd map = linkage.motion();
  EXPECT_EQ(map.cols(), 2);
}

TEST(SevenBarScene, HasTheMassMatrixAndGravityOfTheClosedForm) {
  Linkage linkage;
  for (const auto& [th3, th6] : {std::pair{-std::numbers::pi / 2, 0.0}, {-1.2, 0.4}, {-2.2, -0.3}, {-0.8, 0.9}}) {
    linkage.pose(th3, th6);
    // computed outside this project for these lengths and sections, load at 0.5 m included
    const double a = 0.58831, b = 0.65767, c = 1.01574;
    const Matrix2d m = linkage.mass_matrix();
    EXPECT_NEAR(m(0, 0), a, 0.01 * a);  // 0.03 %: the links' own height
    EXPECT_NEAR(m(1, 1), c, 0.01 * c);
    EXPECT_NEAR(m(0, 1), b * std::cos(th3 - th6), 0.01 * b);
    const Vector2d n = linkage.gravity();
    EXPECT_NEAR(n[0], 19.70 * std::cos(th3), 0.01 * 19.70);
    EXPECT_NEAR(n[1], 20.39 * std::cos(th6), 0.01 * 20.39);
  }
}

TEST(SevenBarScene, PutsHandleAndLoadWhereTheAnglesSay) {
  Linkage linkage;
  for (const auto& [th3, th6] : {std::pair{-std::numbers::pi / 2, 0.0}, {-1.2, 0.4}, {-2.2, -0.3}}) {
    linkage.pose(th3, th6);
    for (const auto& [name, reach] : {std::pair{"hand_sensor", 0.30}, {"environment_sensor", 0.50}}) {
      const double* at = linkage.data->site_xpos + 3 * mj_name2id(linkage.model.get(), mjOBJ_SITE, name);
      EXPECT_NEAR(at[0], 0.31 * std::cos(th3) + reach * std::cos(th6), 1e-9);
      EXPECT_NEAR(at[2], 0.31 * std::sin(th3) + reach * std::sin(th6), 1e-9);
    }
    EXPECT_LT(linkage.gap(), 1e-9);
  }
}

TEST(SevenBarScene, LoopsStayClosedUnderAHundredNewtonsAtTheHandle) {
  for (const double angle : {0.0, 0.8, 1.6, 2.4, 3.2, 4.0, 4.8, 5.6}) {
    Linkage linkage;
    linkage.pose(-1.4, 0.2);
    const int handle = mj_name2id(linkage.model.get(), mjOBJ_BODY, "handle");
    const int th1 = linkage.dof("th1"), th6 = linkage.dof("th6");
    double widest = 0;
    for (int k = 0; k < 1000; ++k) {
      // held by a stiff joint controller and pushed by a hand in full steps
      const double push = k < 100 ? 0.0 : 100.0;
      linkage.data->xfrc_applied[6 * handle] = push * std::cos(angle);
      linkage.data->xfrc_applied[6 * handle + 2] = push * std::sin(angle);
      const Vector2d weight = linkage.gravity();
      linkage.data->ctrl[0] = weight[0] + 3000 * (-1.4 - linkage.data->qpos[th1]) - 120 * linkage.data->qvel[th1];
      linkage.data->ctrl[1] = weight[1] + 3000 * (0.2 - linkage.data->qpos[th6]) - 120 * linkage.data->qvel[th6];
      mj_step(linkage.model.get(), linkage.data.get());
      widest = std::max(widest, linkage.gap());
    }
    EXPECT_LT(widest, 0.05e-3);
    EXPECT_NEAR(linkage.data->qpos[th1], -1.4, 0.05);
  }
}

TEST(SevenBarScene, HandSensorFeelsTheHandAlone) {
  Linkage linkage;
  linkage.pose(-std::numbers::pi / 2, 0.0);
  const int handle = mj_name2id(linkage.model.get(), mjOBJ_BODY, "handle");
  linkage.data->xfrc_applied[6 * handle] = 30.0;
  linkage.data->xfrc_applied[6 * handle + 2] = -12.0;
  const Vector2d weight = linkage.gravity();
  linkage.data->ctrl[0] = weight[0];
  linkage.data->ctrl[1] = weight[1];
  mj_forward(linkage.model.get(), linkage.data.get());
  const int sensor = mj_name2id(linkage.model.get(), mjOBJ_SENSOR, "hand_force");
  const double* force = linkage.data->sensordata + linkage.model->sensor_adr[sensor];
  // what link 6 must hold against: the hand's push, the handle's tenth of a gram apart
  EXPECT_NEAR(force[0], -30.0, 0.02);
  EXPECT_NEAR(force[2], 12.0, 0.02);
}

}  // namespace
}  // namespace handloop::sim
