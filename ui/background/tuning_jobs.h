#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "studies/tuning.h"
#include "ui/background/latest_job.h"

namespace handloop::ui {

/// Keeps the answers about a scenario fresh: what takes less than a millisecond at once, the rest behind the window.
class TuningJobs {
 public:
  /// To be called once a frame with the scenario in force; does something only where the revision is new or an answer
  /// has come.
  void follow(const models::Scenario& scenario, std::uint64_t revision);

  /// Of the newest scenario, or with effects of the newest that was finished. Empty where it has no answer: `problem`.
  const std::optional<studies::NominalTuning>& nominal() const { return nominal_; }
  const std::optional<studies::RobustTuning>& robust() const { return robust_; }
  const std::optional<control::PopulationMargins>& population() const { return population_; }
  const std::optional<studies::PopulationLimits>& limits() const { return limits_; }
  const std::string& problem() const { return problem_; }
  bool busy() const {
    return nominal_job_.busy() || robust_job_.busy() || population_job_.busy() || limits_job_.busy();
  }
  /// How long the last answers took, s: the nominal loop, and the margins of the sampled arms.
  double nominal_seconds() const { return nominal_seconds_; }
  double population_seconds() const { return population_seconds_; }

  /// The K-B map: what is about the gains, or the whole region of stability.
  bool whole_map() const { return whole_map_; }
  void show_whole_map(bool whole);

  static constexpr std::size_t kArms = 2000;
  static constexpr std::uint64_t kSeed = 1;

 private:
  template <typename T>
  struct Timed {
    T value;
    double seconds = 0.0;
  };
  void start(const models::Scenario& scenario);
  void take_answers();

  LatestJob<Timed<studies::NominalTuning>> nominal_job_;
  LatestJob<studies::RobustTuning> robust_job_;
  LatestJob<Timed<control::PopulationMargins>> population_job_;
  LatestJob<studies::PopulationLimits> limits_job_;
  std::optional<studies::NominalTuning> nominal_;
  std::optional<studies::RobustTuning> robust_;
  std::optional<control::PopulationMargins> population_;
  std::optional<studies::PopulationLimits> limits_;
  std::string problem_;
  std::uint64_t revision_ = 0, limits_revision_ = 0;
  bool whole_map_ = false;
  models::Axis axis_ = models::Axis::z;
  double nominal_seconds_ = 0.0, population_seconds_ = 0.0;
};

}  // namespace handloop::ui
