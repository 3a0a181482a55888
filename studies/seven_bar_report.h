#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "device/record.h"
#include "io/plot.h"
#include "studies/run.h"
#include "studies/seven_bar_replay.h"

namespace handloop::studies {

/// What the pictures of a run of the seven-bar linkage need: means over 2 ms. x forward, y up, positions from home.
class SevenBarRunTrace {
 public:
  SevenBarRunTrace(double sample_time_s, const Eigen::Vector3d& home_m);
  void reserve(std::uint64_t samples);
  /// Returns the record as the stability judge should see it: the hand means to move, so only what is faster than a
  /// hand (above 5 Hz) counts as speed. Real-time safe after reserve().
  const device::StepRecord& add(const device::StepRecord& record) noexcept;

  double sample_time_s() const { return sample_time_s_ * static_cast<double>(every_); }
  std::vector<double> time_s;
  std::array<std::vector<double>, 2> position_m, hand_N, environment_N;

 private:
  double sample_time_s_;
  Eigen::Vector3d home_m_;
  std::uint64_t every_, in_mean_ = 0;
  Eigen::Matrix<double, 2, 3> sum_ = Eigen::Matrix<double, 2, 3>::Zero();  ///< position, hand, environment
  Eigen::Vector3d slow_m_per_s_ = Eigen::Vector3d::Zero();
  double slow_pole_;
  device::StepRecord judged_;
};

/// The trace of a run in lock-step, without its files; a fault ends it.
SevenBarRunTrace trace_of(const models::Scenario& scenario);

/// Their Figures 9 to 16, or 17 and 18 where the run did not go through, with a name for each.
struct SevenBarFigures {
  std::vector<std::pair<std::string, io::Plot>> plots;
  std::array<Slope, 2> slopes;  ///< f_e against f_h - f_h*; empty where there is none
  double tracking_error = 0.0;  ///< of the replay without environment
  bool compared = false;
};
SevenBarFigures seven_bar_figures(const models::Scenario& scenario, const SevenBarRunTrace& trace, bool stable);

/// report.html of a run. Throws RequirementError where gnuplot is missing.
void write_seven_bar_report(const std::filesystem::path& path, const RunOptions& options, const RunOutcome& outcome,
                            const SevenBarRunTrace& trace);

}  // namespace handloop::studies
