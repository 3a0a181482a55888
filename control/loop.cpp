#include "control/loop.h"

#include <string>

#include "models/errors.h"

namespace handloop::control {
namespace {

void require(bool condition, const char* name, double value, const char* right) {
  if (!condition) {
    throw InputError(std::string(name) + " = " + std::to_string(value) + " is not possible: it must be " + right);
  }
}

}  // namespace

void require_valid(const LoopPlant& plant) {
  require(std::isfinite(plant.tip_mass_kg) && plant.tip_mass_kg > 0, "tip mass m", plant.tip_mass_kg,
          "a finite number of kg above zero");
  require(std::isfinite(plant.tip_damping_Ns_per_m) && plant.tip_damping_Ns_per_m >= 0, "tip damping b",
          plant.tip_damping_Ns_per_m, "a finite number of N s/m, zero or more");
  if (plant.arm) models::require_valid(*plant.arm);
}

void require_valid(const LoopTiming& timing) {
  require(std::isfinite(timing.sample_time_s) && timing.sample_time_s > 0, "sample time T", timing.sample_time_s,
          "a finite number of seconds above zero");
  require(timing.delay_samples >= 0 && timing.delay_samples <= kMaxDelaySamples, "delay_samples", timing.delay_samples,
          "a whole number from 0 to 64");
  require(timing.cutoff_Hz > 0, "cutoff_Hz", timing.cutoff_Hz, "above zero (inf: no filter)");
}

void require_valid(const Loop& loop) {
  require_valid(loop.plant);
  require_valid(loop.timing);
  require(std::isfinite(loop.gains.stiffness_N_per_m), "stiffness K", loop.gains.stiffness_N_per_m, "a finite number");
  require(std::isfinite(loop.gains.damping_Ns_per_m), "damping B", loop.gains.damping_Ns_per_m, "a finite number");
}

}  // namespace handloop::control
