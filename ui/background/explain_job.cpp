#include "ui/background/explain_job.h"

#include "io/recording_file.h"
#include "models/errors.h"

namespace handloop::ui {
namespace {

MinMaxRing ring_of(const std::vector<double>& values) {
  MinMaxRing ring;
  for (const double value : values) ring.add(static_cast<float>(value));
  return ring;
}

}  // namespace

void ExplainJob::start(const ExplainRequest& request) {
  problem_.clear();
  result_.reset();
  job_.request([request](JobContext& context) -> std::optional<ExplainedRecording> {
    context.progress(0.0, "reading");
    ExplainedRecording explained;
    explained.study.recording = io::read_recording(request.recording);
    explained.study.options = request.options;
    explained.study.options.search.progress = [&context](double share, const std::string& what) {
      // the only way out of a search: nobody waits for its answer any more
      if (context.cancelled()) throw std::runtime_error("cancelled");
      context.progress(share, what);
    };
    explained.outcome = studies::run_explain(explained.study);
    explained.study.options.search.progress = nullptr;
    explained.force = ring_of(explained.study.recording.force_N);
    explained.position = ring_of(explained.study.recording.position_m);
    explained.residual_before = ring_of(explained.outcome.explanation.residual_before);
    explained.residual_after = ring_of(explained.outcome.explanation.residual_after);
    return explained;
  });
}

void ExplainJob::cancel() {
  job_.cancel();
}

void ExplainJob::follow() {
  if (auto done = job_.take()) result_ = std::move(*done);
  if (auto error = job_.take_error(); !error.empty()) problem_ = error;
}

}  // namespace handloop::ui
