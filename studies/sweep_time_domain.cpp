#include <map>

#include "models/scenario_tip.h"
#include "studies/sweep_judge.h"
#include "studies/time_domain.h"

namespace handloop::studies {
namespace {

class TimeDomainJudge final : public SweepJudge {
 public:
  explicit TimeDomainJudge(const SweepSettings& settings) : conditions_(sweep_conditions(settings)) {
    for (const SweepCondition& c : conditions_) {
      arms_.try_emplace(c.axis, c.axis, settings);
      models::Scenario scenario = still_scenario(settings.scenario, c.axis);
      scenario.arm.attached = true;
      scenario.loop.delay_samples = c.delay_samples;
      // a device's inertia is varied at its tip, its damping at the joints
      scenario.device.stylus_mass_kg += (c.mass_factor - 1) * models::tip_of(scenario, c.axis).mass_kg;
      scenario.device.joint_viscous_Nms_per_rad *= c.damping_factor;
      TimeDomainLoop tried(scenario);  // what cannot be simulated is said before the work begins
      scenarios_.push_back(std::move(scenario));
    }
  }

  std::unique_ptr<Workspace> make_workspace() const override { return std::make_unique<Workspace>(); }

  void judge(const SweepBlock& block, std::span<const SweepPoint> points, Workspace&,
             std::span<Evaluation> out) const override {
    const std::uint32_t c = points[0].condition;
    models::Scenario scenario = scenarios_[c];
    const ArmSample& arms = arms_.at(conditions_[c].axis);
    for (std::uint64_t a = 0; a < block.arm_count; ++a) {
      scenario.arm.axes[static_cast<std::size_t>(conditions_[c].axis)] = arms[block.first_arm + a];
      TimeDomainLoop loop(scenario);
      for (std::size_t p = 0; p < points.size(); ++p) {
        const TimeDomainVerdict verdict = loop.judge(points[p].stiffness_N_per_m, points[p].damping_Ns_per_m);
        out[p * block.arm_count + a] = {.stable = verdict.stable ? 1.0 : 0.0, .rho = verdict.growth_per_sample};
      }
    }
  }

 private:
  std::vector<SweepCondition> conditions_;
  std::vector<models::Scenario> scenarios_;
  std::map<models::Axis, ArmSample> arms_;
};

}  // namespace

std::unique_ptr<SweepJudge> make_time_domain_judge(const SweepSettings& settings) {
  return std::make_unique<TimeDomainJudge>(settings);
}

}  // namespace handloop::studies
