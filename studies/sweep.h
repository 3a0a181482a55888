#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/arm_population.h"
#include "models/axis.h"
#include "models/scenario.h"

/// Stability sweeps: how many of the people who may hold the device meet a stable wall, at every gain of interest.
///
/// A sweep is made of points: a condition (axis, delay, device) and a pair of gains. At each point every arm of the
/// sample is judged, by the margins of the sampled loop or in the time domain by MuJoCo. What is drawn is a function of
/// seed and index alone, so the results do not depend on threads, ranks or interruptions.
namespace handloop::studies {

enum class SweepMethod { margins, mujoco };
enum class SweepDesign {
  grid,             ///< every stiffness with every damping
  latin_hypercube,  ///< `points` pairs that fill the ranges evenly
  adaptive          ///< a coarse grid, refined where the share of stable arms crosses `boundary`
};

SweepMethod parse_sweep_method(std::string_view text);
SweepDesign parse_sweep_design(std::string_view text);
std::string_view sweep_method_name(SweepMethod method);
std::string_view sweep_design_name(SweepDesign design);

/// Values from low to high, both ends included; `logarithmic` needs low > 0.
struct GainRange {
  double low = 0.0;
  double high = 0.0;
  int count = 1;
  bool logarithmic = false;

  double at(int index) const;           ///< 0 .. count - 1
  double at_share(double share) const;  ///< 0 .. 1
  bool operator==(const GainRange&) const = default;
};

/// Both gain axes from "k=LO:HI:N,b=LO:HI:N" (":log" may follow N; "k=800" is one value). What is not given stays.
/// Throws InputError saying what is wrong with which part.
void parse_gain_ranges(std::string_view text, GainRange& stiffness, GainRange& damping);

/// What decides the results. Two sweeps with equal settings have equal rows.
struct SweepSettings {
  models::Scenario scenario;
  std::string scenario_name;  ///< for people; not compared
  std::uint64_t arms = 1000;
  GainRange stiffness;  ///< N/m
  GainRange damping;    ///< Ns/m
  SweepMethod method = SweepMethod::margins;
  SweepDesign design = SweepDesign::grid;
  int points = 200;                ///< latin_hypercube
  int levels = 3;                  ///< adaptive: halvings of the coarse grid's cells
  double boundary = 0.95;          ///< adaptive: share of stable arms to follow
  std::vector<models::Axis> axes;  ///< empty: the scenario's wall axis
  std::vector<int> delays;         ///< empty: the scenario's
  int devices = 1;                 ///< 1: the nominal device; more: drawn about it (docs/sweeps.md)
  models::PercentileReading percentiles = models::PercentileReading::ecdf;
  std::uint64_t seed = 1;
  bool keep_evaluations = true;  ///< a row for every arm at every point, not only the points' statistics
};

/// How to run it; none of this changes a result.
struct SweepRun {
  std::filesystem::path out;
  int jobs = 0;  ///< threads of this process; 0: as many as it may use
  bool resume = false;
  std::vector<std::string> requirements{};
  std::optional<std::filesystem::path> compare_with{};
  bool fail_on_regression = false;
  bool quiet = false;
};

/// One requirement after the sweep.
struct RequirementOutcome {
  std::string expression;
  bool met = false;
  std::string detail;  ///< the worst value and where it stands
};

struct SweepOutcome {
  std::uint64_t points = 0;
  std::uint64_t evaluations = 0;
  std::uint64_t evaluated_now = 0;  ///< the rest was in the database before
  double seconds = 0.0;
  std::vector<RequirementOutcome> requirements;
  std::string comparison;  ///< plain text; empty without compare_with
  bool regression = false;
  bool requirements_met() const;
};

/// Called now and then with (done, total, seconds since the start); total grows in an adaptive sweep.
using SweepProgress = std::function<void(std::uint64_t, std::uint64_t, double)>;

/// Runs the sweep and writes DIR/sweep.sqlite, summary.json, report.html and junit.xml. While it runs the results are
/// in DIR/sweep.sqlite.part, committed block by block; it becomes sweep.sqlite when complete. In a rank other than 0 of
/// an MPI run it serves rank 0 and returns nothing. Throws InputError: settings that are not possible, an unfinished
/// sweep without `resume`, a database of another sweep or version, a full disk.
std::optional<SweepOutcome> run_sweep(const SweepSettings& settings, const SweepRun& run,
                                      const SweepProgress& progress);

}  // namespace handloop::studies
