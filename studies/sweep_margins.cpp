#include <array>
#include <cmath>
#include <map>

#include "control/linear_plant.h"
#include "control/margins.h"
#include "models/scenario_tip.h"
#include "studies/sweep_judge.h"

namespace handloop::studies {
namespace {

/// Arms kept in memory: 40 bytes each.
constexpr std::uint64_t kKeptArms = 1 << 20;

class MarginJudge final : public SweepJudge {
 public:
  explicit MarginJudge(const SweepSettings& settings) : conditions_(sweep_conditions(settings)) {
    const models::LoopSettings& loop = settings.scenario.loop;
    timing_ = {loop.sample_time_s, loop.delay_samples, loop.cutoff_Hz};
    for (const SweepCondition& c : conditions_) {
      arms_.try_emplace(c.axis, c.axis, settings);
      const models::ScenarioTip tip = models::tip_of(settings.scenario, c.axis);
      plants_.push_back({c.mass_factor * tip.mass_kg, c.damping_factor * tip.damping_Ns_per_m, std::nullopt});
    }
    for (const auto& [axis, effect] : settings.scenario.arm.effects) effects_[axis].push_back(effect);
  }

  std::unique_ptr<Workspace> make_workspace() const override { return std::make_unique<Workspace>(); }

  void judge(const SweepBlock& block, std::span<const SweepPoint> points, Workspace&,
             std::span<Evaluation> out) const override {
    const std::uint32_t c = points[0].condition;
    const ArmSample& arms = arms_.at(conditions_[c].axis);
    control::LoopTiming timing = timing_;
    timing.delay_samples = conditions_[c].delay_samples;
    control::LoopPlant plant = plants_[c];
    const bool with_effects = effects_.contains(conditions_[c].axis);
    for (std::uint64_t a = 0; a < block.arm_count; ++a) {
      plant.arm = arms[block.first_arm + a];
      const control::SampledPlant sampled = control::sample_plant(plant, timing.sample_time_s);
      for (std::size_t p = 0; p < points.size(); ++p) {
        const control::WallGains gains{points[p].stiffness_N_per_m, points[p].damping_Ns_per_m};
        const control::Margins m =
            with_effects ? judge_with_effects(c, *plant.arm, timing, gains) : control::evaluate(sampled, timing, gains);
        out[p * block.arm_count + a] = {m.stable ? 1.0 : 0.0, m.rho,     m.gain_up, m.gain_down,
                                        m.phase_deg,          m.delay_s, m.modulus, m.disk_alpha};
      }
    }
  }

 private:
  /// The wall on an arm with the scenario's effects, each by its linear stand-in at the usual operating point.
  control::Margins judge_with_effects(std::uint32_t c, const models::ArmParameters& arm,
                                      const control::LoopTiming& timing, const control::WallGains& gains) const {
    models::AxisModel model;
    model.axis = conditions_[c].axis;
    model.arm = arm;
    model.effects = effects_.at(model.axis);
    return control::evaluate(model, {}, plants_[c].tip_mass_kg, plants_[c].tip_damping_Ns_per_m, timing, gains);
  }

  std::vector<SweepCondition> conditions_;
  std::vector<control::LoopPlant> plants_;
  std::map<models::Axis, ArmSample> arms_;
  std::map<models::Axis, std::vector<models::EffectPtr>> effects_;  ///< axes without any are not in it
  control::LoopTiming timing_;
};

}  // namespace

ArmSample::ArmSample(models::Axis axis, const SweepSettings& settings)
    : population_(axis, settings.percentiles), seed_(settings.seed) {
  kept_.resize(std::min(settings.arms, kKeptArms));
  for (std::uint64_t i = 0; i < kept_.size(); ++i) kept_[i] = population_.sample(seed_, i);
}

std::unique_ptr<SweepJudge> make_margin_judge(const SweepSettings& settings) {
  return std::make_unique<MarginJudge>(settings);
}

}  // namespace handloop::studies
