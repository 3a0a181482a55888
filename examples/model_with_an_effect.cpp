// Adds an effect of the catalogue to an arm, shows what it does to the arm's compliance, and writes the model file that
// every command reads with --arm.
#include <complex>
#include <cstdio>
#include <numbers>

#include "io/model_file.h"
#include "models/arm_tables.h"
#include "models/axis_model.h"

using namespace handloop;

int main() {
  models::AxisModel plain;
  plain.axis = models::Axis::x;
  plain.arm = models::nominal_arm(plain.axis);

  auto augmented = plain;
  augmented.effects.push_back(models::make_typical_effect("coulomb_friction", models::Place::arm));

  models::AxisOperatingPoint motion;  // friction counts most where motion is small
  motion.arm = {.x_rms_m = 1e-3, .v_rms_m_per_s = 0.02};
  for (const double frequency_Hz : {0.6, 3.0, 10.0, 30.0}) {
    const std::complex<double> s(0, 2 * std::numbers::pi * frequency_Hz);
    std::printf("%5.1f Hz: |x/F| = %.3f mm/N without friction, %.3f with\n", frequency_Hz,
                1e3 * std::abs(models::compliance(plain, motion, s)),
                1e3 * std::abs(models::compliance(augmented, motion, s)));
  }
  io::write_model("arm_with_friction.toml", augmented);
}
