#include "studies/stability_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/stability_boundary.h"

namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

double decibels(double x) {
  return 20 * std::log10(x);
}

/// A circle in the plane.
io::Series circle(double centre, double radius, std::string label, io::Colour colour, bool dashed) {
  io::Series s{.label = std::move(label), .colour = colour, .width = 1.4, .dashed = dashed};
  for (int i = 0; i <= 180; ++i) {
    s.x.push_back(centre + radius * std::cos(2 * kPi * i / 180));
    s.y.push_back(radius * std::sin(2 * kPi * i / 180));
  }
  return s;
}

template <typename Plant>
LoopCurve curve_of(const Plant& plant, const control::LoopTiming& timing, const control::WallGains& gains, int points) {
  LoopCurve curve;
  const double nyquist = 0.998 * kPi / timing.sample_time_s;  // short of the point where L turns real
  for (int i = 0; i <= points; ++i) {
    const double w = nyquist * std::pow(10.0, -3.5 * (1 - static_cast<double>(i) / points));
    curve.frequency_Hz.push_back(w / (2 * kPi));
    curve.loop.push_back(control::loop_response(plant, timing, gains, w).loop);
  }
  return curve;
}

}  // namespace

LoopCurve loop_curve(const control::Loop& loop) {
  return loop_curve(control::sample_plant(loop.plant, loop.timing.sample_time_s), loop.timing, loop.gains);
}

LoopCurve loop_curve(const control::SampledPlant& plant, const control::LoopTiming& timing,
                     const control::WallGains& gains) {
  return curve_of(plant, timing, gains, 1200);
}

LoopCurve loop_curve(const control::SampledLinearPlant& plant, const control::LoopTiming& timing,
                     const control::WallGains& gains) {
  return curve_of(plant, timing, gains, 600);
}

std::vector<io::Plot> bode_plots(const LoopCurve& curve, const control::Margins& margins) {
  std::vector<double> magnitude, phase;
  double last = std::arg(curve.loop.front());
  for (const Complex L : curve.loop) {
    magnitude.push_back(decibels(std::abs(L)));
    double here = std::arg(L);
    while (here - last > kPi) here -= 2 * kPi;
    while (here - last < -kPi) here += 2 * kPi;
    phase.push_back(here * 180 / kPi);
    last = here;
  }
  io::Plot top{.title = "Loop transfer L", .x_label = "frequency / Hz", .y_label = "|L| / dB", .log_x = true};
  top.series.push_back({.x = curve.frequency_Hz, .y = magnitude});
  top.horizontal.push_back({0, ""});
  io::Plot bottom{.title = "Phase of L", .x_label = "frequency / Hz", .y_label = "phase / deg", .log_x = true};
  bottom.series.push_back({.x = curve.frequency_Hz, .y = phase});
  bottom.horizontal.push_back({-180, "-180"});
  const double lowest = std::max(-720.0, *std::min_element(phase.begin(), phase.end()));
  bottom.y_range = {{lowest - 20, *std::max_element(phase.begin(), phase.end()) + 20}};
  if (margins.stable) {
    const auto mark = [&](double w, const std::string& label, io::Colour colour) {
      if (!std::isfinite(w) || w <= 0) return;
      top.vertical.push_back({w / (2 * kPi), label, colour});
      bottom.vertical.push_back({w / (2 * kPi), "", colour});
    };
    mark(margins.phase_at_rad_per_s, fmt::format("phase {:.3g} deg", margins.phase_deg), io::Colour::orange);
    mark(margins.gain_up_at_rad_per_s, fmt::format("gain x {:.3g}", margins.gain_up), io::Colour::green);
  }
  return {top, bottom};
}

io::Plot nyquist_plot(const LoopCurve& curve, const control::Margins& margins) {
  io::Plot plot{
      .title = "Nyquist", .x_label = "Re L", .y_label = "Im L", .equal_axes = true, .width_px = 560, .height_px = 480};
  io::Series L{.label = "L", .colour = io::Colour::blue, .width = 2.2},
      mirror{.label = "", .colour = io::Colour::sky, .width = 1.0};
  for (const Complex z : curve.loop) {
    L.x.push_back(z.real()), L.y.push_back(z.imag());
    mirror.x.push_back(z.real()), mirror.y.push_back(-z.imag());
  }
  plot.series = {L, mirror, circle(0, 1, "|L| = 1", io::Colour::grey, true)};
  if (margins.stable) {
    plot.series.push_back(
        circle(-1, margins.modulus, fmt::format("modulus margin {:.3g}", margins.modulus), io::Colour::orange, false));
    const auto disk = control::disk_guarantee(margins.disk_alpha);
    if (disk.gain_low > 0 && std::isfinite(disk.gain_high)) {
      const double near = -1 / disk.gain_high, far = -1 / disk.gain_low;
      plot.series.push_back(circle(0.5 * (near + far), 0.5 * (near - far),
                                   fmt::format("disk margin {:.3g}", margins.disk_alpha), io::Colour::green, false));
    }
  }
  plot.series.push_back(
      {.label = "-1", .x = {-1}, .y = {0}, .style = io::Series::Style::points, .colour = io::Colour::ink});
  plot.x_range = {{-2.4, 1.6}};
  plot.y_range = {{-1.8, 1.8}};
  return plot;
}

io::Plot sensitivity_plot(const LoopCurve& curve, const control::Margins& margins) {
  io::Plot plot{.title = "Sensitivities", .x_label = "frequency / Hz", .y_label = "dB", .log_x = true};
  io::Series S{.label = "|S| = 1/|1 + L|", .x = curve.frequency_Hz},
      T{.label = "|T| = |L|/|1 + L|", .x = curve.frequency_Hz},
      D{.label = "|S - T|", .x = curve.frequency_Hz, .dashed = true};
  for (const Complex L : curve.loop) {
    S.y.push_back(decibels(1 / std::abs(1.0 + L)));
    T.y.push_back(decibels(std::abs(L / (1.0 + L))));
    D.y.push_back(decibels(std::abs((1.0 - L) / (1.0 + L))));
  }
  plot.series = {S, T, D};
  plot.horizontal.push_back({0, ""});
  if (margins.stable && std::isfinite(margins.modulus_at_rad_per_s) && margins.modulus_at_rad_per_s > 0) {
    plot.vertical.push_back({margins.modulus_at_rad_per_s / (2 * kPi),
                             fmt::format("peak |S| = 1/{:.3g}", margins.modulus), io::Colour::orange});
  }
  return plot;
}

io::Plot map_plot(const BoundaryFamily& family, const control::GainWindow& window, const control::WallGains& gains) {
  io::Plot plot{.title = family.title, .x_label = "damping B / (N s/m)", .y_label = "stiffness K / (N/m)"};
  plot.x_range = {{window.damping_low, window.damping_high}};
  plot.y_range = {{window.stiffness_low, window.stiffness_high}};
  for (const auto& member : family.members) {
    io::Series s{.label = member.label};
    for (const auto& piece : member.pieces) {
      // no more points than the eye sees
      const double width = window.damping_high - window.damping_low,
                   height = window.stiffness_high - window.stiffness_low;
      double last_x = 0, last_y = 0;
      for (const auto& p : piece.points) {
        const double step = std::hypot((p.damping_Ns_per_m - last_x) / width, (p.stiffness_N_per_m - last_y) / height);
        if (step < 0.006 && &p != &piece.points.front() && &p != &piece.points.back()) continue;
        s.x.push_back(last_x = p.damping_Ns_per_m), s.y.push_back(last_y = p.stiffness_N_per_m);
      }
      s.x.push_back(std::nan("")), s.y.push_back(std::nan(""));
    }
    if (!s.x.empty()) plot.series.push_back(std::move(s));
  }
  plot.series.push_back({.label = "gains set",
                         .x = {gains.damping_Ns_per_m},
                         .y = {gains.stiffness_N_per_m},
                         .style = io::Series::Style::points,
                         .colour = io::Colour::ink});
  return plot;
}

io::Plot population_plot(const control::PopulationMargins& population, double nominal_alpha) {
  io::Plot plot{
      .title = "Disk margins of the sampled arms", .x_label = "disk margin alpha (0: unstable)", .y_label = "arms"};
  plot.series.push_back(io::histogram(population.disk_alpha, 40, ""));
  plot.vertical.push_back({population.p05.disk_alpha, "5 %", io::Colour::orange});
  if (std::isfinite(nominal_alpha)) plot.vertical.push_back({nominal_alpha, "nominal", io::Colour::green});
  return plot;
}

io::Plot share_plot(const models::ArmPopulation& population, const control::Loop& loop, std::size_t count,
                    std::uint64_t seed) {
  io::Plot plot{.title = "Share of the arms that are stable", .x_label = "stiffness K / (N/m)", .y_label = "share / %"};
  io::Series share{.label = "at the B that is set"};
  for (int i = 0; i <= 100; ++i) {
    const double p = 0.01 * i;
    share.x.push_back(control::population_permitted_stiffness(population, loop, count, seed, p));
    share.y.push_back(100 * p);
  }
  std::reverse(share.x.begin(), share.x.end());
  std::reverse(share.y.begin(), share.y.end());
  const double end = share.x.back();
  plot.series.push_back(std::move(share));
  plot.vertical.push_back({loop.gains.stiffness_N_per_m, "K set", io::Colour::ink});
  plot.y_range = {{0, 102}};
  plot.x_range = {{0, end}};
  return plot;
}

}  // namespace handloop::studies
