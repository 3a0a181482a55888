#include "studies/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include "device/sim_device.h"
#include "io/recording_file.h"
#include "models/errors.h"

namespace handloop::studies {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<device::Device> simulated(const models::Scenario& scenario) {
  return std::make_unique<device::SimDevice>(scenario);
}

ExperimentRequest short_request() {
  ExperimentRequest request;
  request.subjects = 1;
  request.grips_N = {2};
  request.duration_s = 2.0;
  return request;
}

/// A directory of its own, gone with the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("handloop_experiment_" + std::to_string(::getpid()) + "_" +
                                               testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(Experiment, TakesEverySubjectGripAndAxisOnceInAnOrderOfItsOwn) {
  ExperimentRequest request;
  const auto trials = plan_trials(request);
  ASSERT_EQ(trials.size(), 135u);
  std::set<std::tuple<std::size_t, int, models::Axis>> seen;
  std::set<std::string> orders;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].number, i + 1);
    EXPECT_EQ(trials[i].subject, i / 9 + 1);
    seen.insert({trials[i].subject, trials[i].grip_N, trials[i].axis});
  }
  EXPECT_EQ(seen.size(), 135u);
  for (std::size_t subject = 0; subject < 15; ++subject) {
    std::string order;
    for (std::size_t i = 0; i < 9; ++i) {
      const auto& trial = trials[9 * subject + i];
      order += std::to_string(trial.grip_N) + std::string(models::axis_name(trial.axis));
    }
    orders.insert(order);
  }
  EXPECT_GT(orders.size(), 12u);  // of 9! there are plenty
}

TEST(Experiment, HoldsTheSameHandInEveryAxisOfOneGrip) {
  const auto trials = plan_trials({});
  for (const auto& one : trials) {
    for (const auto& other : trials) {
      if (one.subject == other.subject && one.grip_N == other.grip_N) {
        EXPECT_EQ(one.arms, other.arms);
      }
    }
  }
}

TEST(Experiment, GivesTheSameBytesWhateverTheNumberOfJobs) {
  Folder folder;
  auto request = short_request();
  request.subjects = 2;
  request.jobs = 1;
  run_experiment(request, folder.path / "one");
  request.jobs = 3;
  run_experiment(request, folder.path / "three");
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path / "one")) {
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder.path / "three" / entry.path().filename())) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 8);  // six trials, index and report
}

TEST(Experiment, WritesRecordingsThatCanBeReadBack) {
  Folder folder;
  const auto request = short_request();
  std::size_t last = 0, total = 0;
  run_experiment(request, folder.path, [&](std::size_t done, std::size_t all) {
    last = done;
    total = all;
  });
  EXPECT_EQ(last, 3u);
  EXPECT_EQ(total, 3u);
  const auto recording = io::read_recording(folder.path / "trial_001.csv");
  EXPECT_EQ(recording.size(), 2000u);
  EXPECT_DOUBLE_EQ(recording.sample_time_s, 0.001);
  EXPECT_EQ(recording.grip_force_N.size(), 2000u);
  const auto index = bytes_of(folder.path / "index.csv");
  EXPECT_EQ(index.substr(0, 70), "trial,subject,grip,axis,mass_kg,k1_N_per_m,k2_N_per_m,b1_Ns_per_m,b2_N");
  EXPECT_TRUE(fs::exists(folder.path / "report.html"));
}

TEST(Experiment, LeavesNothingBehindWhenItFails) {
  Folder folder;
  auto request = short_request();
  request.arm = models::AxisModel{};
  request.arm->arm.mass_kg = -1;
  EXPECT_THROW(run_experiment(request, folder.path), InputError);
  EXPECT_FALSE(fs::exists(folder.path));
}

TEST(Experiment, CapsTheForceAtWhatTheMotorsHaveLeftAtThePose) {
  // 3 A through each capstan at home, joint 2 carrying the device's weight and 52 g at 0.215 m
  const ExperimentRequest request;
  const auto rig = trial_scenario(request, plan_trials(request).front());
  const auto description = device::SimDevice(rig).description();
  const double kt = 0.0234, g = 9.81;
  const double weight = std::abs(-0.01630 + 0.052 * g * 0.215);
  EXPECT_NEAR(force_within_current_limit(description, rig.device, models::Axis::x), 3 * kt * 13.3 / 0.215, 1e-6);
  EXPECT_NEAR(force_within_current_limit(description, rig.device, models::Axis::y), (3 * kt * 11.2 - weight) / 0.215,
              1e-3);
  EXPECT_NEAR(force_within_current_limit(description, rig.device, models::Axis::z), 3 * kt * 11.2 / 0.170, 1e-6);
}

TEST(Experiment, WanderMovesTheHandSlowlyByWhatIsAsked) {
  ExperimentRequest request;
  request.rig.arm.wander_rms_m = 0.001;
  request.rig.electronics.ideal = true;
  const auto trials = plan_trials(request);
  auto scenario = trial_scenario(request, trials.front());
  TrialPlan plan;
  plan.rms_N = 1e-6;  // nothing but the wander
  plan.axis = trials.front().axis;
  const auto record = record_trial(plan, scenario, simulated);
  double sum = 0, square = 0;
  for (const double x : record.position_m) {
    sum += x;
    square += x * x;
  }
  const auto n = static_cast<double>(record.position_m.size());
  const double rms = std::sqrt(square / n - sum * sum / n / n);
  EXPECT_GT(rms, 0.0007);  // eight sines, of which a minute holds two to twenty periods
  EXPECT_LT(rms, 0.0013);
}

TEST(Experiment, RepeatsATrialMoreGentlyWhereAnUndampedGraspRings) {
  // a stiff grasp that damps nothing: it rings with the device's mass until the sensor's 16 N or another limit is met
  ExperimentRequest request;
  request.duration_s = 10;
  models::AxisModel arm;
  arm.axis = models::Axis::z;
  arm.arm = models::nominal_arm(models::Axis::z);
  arm.arm.k1_N_per_m = 1000;
  arm.arm.b1_Ns_per_m = 0.001;
  request.arm = arm;
  TrialPlan plan;
  plan.rms_N = 4;
  plan.axis = models::Axis::z;
  plan.duration_s = 10;
  const auto trials = plan_trials(request);
  const auto record = record_trial(plan, trial_scenario(request, trials.front()), simulated);
  EXPECT_GT(record.repeats, 0);
  EXPECT_DOUBLE_EQ(record.stimulus_rms_N, std::ldexp(plan.rms_N, -record.repeats));
  EXPECT_EQ(record.force_N.size(), 10000u);
  EXPECT_LT(std::abs(*std::ranges::max_element(record.force_N, {}, [](double f) { return std::abs(f); })), 16.0);
}

TEST(Experiment, EffectsOfAnArmAreInItsRecording) {
  ExperimentRequest request;
  request.rig.electronics.ideal = true;
  request.duration_s = 4;
  models::AxisModel arm;
  arm.axis = models::Axis::z;
  arm.arm = models::nominal_arm(models::Axis::z);
  request.arm = arm;
  const auto record = [&] {
    const auto trials = plan_trials(request);
    TrialPlan plan;
    plan.axis = trials.front().axis;
    plan.duration_s = 4;
    return record_trial(plan, trial_scenario(request, trials.front()), simulated);
  };
  const auto without = record();
  request.arm->effects.push_back(models::make_typical_effect("coulomb_friction", models::Place::arm));
  const auto with = record();
  ASSERT_EQ(plan_trials(request).size(), 1u);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < with.position_m.size(); ++i) {
    difference += std::pow(with.position_m[i] - without.position_m[i], 2);
    size += std::pow(without.position_m[i], 2);
  }
  EXPECT_GT(difference, 1e-3 * size);
}

TEST(Stimulus, NoiseEndsAtThirtyHertzAndIsClippedAtTheCap) {
  StimulusSettings settings;
  settings.rms_N = 2.0;
  settings.cap_N = 4.0;
  const auto stimulus = make_stimulus(settings, 60000, 3);
  std::size_t at_cap = 0;
  double square = 0;
  for (const double f : stimulus.force_N) {
    EXPECT_LE(std::abs(f), 4.0);
    at_cap += std::abs(f) == 4.0;
    square += f * f;
  }
  EXPECT_EQ(at_cap, stimulus.clipped_samples);
  EXPECT_NEAR(static_cast<double>(at_cap) / 60000, 0.0455, 0.015);  // beyond two sigma
  EXPECT_NEAR(std::sqrt(square / 60000), 2.0, 0.1);
}

std::complex<double> line_of(const std::vector<double>& x, std::size_t period, int line) {
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < period; ++n) {
    sum += x[n] * std::polar(2.0 / static_cast<double>(period),
                             -2 * std::numbers::pi * line * static_cast<double>(n) / static_cast<double>(period));
  }
  return sum;
}

TEST(Stimulus, MultisineStandsOnOddLinesOnlyAndLeavesSomeOfThemFree) {
  StimulusSettings settings;
  settings.kind = StimulusKind::multisine;
  settings.rms_N = 1.0;
  const auto stimulus = make_stimulus(settings, 20000, 5);
  const std::set<int> excited(stimulus.lines.begin(), stimulus.lines.end());
  int free_odd = 0;
  for (int line = 1; line <= 310; ++line) {
    const double size = std::abs(line_of(stimulus.force_N, 10000, line));
    if (excited.contains(line)) {
      EXPECT_EQ(line % 2, 1);
      EXPECT_NEAR(size, std::sqrt(2.0 / static_cast<double>(excited.size())), 1e-9);
    } else {
      EXPECT_LT(size, 1e-9);
      free_odd += line % 2 == 1 && line < 300;
    }
  }
  EXPECT_NEAR(free_odd, 37, 2);  // one of each four
  EXPECT_EQ(stimulus.force_N[123], stimulus.force_N[10123]);
}

}  // namespace
}  // namespace handloop::studies
