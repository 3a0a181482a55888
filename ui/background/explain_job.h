#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "studies/explain.h"
#include "ui/background/latest_job.h"
#include "ui/traces/min_max_ring.h"

namespace handloop::ui {

/// What the data view asks for.
struct ExplainRequest {
  std::filesystem::path recording;
  identify::ExplainOptions options;
};

/// A recording, and once it is explained what was found; signals ready to be drawn at any zoom.
struct ExplainedRecording {
  studies::ExplainStudy study;
  studies::ExplainOutcome outcome;
  MinMaxRing force, position, residual_before, residual_after;
};

/// `explain` behind the window.
class ExplainJob {
 public:
  void start(const ExplainRequest& request);
  void cancel();
  /// Once a frame.
  void follow();

  bool busy() const { return job_.busy(); }
  double share() const { return job_.share(); }
  std::string note() { return job_.note(); }
  const std::optional<ExplainedRecording>& result() const { return result_; }
  const std::string& problem() const { return problem_; }

 private:
  LatestJob<ExplainedRecording> job_;
  std::optional<ExplainedRecording> result_;
  std::string problem_;
};

}  // namespace handloop::ui
