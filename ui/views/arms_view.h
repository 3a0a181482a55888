#pragma once

#include <optional>
#include <string>

#include "studies/arm_survey.h"
#include "ui/background/latest_job.h"
#include "ui/views/bench.h"

namespace handloop::ui {

/// How much arms differ: the five parameters against Table III, the population's Bode fan and |W_u|, and what each arm
/// does to the margin.
class ArmsView {
 public:
  void show(Bench& bench);

 private:
  void follow(const Bench& bench);
  void chooser(Bench& bench);
  void parameters(Bench& bench);
  void histogram(Bench& bench, std::size_t parameter, float height);
  void bode(const Bench& bench, float width, float height);
  void envelopes(float width, float height);
  void margins(Bench& bench, float width, float height);

  LatestJob<studies::ArmSurvey> job_;
  std::optional<studies::ArmSurvey> survey_;
  std::optional<models::ArmPopulation> population_;
  std::uint64_t revision_ = 0, seed_ = 1, asked_seed_ = 1;
  std::uint64_t subject_ = 0;
  std::size_t against_ = 0;  ///< parameter on the axis of the margins' picture
  std::string compared_;     ///< name of an arm of Table V
};

}  // namespace handloop::ui
