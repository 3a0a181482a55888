#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/plot.h"
#include "models/arm_population.h"

/// Frequency response x/F of the published arms, before the fan of arms sampled from the population.
namespace handloop::studies {

struct BodeRequest {
  std::size_t count = 0;  ///< sampled arms
  std::uint64_t seed = 1;
  std::vector<std::string> literature;  ///< names of Table V, or "all"
};

/// One arm over ArmBode::frequency_Hz.
struct BodeCurve {
  std::string name;
  std::vector<double> magnitude_dB;  ///< of x/F, 0 dB is 1 m/N
  std::vector<double> phase_deg;     ///< -180 to 0
};

/// Percentiles of the sampled arms at every frequency.
struct BodeBand {
  std::vector<double> p05, p50, p95;
};

struct ArmBode {
  std::vector<double> frequency_Hz;  ///< 0.1 to 100 Hz; the arms were identified from 0.6 to 30 Hz
  std::vector<BodeCurve> published;  ///< Table I by grip force, then Table II
  std::vector<BodeCurve> literature;
  std::vector<BodeCurve> samples;
  BodeBand magnitude_dB, phase_deg;  ///< empty without samples
};

/// Throws InputError for an unknown name of Table V.
ArmBode arm_bode(const models::ArmPopulation& population, const BodeRequest& request);

/// Magnitude and phase as plots: the sampled arms as a fan with their 5 to 95 % band, those of Tables I and
/// II before it.
std::vector<io::Plot> bode_plots(const ArmBode& bode);

/// Writes report.html, magnitude.svg, phase.svg and bode.csv (`arm,frequency_Hz,magnitude_dB,phase_deg`: every
/// published and sampled arm) into the directory. Throws InputError where it cannot be written.
void write_arm_bode(const ArmBode& bode, const models::ArmPopulation& population,
                    const std::filesystem::path& directory);

}  // namespace handloop::studies
