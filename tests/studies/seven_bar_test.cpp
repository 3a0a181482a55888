#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "control/force_control_primary.h"
#include "device/fault.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "studies/run.h"
#include "studies/seven_bar_margins.h"
#include "studies/seven_bar_measurement.h"
#include "studies/seven_bar_replay.h"
#include "studies/seven_bar_report.h"
#include "studies/seven_bar_simulation.h"

/// Kazerooni and Her's machine as a whole: MuJoCo linkage, converters, sensors, controller and hand.
namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector2d;

models::Scenario linkage() {
  return io::read_scenario(std::string(HANDLOOP_SOURCE_DIR) + "/scenes/seven_bar.toml");
}

double dB(const Complex& ratio) {
  return 20 * std::log10(std::abs(ratio));
}
double deg(const Complex& ratio) {
  return std::arg(ratio) * 180 / std::numbers::pi;
}

TEST(SevenBarPrimary, FollowsTheirGOverTheWorkspace) {
  // Up to G's bandwidth (-3 dB at 2.7 rad/s) and as far again; 1 dB and 5 deg are asked for.
  double worst_dB = 0, worst_deg = 0;
  for (const Vector2d& th : {Vector2d(-std::numbers::pi / 2, 0.0), Vector2d(-1.1, 0.5), Vector2d(-2.1, -0.4)}) {
    auto scenario = linkage();
    scenario.device.pose_rad = {th[0], th[1], 0.0};
    const models::PrimaryLoop G;
    for (const auto& point : measure_primary(
             scenario,
             {.frequencies_rad_per_s = {1.6, 4.7}, .period_s = 4.0, .settle_s = 8.0, .sensitivities = false})) {
      const Complex ratio = point.G / G(Complex(0, point.frequency_rad_per_s));
      worst_dB = std::max(worst_dB, std::abs(dB(ratio)));
      worst_deg = std::max(worst_deg, std::abs(deg(ratio)));
    }
  }
  RecordProperty("worst_mdB", static_cast<int>(1000 * worst_dB));
  RecordProperty("worst_mdeg", static_cast<int>(1000 * worst_deg));
  EXPECT_LT(worst_dB, 0.1);
  EXPECT_LT(worst_deg, 0.5);
}

TEST(SevenBarPrimary, LeavesOfForcesWhatTheClosedFormSaysAndFarLessThanGK) {
  const auto scenario = linkage();
  const Vector2d th(scenario.device.pose_rad[0], scenario.device.pose_rad[1]);
  const control::ModelledPrimary modelled(scenario, th);
  const auto loop = control::force_control_of(scenario, th);
  for (const auto& point :
       measure_primary(scenario, {.frequencies_rad_per_s = {6.3, 50, 220}, .period_s = 1.0, .settle_s = 7.0})) {
    const double w = point.frequency_rad_per_s;
    const auto i = static_cast<Eigen::Index>(point.axis);
    const Complex G = loop.primary({0, w}), K = loop.K({0, w});
    SCOPED_TRACE(testing::Message() << "axis " << i << " at " << w << " rad/s");
    // S_h is the small difference of a force and its own compensation: what is left of it depends on how a sample ends.
    EXPECT_LT(std::abs(point.S_e_m_per_N / modelled.to_environment(w)(i, i) - 1.0), 0.05);
    EXPECT_LT(std::abs(point.S_h_m_per_N - modelled.to_hand(w)(i, i)),
              0.03 * std::abs(modelled.to_environment(w)(i, i)));
    EXPECT_LT(std::abs(point.G / (G * modelled.tracking(w)(i, i)) - 1.0), 0.02);
    EXPECT_LT(std::abs(point.S_h_m_per_N), 0.1 * std::abs(G * K * loop.alpha({0, w})(i, i)));  // 0.058 at 220 rad/s
    if (w < 7) {
      EXPECT_LT(std::abs(point.S_e_m_per_N), 1.5e-3 * std::abs(G * K));  // 1.02e-3 in x
      EXPECT_LT(std::abs(point.S_h_m_per_N), 1e-5 * std::abs(G * K));
    }
  }
}

TEST(SevenBarPrimary, HoldsThePlaceWhereTheHandLetsGo) {
  auto scenario = linkage();
  scenario.force_amplifier.hand_leaves_s = 1.5;
  const auto trace = simulate({.scenario = scenario, .duration_s = 3.0, .every = 5});
  ASSERT_EQ(trace.fault.fault, device::Fault::none);
  const auto at = [&](double t) {
    const auto k = static_cast<std::size_t>(t / trace.sample_time_s);
    return Vector2d(trace.position_m[0][k], trace.position_m[1][k]);
  };
  const double speed = (at(1.5) - at(1.48)).norm() / 0.02;
  EXPECT_GT(speed, 0.02);                                      // it was on its way
  EXPECT_GT(at(1.5).norm(), 0.02);                             // and not at home
  EXPECT_LT((at(2.9) - at(1.5)).norm(), 2e-3 + 0.02 * speed);  // where the grip was found gone, 10 ms later
  EXPECT_LT((at(2.9) - at(2.2)).norm(), 1e-5);                 // at rest
}

TEST(SevenBarExperiment, ReachesTheSlopesOfMinusEightAndMinusFive) {
  auto scenario = linkage();
  scenario.run.duration_s = 10.0;
  const auto trace = trace_of(scenario);
  const auto figures = seven_bar_figures(scenario, trace, true);
  ASSERT_TRUE(figures.compared);
  RecordProperty("replay_error_ppm", static_cast<int>(1e6 * figures.tracking_error));
  EXPECT_LT(figures.tracking_error, 0.01);
  EXPECT_NEAR(figures.slopes[0].value, -8.0, 0.16);
  EXPECT_NEAR(figures.slopes[1].value, -5.0, 0.10);
  EXPECT_GT(figures.slopes[0].explained, 0.7);  // 0.78: 0.02 N of sensor noise on 0.1 N of difference
  EXPECT_GT(figures.slopes[1].explained, 0.98);
  EXPECT_EQ(figures.plots.size(), 8u);  // Figures 9 to 16
}

TEST(SevenBarExperiment, PredictsTheLimitOfAlphaThatTheSimulationHas) {
  const auto scenario = linkage();
  const auto margins = seven_bar_margins(scenario);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    ASSERT_TRUE(margins.axes[axis].modelled);
    const double predicted = margins.axes[axis].modelled->factor;
    const double simulated = simulated_alpha_limit(scenario, axis, predicted);
    RecordProperty(axis == 0 ? "x_predicted_per_mille" : "y_predicted_per_mille", static_cast<int>(1000 * predicted));
    RecordProperty(axis == 0 ? "x_simulated_per_mille" : "y_simulated_per_mille", static_cast<int>(1000 * simulated));
    EXPECT_NEAR(simulated / predicted, 1.0, 0.05);
    EXPECT_GT(simulated, 8.0);
    EXPECT_LT(simulated, 19.0);
  }
}

TEST(SevenBarExperiment, AlphaOfNineteenIsUnstableAndTheMonitorEndsIt) {
  auto scenario = linkage();
  scenario.force_amplifier.alpha_yy = {0, 0, 0, 19};
  EXPECT_FALSE(seven_bar_margins(scenario).stable);
  const auto trace = simulate({.scenario = scenario, .duration_s = 3.0, .every = 5});
  EXPECT_NE(trace.fault.fault, device::Fault::none);
  scenario.force_amplifier.alpha_yy = {0, 0, 0, 11.5};  // slow enough to be seen growing: 2.1 1/s
  EXPECT_GT(simulated_growth_per_s(scenario, 1), 1.0);
}

TEST(SevenBarExperiment, NeuralArmsAreStableToo) {
  for (const auto hand : {models::SevenBarHand::tight, models::SevenBarHand::loose}) {
    auto scenario = linkage();
    scenario.force_amplifier.hand = hand;
    const auto trace = simulate({.scenario = scenario, .duration_s = 2.0, .every = 5});
    EXPECT_EQ(trace.fault.fault, device::Fault::none) << models::hand_name(hand);
  }
}

TEST(SevenBarExperiment, SmallGainHoldsForACubicSpringItPermits) {
  // A Delta whose gain (15) permits stays bounded; (15) only suffices, so nothing is asked of one it does not permit.
  auto scenario = linkage();
  const auto margins = seven_bar_margins(scenario);
  const double reach = scenario.safety.workspace_radius_m;
  scenario.force_amplifier.hand_cubic_N_per_m3 = 0.9 * margins.small_gain.permitted_N_per_m / (8 * reach * reach);
  const auto with_spring = seven_bar_margins(scenario);
  EXPECT_LT(with_spring.nonlinear_gain_N_per_m, with_spring.small_gain.permitted_N_per_m);
  EXPECT_GT(scenario.force_amplifier.hand_cubic_N_per_m3, 500);
  const auto trace = simulate({.scenario = scenario, .duration_s = 3.0, .every = 5});
  EXPECT_EQ(trace.fault.fault, device::Fault::none);
}

TEST(SevenBarMargins, SayWhatIsPrintedAndWhatTheMechanismMakesOfIt) {
  const auto r = seven_bar_margins(linkage());
  EXPECT_TRUE(r.stable);
  EXPECT_NEAR(r.alpha_limit, 12.499, 0.001);
  EXPECT_NEAR(r.axes[1].environment_kg, 9.580, 0.001);
  EXPECT_NEAR(r.axes[1].ideal->factor, 12.388, 0.001);  // with 9.58 kg in the place of 9.08; found on a grid elsewhere
  EXPECT_NEAR(r.axes[0].ideal->factor, 13.746, 0.001);
  EXPECT_TRUE(r.performance.met_8);
  EXPECT_TRUE(r.performance.met_9);
  EXPECT_LT(r.small_gain.error_bound, 1e-6 * r.small_gain.gain_m_per_N);
  const auto json = to_json(r);
  EXPECT_TRUE(json["stable"].get<bool>());
  EXPECT_TRUE(json["small_gain"]["inequality_15"].get<bool>());
}

class SevenBarRun : public testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("seven_bar_run_" + std::to_string(getpid()));
  void TearDown() override { std::filesystem::remove_all(folder_); }
};

TEST_F(SevenBarRun, WritesLogSummaryAndReport) {
  RunOptions options;
  options.scenario = linkage();
  options.scenario.run.duration_s = 4.0;
  options.out = folder_;
  const auto outcome = run(options);
  EXPECT_TRUE(outcome.stable) << outcome.why_unstable;
  for (const char* name : {"log.csv", "summary.json", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / name));
}

TEST(SevenBarScenario, RefusesWhatCannotRun) {
  auto scenario = linkage();
  scenario.force_amplifier.filter_denominator = {0, 0, 1, -1};
  EXPECT_THROW(simulate({.scenario = scenario}), InputError);
  scenario = linkage();
  scenario.device.pose_rad = {0.0, 0.0, 0.0};
  EXPECT_THROW(simulate({.scenario = scenario}), InputError);
  EXPECT_THROW(seven_bar_margins(scenario), InputError);  // the arm is stretched
}

}  // namespace
}  // namespace handloop::studies
