#include "studies/run.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "device/live_loop.h"
#include "device/log_file.h"
#include "device/open_device.h"
#include "io/csv_file.h"
#include "io/recording_file.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "studies/plant_service.h"
#include "studies/run_stability.h"
#include "tests/support/sanitized.h"

namespace handloop::studies {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

const std::string kScenario = std::string(HANDLOOP_SOURCE_DIR) + "/scenes/phantom_wall.toml";

class Run : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("run_") + info->name() + "_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunOptions options(const std::string& name, double duration_s = 1.0) const {
    RunOptions options;
    options.scenario = io::read_scenario(kScenario);
    options.scenario.run.duration_s = duration_s;
    options.out = folder_ / name;
    return options;
  }
  std::string text(const fs::path& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  nlohmann::json summary(const std::string& name) const { return nlohmann::json::parse(text(name + "/summary.json")); }

  fs::path folder_;
};

/// Starts the program; the caller waits for it.
pid_t start(const std::vector<std::string>& arguments, rlim_t largest_file = RLIM_INFINITY) {
  const pid_t child = fork();
  if (child != 0) return child;
  if (largest_file != RLIM_INFINITY) {
    const rlimit limit{largest_file, largest_file};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
  }
  std::vector<char*> raw{const_cast<char*>(HANDLOOP_PROGRAM)};
  for (const auto& argument : arguments) raw.push_back(const_cast<char*>(argument.c_str()));
  raw.push_back(nullptr);
  if (std::freopen("/dev/null", "w", stdout) == nullptr || std::freopen("/dev/null", "w", stderr) == nullptr) _exit(99);
  execv(HANDLOOP_PROGRAM, raw.data());
  _exit(98);
}

int exit_code(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST_F(Run, IsRepeatableToTheBit) {
  run(options("a"));
  run(options("b"));
  EXPECT_EQ(text("a/log.csv"), text("b/log.csv"));
  auto other = options("c");
  other.scenario.run.seed = 2;
  run(other);
  EXPECT_NE(text("a/log.csv"), text("c/log.csv"));
}

TEST_F(Run, WritesTheContractsSummaryAndAReport) {
  const auto outcome = run(options("a"));
  EXPECT_TRUE(outcome.stable) << outcome.why_unstable;
  const auto json = summary("a");
  for (const char* key : {"stable", "faults", "steps", "deadline_misses", "p50_us", "p99_9_us", "max_us",
                          "sim_steps_per_s", "real_time_factor"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["steps"], 1000);
  EXPECT_EQ(json["stable"], true);
  EXPECT_NE(text("a/report.html").find("<svg"), std::string::npos);
  // The log is a recording that identification can read.
  const auto recording = io::read_recording(folder_ / "a/log.csv");
  EXPECT_EQ(recording.size(), 1000u);
  EXPECT_EQ(recording.sample_time_s, 1e-3);
}

TEST_F(Run, HoldsTheHandWhereTheSpringsBalance) {
  const auto o = options("a", 3.0);
  run(o);
  // Arm (k1 k2 / (k1 + k2) at the grip, pushed by the arm's own force through k1) against the wall: the pushing force
  // acts on the arm's mass behind the grasp. Balance: k1 (xm - x) = K x and push = k2 xm + k1 (xm - x).
  const auto& arm = o.scenario.arm.axes[2];
  const double K = o.scenario.loop.stiffness_N_per_m, k1 = arm.k1_N_per_m, k2 = arm.k2_N_per_m;
  const double per_xm = k1 / (k1 + K);  // x over xm
  const double x = per_xm * o.scenario.hand.push_N / (k2 + k1 * (1.0 - per_xm));
  const auto recording = io::read_recording(folder_ / "a/log.csv");
  double mean = 0.0;
  for (std::size_t i = 2500; i < 3000; ++i) mean += recording.position_m[i] / 500.0;
  // An encoder count is 0.024 mm there, half a DAC code 2 mN or 5 micrometres; residual 0.01 mm.
  EXPECT_NEAR(mean, x, 3e-5);
}

TEST_F(Run, AReplayedLogWritesTheSameLogAgain) {
  run(options("a"));
  auto again = options("b");
  again.device = "replay:" + (folder_ / "a/log.csv").string();
  const auto outcome = run(again);
  EXPECT_EQ(text("a/log.csv"), text("b/log.csv"));
  ASSERT_FALSE(outcome.notes.empty());
  EXPECT_EQ(outcome.notes[0].substr(0, 2), "0 ");
}

TEST_F(Run, AnyRecordingCanBeReplayed) {
  models::Recording recording;
  for (int i = 0; i < 1500; ++i) {
    recording.force_N.push_back(std::sin(0.01 * i));
    recording.position_m.push_back(0.004 * std::sin(0.02 * i));
  }
  io::write_recording(folder_ / "recording.csv", recording);
  auto o = options("a", 10.0);
  o.device = "replay:" + (folder_ / "recording.csv").string();
  const auto outcome = run(o);
  EXPECT_EQ(outcome.session.steps, 1500u);  // as long as the recording
  const auto log = io::read_recording(folder_ / "a/log.csv");
  for (std::size_t i = 0; i < log.size(); i += 97) {
    EXPECT_NEAR(log.position_m[i], recording.position_m[i], 5e-5) << i;  // encoder counts: 0.03 mm on each joint
    EXPECT_NEAR(log.force_N[i], recording.force_N[i], 3e-4) << i;        // half an ADC code
  }
}

TEST_F(Run, OverTheWireTheLogIsTheSame) {
  std::atomic<bool> stop{false};
  std::promise<std::string> address;
  PlantServiceOptions service;
  service.scenario = io::read_scenario(kScenario);
  service.listen = "127.0.0.1:0";
  service.stop = &stop;
  service.on_ready = [&](const std::string& where, bool) { address.set_value(where); };
  std::thread plant([&] { serve_plant(service); });
  auto wired = options("b");
  wired.scenario.run.seed = 9;
  wired.device = "udp://" + address.get_future().get();
  run(wired);
  stop = true;
  plant.join();
  auto local = options("a");
  local.scenario.run.seed = 9;
  run(local);
  EXPECT_EQ(text("a/log.csv"), text("b/log.csv"));
}

TEST_F(Run, AFaultLeavesItsEvidence) {
  auto o = options("a", 5.0);
  o.inject = "encoder_jump_large@3000";
  const auto outcome = run(o);
  EXPECT_EQ(outcome.session.fault.fault, device::Fault::encoder_jump);
  EXPECT_FALSE(outcome.stable);
  const auto json = summary("a");
  EXPECT_EQ(json["faults"][0]["name"], "encoder_jump");
  EXPECT_EQ(json["faults"][0]["sample"], 3000);
  const io::CsvFile evidence(folder_ / "a/fault.csv");
  const std::vector<std::size_t> column{evidence.require("sample")};
  const auto samples = evidence.read_numbers(column)[0];
  EXPECT_GE(samples.size(), 2000u);
  EXPECT_EQ(samples.back(), 3100);  // and the tenth of a second after it
}

TEST_F(Run, AWallFarBeyondTheMarginIsCalledUnstable) {
  auto o = options("a", 4.0);
  o.scenario.loop.stiffness_N_per_m = 5000.0;
  EXPECT_FALSE(run(o).stable);
}

TEST_F(Run, SaysWhatItCannotDo) {
  auto o = options("a");
  o.device = "smi";
  EXPECT_THROW(run(o), InputError);
  o = options("a");
  o.inject = "nothing";
  EXPECT_THROW(run(o), InputError);
  o = options("a", 0.0);
  EXPECT_THROW(run(o), InputError);
  o = options("a");
  o.device = "replay:/does/not/exist.csv";
  EXPECT_THROW(run(o), InputError);
  o = options("a");
  o.device = "comedi:/does/not/exist.toml";
  EXPECT_THROW(run(o), InputError);
  o = options("a");
  o.key = "/etc/hostname";
  EXPECT_THROW(run(o), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

TEST_F(Run, KilledAtAnyMomentItLeavesAReadableLog) {
  auto whole = options("whole", 30.0);
  run(whole);
  const std::string right = text("whole/log.csv");
  std::mt19937 random(50);
  int with_rows = 0;
  for (int kill_number = 0; kill_number < 50; ++kill_number) {
    const pid_t child = start({"run", kScenario, "--duration", "30", "--out", (folder_ / "killed").string()});
    std::this_thread::sleep_for(std::chrono::microseconds(tests::kSlower * (20'000 + random() % 400'000)));
    kill(child, SIGKILL);
    exit_code(child);
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename().string().rfind(".killed.", 0) != 0) continue;
      const fs::path log = entry.path() / "log.csv";
      if (fs::exists(log) && fs::file_size(log) > 0) {
        std::ifstream file(log, std::ios::binary);
        const std::string left{std::istreambuf_iterator<char>(file), {}};
        // The beginning of the whole run's log, ending with a complete row.
        EXPECT_EQ(left.back(), '\n');
        EXPECT_EQ(right.compare(0, left.size(), left), 0);
        const auto rows = std::count(left.begin(), left.end(), '\n') - 1;
        with_rows += rows > 0;
      }
      fs::remove_all(entry.path());
    }
    if (fs::exists(folder_ / "killed")) fs::remove_all(folder_ / "killed");  // it had finished already
  }
  EXPECT_GT(with_rows, 5);
}

TEST_F(Run, AKilledRunsLogIsPointedOutToTheNext) {
  const pid_t child = start({"run", kScenario, "--realtime", "--duration", "30", "--out", (folder_ / "a").string()});
  std::this_thread::sleep_for(tests::kSlower * 500ms);
  kill(child, SIGKILL);
  exit_code(child);
  const auto outcome = run(options("a", 0.1));
  ASSERT_FALSE(outcome.notes.empty());
  EXPECT_NE(outcome.notes.back().find("killed"), std::string::npos);
}

TEST_F(Run, SigtermEndsItInOrder) {
  const pid_t child = start({"run", kScenario, "--realtime", "--duration", "30", "--out", (folder_ / "a").string()});
  std::this_thread::sleep_for(tests::kSlower * 800ms);
  kill(child, SIGTERM);
  EXPECT_EQ(exit_code(child), 0);
  const auto json = summary("a");
  EXPECT_EQ(json["stopped_early"], true);
  const std::string log = text("a/log.csv");
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n') - 1, json["steps"].get<int>());
}

TEST_F(Run, AFullDiskEndsTheRunAndKeepsTheLogSoFar) {
  constexpr rlim_t kLargest = 200'000;
  const pid_t child = start({"run", kScenario, "--duration", "30", "--out", (folder_ / "a").string()}, kLargest);
  EXPECT_EQ(exit_code(child), 1);
  const std::string log = text("a/log.csv");
  EXPECT_GT(log.size(), kLargest / 2);
  EXPECT_LE(log.size(), kLargest);
  EXPECT_EQ(log.back(), '\n');
}

TEST_F(Run, ExitCodesTellFaultsFromBadInput) {
  const auto out = (folder_ / "a").string();
  EXPECT_EQ(exit_code(start({"run", kScenario, "--duration", "0.2", "--out", out})), 0);
  EXPECT_EQ(exit_code(start({"run", kScenario, "--duration", "2", "--inject", "throw_on_read@100", "--out", out})), 1);
  EXPECT_EQ(exit_code(start({"run", kScenario, "--device", "floppy", "--out", out})), 2);
  EXPECT_EQ(exit_code(start({"run", kScenario})), 2);
  EXPECT_EQ(exit_code(start({"plant", kScenario, "--listen", "nowhere"})), 2);
  EXPECT_EQ(exit_code(start({"plant", kScenario, "--listen", "127.0.0.1:0", "--key", "/does/not/exist"})), 2);
}

TEST(LiveLoop, TakesGainsAndGivesSamplesWithoutStopping) {
  auto scenario = io::read_scenario(kScenario);
  device::LiveLoop live(device::open_device("sim", {scenario}), scenario);
  live.start();
  live.set_gains({650.0, 2.0, 120.0});
  device::StepRecord record;
  std::uint64_t expected = 0;
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (expected < 800 && std::chrono::steady_clock::now() < end) {
    while (live.pop(record)) EXPECT_EQ(record.step, expected++);
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_GE(expected, 800u);
  EXPECT_TRUE(live.status().running);
  EXPECT_EQ(live.status().gains.stiffness_N_per_m, 650.0);
  live.trip();
  while (std::chrono::steady_clock::now() < end && live.status().fault.fault == device::Fault::none) {
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_EQ(live.status().fault.fault, device::Fault::external);
  live.stop();
  EXPECT_FALSE(live.status().running);
  // And again from the first sample, the fault forgotten.
  live.start();
  while (!live.pop(record) && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(record.step, 0u);
  EXPECT_EQ(record.fault, device::Fault::none);
}

TEST(LiveLoop, HoldsStillAndRunsSlowly) {
  auto scenario = io::read_scenario(kScenario);
  device::LiveLoop live(device::open_device("sim", {scenario}), scenario);
  live.set_speed(0.0);
  live.start();
  std::this_thread::sleep_for(100ms);
  const auto waiting = live.status().steps;
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(live.status().steps, waiting);
  live.set_speed(0.5);
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (live.status().steps < waiting + 20 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
  EXPECT_GE(live.status().steps, waiting + 20);
}

}  // namespace
}  // namespace handloop::studies
