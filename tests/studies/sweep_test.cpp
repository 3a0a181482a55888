#include "studies/sweep.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include "control/margins.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "models/phantom.h"
#include "studies/sweep_compare.h"
#include "studies/sweep_requirements.h"
#include "studies/sweep_store.h"

namespace handloop::studies {
namespace {

namespace fs = std::filesystem;

SweepSettings small_sweep() {
  SweepSettings s;
  s.scenario = io::default_scenario();
  s.scenario_name = "test";
  s.arms = 60;
  s.stiffness = {100, 3000, 5};
  s.damping = {0, 5, 3};
  s.seed = 4;
  return s;
}

class Sweep : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("handloop_sweep_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  SweepRun run(const std::string& name, int jobs = 1) const {
    return {.out = folder_ / name, .jobs = jobs, .requirements = {}, .quiet = true};
  }
  fs::path folder_;
};

TEST_F(Sweep, EveryCellIsWhatTheMarginsOfItsArmsSay) {
  SweepSettings s = small_sweep();
  run_sweep(s, run("a"), {});
  SweepStore store = SweepStore::read(folder_ / "a" / "sweep.sqlite");
  const auto points = store.points();
  const auto cells = store.cells();
  ASSERT_EQ(points.size(), 15u);
  const models::ArmPopulation population(s.scenario.wall.axis);
  const auto& device = s.scenario.device;
  control::Loop loop;
  loop.plant.tip_mass_kg =
      models::phantom_tip_inertia_kg(models::phantom_parameters(device.parameter_set, device.stylus_mass_kg),
                                     Eigen::Vector3d::Zero(), s.scenario.wall.axis);
  // arm z is device x, moved at home by joint 3 alone at the length of the forearm... and by no other: b = b3 / l2^2
  ASSERT_EQ(s.scenario.wall.axis, models::Axis::z);
  loop.plant.tip_damping_Ns_per_m = device.joint_viscous_Nms_per_rad / (0.170 * 0.170);
  loop.timing = {s.scenario.loop.sample_time_s, s.scenario.loop.delay_samples, s.scenario.loop.cutoff_Hz};
  for (std::size_t p = 0; p < points.size(); ++p) {
    loop.gains = {points[p].stiffness_N_per_m, points[p].damping_Ns_per_m};
    std::uint64_t stable = 0;
    double least = INFINITY;
    for (std::uint64_t a = 0; a < s.arms; ++a) {
      loop.plant.arm = population.sample(s.seed, a);
      const control::Margins m = control::evaluate(loop);
      stable += m.stable;
      least = std::min(least, m.stable ? m.disk_alpha : -1);
    }
    EXPECT_EQ(cells[p].stable, stable);
    if (least > 0) {
      EXPECT_NEAR(cells[p].margins[4].min, least, 1e-9 * least);
    } else {
      EXPECT_TRUE(std::isnan(cells[p].margins[4].min));
    }
  }
}

TEST_F(Sweep, AdaptiveFindsTheSameBoundaryWithFewerPoints) {
  SweepSettings fine = small_sweep();
  fine.stiffness.count = 17;
  fine.damping.count = 9;
  SweepSettings adaptive = small_sweep();
  adaptive.stiffness.count = 5;
  adaptive.damping.count = 3;
  adaptive.design = SweepDesign::adaptive;
  adaptive.levels = 2;  // down to the fine grid's step
  run_sweep(fine, run("fine"), {});
  run_sweep(adaptive, run("adaptive"), {});
  SweepStore all = SweepStore::read(folder_ / "fine" / "sweep.sqlite"),
             few = SweepStore::read(folder_ / "adaptive" / "sweep.sqlite");
  const auto fine_points = all.points(), points = few.points();
  const auto fine_cells = all.cells(), cells = few.cells();
  EXPECT_LT(points.size(), 3 * fine_points.size() / 5);  // 77 of 153
  std::map<std::pair<double, double>, std::size_t> where;
  for (std::size_t p = 0; p < points.size(); ++p) where[{points[p].stiffness_N_per_m, points[p].damping_Ns_per_m}] = p;
  EXPECT_EQ(where.size(), points.size()) << "no point twice";
  // wherever two neighbours of the fine grid lie on both sides of the boundary, the adaptive sweep has both
  for (std::size_t p = 0; p + 9 < fine_points.size(); ++p) {
    const std::size_t q = p + 9;  // the next stiffness at the same damping
    if ((fine_cells[p].p_stable() >= 0.95) == (fine_cells[q].p_stable() >= 0.95)) continue;
    for (const std::size_t side : {p, q}) {
      const auto found = where.find({fine_points[side].stiffness_N_per_m, fine_points[side].damping_Ns_per_m});
      ASSERT_NE(found, where.end()) << fine_points[side].stiffness_N_per_m << ", "
                                    << fine_points[side].damping_Ns_per_m;
      EXPECT_EQ(cells[found->second].stable, fine_cells[side].stable);
    }
  }
}

TEST_F(Sweep, ALatinHypercubeFillsEveryStratumOnce) {
  SweepSettings s = small_sweep();
  s.design = SweepDesign::latin_hypercube;
  s.points = 40;
  std::set<int> k, b;
  for (const SweepPoint& p : first_points(s, 1)) {
    k.insert(static_cast<int>((p.stiffness_N_per_m - 100) / 2900 * 40));
    b.insert(static_cast<int>(p.damping_Ns_per_m / 5 * 40));
  }
  EXPECT_EQ(k.size(), 40u);
  EXPECT_EQ(b.size(), 40u);
}

TEST_F(Sweep, StatisticsOnlySweepsHaveTheSameCells) {
  SweepSettings s = small_sweep();
  run_sweep(s, run("kept"), {});
  s.keep_evaluations = false;
  run_sweep(s, run("cells"), {});
  SweepStore a = SweepStore::read(folder_ / "kept" / "sweep.sqlite"),
             b = SweepStore::read(folder_ / "cells" / "sweep.sqlite");
  const auto x = a.cells(), y = b.cells();
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(x[i].stable, y[i].stable);
    EXPECT_EQ(x[i].rho_p95, y[i].rho_p95);
  }
  EXPECT_TRUE(b.stable_arms(0).empty());
}

TEST_F(Sweep, AnotherSweepsDatabaseIsRefusedByName) {
  SweepSettings s = small_sweep();
  run_sweep(s, run("a"), {});
  SweepRun again = run("a");
  again.resume = true;
  EXPECT_NO_THROW(run_sweep(s, again, {}));
  for (const auto& [change, word] : std::initializer_list<std::pair<std::function<void(SweepSettings&)>, std::string>>{
           {[](SweepSettings& x) { x.seed = 5; }, "seed"},
           {[](SweepSettings& x) { x.arms = 61; }, "arms"},
           {[](SweepSettings& x) { x.scenario.loop.cutoff_Hz = 50; }, "scenario"}}) {
    SweepSettings other = s;
    change(other);
    try {
      run_sweep(other, again, {});
      ADD_FAILURE() << word;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("its " + word), std::string::npos) << error.what();
    }
  }
}

TEST_F(Sweep, AnUnfinishedSweepIsNotOverwritten) {
  fs::create_directories(folder_ / "a");
  { SweepStore::create(folder_ / "a" / "sweep.sqlite.part", small_sweep()); }
  EXPECT_THROW(run_sweep(small_sweep(), run("a"), {}), InputError);
  SweepRun resume = run("a");
  resume.resume = true;
  EXPECT_TRUE(run_sweep(small_sweep(), resume, {}).has_value());
  EXPECT_FALSE(fs::exists(folder_ / "a" / "sweep.sqlite.part"));
}

TEST_F(Sweep, ComparingWithItselfFindsNothingAndWithMoreDelayARegression) {
  SweepSettings s = small_sweep();
  s.arms = 300;
  run_sweep(s, run("now"), {});
  run_sweep(s, run("same"), {});
  SweepStore now = SweepStore::read(folder_ / "now" / "sweep.sqlite"),
             same = SweepStore::read(folder_ / "same" / "sweep.sqlite");
  const SweepComparison nothing = compare_sweeps(same, now);
  EXPECT_EQ(nothing.changes.size(), 15u);
  EXPECT_EQ(nothing.regressions() + nothing.improvements(), 0u);
  EXPECT_TRUE(nothing.settings.empty());

  s.scenario.loop.cutoff_Hz = 20;  // more lag in the damper, the same delay: the points are the same
  run_sweep(s, run("slow"), {});
  SweepStore slow = SweepStore::read(folder_ / "slow" / "sweep.sqlite");
  const SweepComparison worse = compare_sweeps(now, slow);
  EXPECT_GT(worse.regressions(), 0u);
  ASSERT_EQ(worse.settings.size(), 1u);
  EXPECT_TRUE(worse.changes[0].paired);
  for (const PointChange& c : worse.changes) EXPECT_EQ(c.new_stable + c.lost, c.old_stable + c.won);
}

TEST_F(Sweep, ChanceIsNotCalledARegression) {
  SweepSettings s = small_sweep();
  s.arms = 300;
  run_sweep(s, run("one"), {});
  s.seed = 77;  // other arms of the same population
  run_sweep(s, run("two"), {});
  SweepStore one = SweepStore::read(folder_ / "one" / "sweep.sqlite"),
             two = SweepStore::read(folder_ / "two" / "sweep.sqlite");
  const SweepComparison change = compare_sweeps(one, two);
  EXPECT_FALSE(change.changes[0].paired);
  EXPECT_EQ(change.regressions() + change.improvements(), 0u);
}

TEST(SweepGains, AreReadAsPeopleWriteThem) {
  GainRange k, b{2, 2, 1};
  parse_gain_ranges("k=100:3000:8", k, b);
  EXPECT_EQ(k, (GainRange{100, 3000, 8}));
  EXPECT_EQ(b, (GainRange{2, 2, 1}));
  parse_gain_ranges("b=0.1:10:3:log,k=800", k, b);
  EXPECT_NEAR(b.at(1), 1.0, 1e-12);
  EXPECT_EQ(k.at(0), 800);
  for (const char* wrong : {"k=1:2", "k=5:1:3", "q=1:2:3", "k=0:5:3:log", "k=a:2:3", "k=1:2:0", "k=-1:2:3", ""})
    EXPECT_THROW(parse_gain_ranges(wrong, k, b), InputError) << wrong;
}

TEST(SweepRequirements, HoldAtEveryPointOrWhereTheySay) {
  const std::vector<SweepCondition> conditions(1);
  const std::vector<SweepPoint> points{{0, 0, 100, 1}, {0, 0, 800, 2}};
  std::vector<PointStatistics> cells(2);
  cells[0] = {.arms = 100, .stable = 100};
  cells[1] = {.arms = 100, .stable = 90};
  cells[0].margins[0].p05 = 3;
  const auto check = [&](const char* text) {
    return check_requirement(parse_requirement(text), conditions, points, cells).met;
  };
  EXPECT_TRUE(check("p_stable>=0.9"));
  EXPECT_FALSE(check("p_stable>0.9"));
  EXPECT_TRUE(check("p_stable >= 0.95 @ k=100,b=1"));
  EXPECT_TRUE(check("p_stable@k=100>=0.95"));
  EXPECT_FALSE(check("p_stable>=0.95@k=800"));
  EXPECT_TRUE(check("gm_up_p05>=2@b=1"));
  EXPECT_FALSE(check("gm_up_p05>=2")) << "a margin of unstable arms is below any number";
  EXPECT_FALSE(check("p_stable_lo95>=0.97@k=100")) << "100 of 100 leaves 0.9638";
  for (const char* wrong : {"p_stabel>=1", "p_stable", "p_stable>=x", "p_stable>=1@q=2", "p_stable>=1@k=5"})
    EXPECT_THROW(check(wrong), InputError) << wrong;
}

}  // namespace
}  // namespace handloop::studies
