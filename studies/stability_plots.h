#pragma once

#include <vector>

#include "control/linear_plant.h"
#include "control/margins.h"
#include "control/population_margins.h"
#include "io/plot.h"
#include "studies/scenario_boundaries.h"

/// Pictures of a loop's stability, shared by reports and docs/stability.md.
namespace handloop::studies {

/// L over frequency, from a thousandth of the Nyquist frequency to it.
struct LoopCurve {
  std::vector<double> frequency_Hz;
  std::vector<std::complex<double>> loop;
};
LoopCurve loop_curve(const control::Loop& loop);
/// The same of a plant sampled before, with or without effects.
LoopCurve loop_curve(const control::SampledPlant& plant, const control::LoopTiming& timing,
                     const control::WallGains& gains);
LoopCurve loop_curve(const control::SampledLinearPlant& plant, const control::LoopTiming& timing,
                     const control::WallGains& gains);

/// Magnitude in dB and phase in degrees of L, with the crossings that give the margins.
std::vector<io::Plot> bode_plots(const LoopCurve& curve, const control::Margins& margins);
/// L in the plane near -1, with the unit circle, the circle of the modulus margin and the disk of the disk margin.
io::Plot nyquist_plot(const LoopCurve& curve, const control::Margins& margins);
/// |S|, |T| and |S - T|.
io::Plot sensitivity_plot(const LoopCurve& curve, const control::Margins& margins);
/// Boundaries in the plane of K and B; the point is the loop's own gains.
io::Plot map_plot(const BoundaryFamily& family, const control::GainWindow& window, const control::WallGains& gains);
/// Histogram of the arms' disk margins.
io::Plot population_plot(const control::PopulationMargins& population, double nominal_alpha);
/// Share of the arms that stay stable as K grows.
io::Plot share_plot(const models::ArmPopulation& population, const control::Loop& loop, std::size_t count,
                    std::uint64_t seed);

}  // namespace handloop::studies
