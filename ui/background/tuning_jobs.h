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
  const std::optional<studies::PopulationTuning>& population() const { return population_; }
  const std::string& problem() const { return problem_; }
  bool busy() const { return nominal_job_.busy() || robust_job_.busy() || population_job_.busy(); }
  double population_share() const { return population_job_.share(); }
  bool sampling() const { return population_job_.busy(); }
  void cancel_sampling() { population_job_.cancel(); }
  /// How long the last answers took, s: the nominal loop, and the sampled arms with map cloud.
  double nominal_seconds() const { return nominal_seconds_; }
  double population_seconds() const { return population_seconds_; }

  std::size_t arms = 2000;
  std::uint64_t seed = 1;
  /// Asks for the population anew (other seed or number).
  void resample() { population_revision_ = 0; }

 private:
  template <typename T>
  struct Timed {
    T value;
    double seconds = 0.0;
  };
  void start(const models::Scenario& scenario);
  void sample(const models::Scenario& scenario);

  LatestJob<Timed<studies::NominalTuning>> nominal_job_;
  LatestJob<studies::RobustTuning> robust_job_;
  LatestJob<Timed<studies::PopulationTuning>> population_job_;
  std::optional<studies::NominalTuning> nominal_;
  std::optional<studies::RobustTuning> robust_;
  std::optional<studies::PopulationTuning> population_;
  std::string problem_;
  std::uint64_t revision_ = 0, population_revision_ = 0;
  models::Axis axis_ = models::Axis::z;
  double nominal_seconds_ = 0.0, population_seconds_ = 0.0;
};

}  // namespace handloop::ui
