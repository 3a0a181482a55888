// How far is a virtual wall from instability, held by the nominal arm and by a thousand others?
#include <cstdio>

#include "control/margins.h"
#include "models/arm_population.h"
#include "models/arm_tables.h"

using namespace handloop;

int main() {
  control::Loop loop;  // 75 g at the tip, 1 kHz, one sample of delay
  loop.gains = {.stiffness_N_per_m = 400, .damping_Ns_per_m = 1};

  for (const auto axis : models::kAxes) {
    loop.plant.arm = models::nominal_arm(axis);
    const auto margins = control::evaluate(loop);

    const models::ArmPopulation population(axis);
    int stable = 0;
    constexpr int kArms = 1000;
    for (int i = 0; i < kArms; ++i) {
      loop.plant.arm = population.sample(1, i);
      stable += control::evaluate(loop).stable;
    }
    std::printf("axis %s: gain margin %.2f, phase margin %.1f deg, stable for %.1f %% of arms\n",
                models::axis_name(axis).data(), margins.gain_up, margins.phase_deg, 100.0 * stable / kArms);
  }
}
