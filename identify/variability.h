#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "identify/arm_fit.h"
#include "models/arm.h"
#include "models/arm_population.h"
#include "models/arm_tables.h"

/// How much the arms of a set differ: sections II-E to II-G of the arm paper.
namespace handloop::identify {

/// Value that the share p of the values does not exceed: the inverse of the empirical distribution (MATLAB's ecdf), the
/// smallest value whose cumulated share reaches p. Throws std::invalid_argument for no values.
double empirical_quantile(std::span<const double> values, double p);

/// The eight statistics of Table III; the "CI" ends at the probabilities of the reading.
models::ParameterStatistics describe(std::span<const double> values,
                                     models::PercentileReading reading = models::PercentileReading::ecdf);

/// Mean of several responses at each frequency, and of their coherences (Set 1). All must share their frequencies.
FrequencyResponse mean_response(std::span<const FrequencyResponse> responses);

/// Centre of the minimum bounding circle of several responses at each frequency (Set 2), coherence 1.
FrequencyResponse central_response(std::span<const FrequencyResponse> responses);

/// |W_u| of eq. (4): |H/H_nominal - 1| over a set at each frequency, in dB.
struct UnstructuredVariability {
  std::vector<double> frequency_Hz;
  std::vector<double> maximum_dB, percentile95_dB, percentile67_dB;
};
UnstructuredVariability unstructured_variability(std::span<const FrequencyResponse> responses,
                                                 const models::ArmParameters& nominal);

}  // namespace handloop::identify
