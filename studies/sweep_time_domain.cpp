#include "models/errors.h"
#include "studies/sweep_judge.h"

namespace handloop::studies {
std::unique_ptr<SweepJudge> make_time_domain_judge(const SweepSettings&) {
  throw InputError("sweep: --method mujoco is not built yet");
}
}  // namespace handloop::studies
