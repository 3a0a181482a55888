#pragma once

#include <memory>
#include <span>
#include <vector>

#include "studies/sweep_plan.h"
#include "studies/sweep_statistics.h"

namespace handloop::studies {

/// Judges blocks of a sweep. Immutable and shared by all threads; each thread has a workspace of its own.
class SweepJudge {
 public:
  /// Scratch of one thread.
  class Workspace {
   public:
    virtual ~Workspace() = default;
  };

  virtual ~SweepJudge() = default;
  virtual std::unique_ptr<Workspace> make_workspace() const = 0;
  /// Fills out[p * block.arm_count + a] for the block's points (given in `points`, block.point_count of them) and arms.
  virtual void judge(const SweepBlock& block, std::span<const SweepPoint> points, Workspace& workspace,
                     std::span<Evaluation> out) const = 0;
};

/// By the settings' method. Throws InputError where the scenario cannot be judged by it.
std::unique_ptr<SweepJudge> make_sweep_judge(const SweepSettings& settings);

std::unique_ptr<SweepJudge> make_margin_judge(const SweepSettings& settings);
std::unique_ptr<SweepJudge> make_time_domain_judge(const SweepSettings& settings);

/// The arms of one axis, the first of them kept so that no block draws them again.
class ArmSample {
 public:
  ArmSample(models::Axis axis, const SweepSettings& settings);
  models::ArmParameters operator[](std::uint64_t arm) const {
    return arm < kept_.size() ? kept_[arm] : population_.sample(seed_, arm);
  }

 private:
  models::ArmPopulation population_;
  std::uint64_t seed_;
  std::vector<models::ArmParameters> kept_;
};

}  // namespace handloop::studies
