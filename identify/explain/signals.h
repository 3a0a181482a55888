#pragma once

#include <span>
#include <vector>

namespace handloop::identify {

/// The signal `delay_s` ago, by cubic interpolation between samples; before its start it had its first value. A
/// negative delay looks ahead.
std::vector<double> delayed(std::span<const double> signal, double delay_s, double sample_time_s);

/// Through a first-order lag, exactly for a signal that is linear between samples; starts settled.
std::vector<double> lagged(std::span<const double> signal, double time_constant_s, double sample_time_s);

/// Second-order Butterworth high-pass, forward only, from rest at the first value.
std::vector<double> high_passed(std::span<const double> signal, double cutoff_Hz, double sample_time_s);

/// Means of `factor` samples each; a rest shorter than that is dropped.
std::vector<double> decimated(std::span<const double> signal, std::size_t factor);

/// Zero-phase low-pass: fourth-order Butterworth forward and backward, ends mirrored about their values.
std::vector<double> smoothed(std::span<const double> signal, double cutoff_Hz, double sample_time_s);

/// First derivative by fourth-order central differences, one-sided at the ends.
std::vector<double> derivative(std::span<const double> signal, double sample_time_s);

double rms(std::span<const double> signal);
double mean(std::span<const double> signal);
double standard_deviation(std::span<const double> signal);
/// Coefficient of correlation of two signals of one length, -1 to 1; 0 where one of them is constant.
double correlation(std::span<const double> a, std::span<const double> b);

}  // namespace handloop::identify
