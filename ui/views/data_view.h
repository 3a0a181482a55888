#pragma once

#include <optional>
#include <string>

#include "control/margins.h"
#include "ui/background/explain_job.h"
#include "ui/views/bench.h"
#include "ui/widgets/file_dialog.h"

namespace handloop::ui {

/// A recording, what `explain` makes of it, and a button that puts the found effect into simulation and margins.
class DataView {
 public:
  void open(const Bench& bench, const std::filesystem::path& recording);
  void show(Bench& bench);
  const ExplainJob& job() const { return job_; }

 private:
  void request(Bench& bench);
  void waiting();
  void verdict(const ExplainedRecording& found);
  void before_after(const ExplainedRecording& found, float width);
  void apply(Bench& bench, const ExplainedRecording& found);
  void signals(const ExplainedRecording& found, float width, float height);
  void fingerprints(const ExplainedRecording& found, float width, float height);
  void rivals(const ExplainedRecording& found);

  ExplainJob job_;
  ExplainRequest request_;
  FileDialog dialog_;
  std::string path_;
  std::optional<control::Margins> margins_before_;  ///< of the bench when something was applied
  std::string applied_;
};

}  // namespace handloop::ui
