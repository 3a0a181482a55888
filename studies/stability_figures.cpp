#include "studies/stability_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/stability_boundary.h"
#include "io/output.h"
#include "models/errors.h"
#include "studies/scenario_boundaries.h"
#include "studies/scenario_margins.h"
#include "studies/stability_plots.h"

namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

std::vector<double> frequencies(double low_Hz, double high_Hz, int count) {
  std::vector<double> f;
  for (int i = 0; i <= count; ++i) f.push_back(low_Hz * std::pow(high_Hz / low_Hz, static_cast<double>(i) / count));
  return f;
}

/// Closed-loop poles as the gains grow along their ray to twice the limit.
io::Plot poles_figure(const ScenarioMargins& r) {
  io::Plot plot{.title = "Closed-loop poles",
                .x_label = "Re z",
                .y_label = "Im z",
                .equal_axes = true,
                .width_px = 560,
                .height_px = 480};
  const auto plant = control::sample_plant(r.loop.plant, r.loop.timing.sample_time_s);
  io::Series circle{.label = "unit circle", .colour = io::Colour::grey, .width = 1.2};
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.6 * kPi * (i / 100.0 - 1);
    circle.x.push_back(std::cos(t)), circle.y.push_back(std::sin(t));
  }
  io::Series path{.label = "as the gains grow", .style = io::Series::Style::points, .colour = io::Colour::sky};
  io::Series here{.label = "gains set", .style = io::Series::Style::points, .colour = io::Colour::blue};
  io::Series edge{.label = fmt::format("gains x {:.3g}: the limit", r.nominal.gain_up),
                  .style = io::Series::Style::points,
                  .colour = io::Colour::orange};
  const auto add = [&](io::Series& s, double k) {
    const auto poles = control::closed_loop_poles(
        plant, r.loop.timing, {k * r.loop.gains.stiffness_N_per_m, k * r.loop.gains.damping_Ns_per_m});
    for (int i = 0; i < poles.count; ++i) {
      const auto z = poles.z[static_cast<std::size_t>(i)];
      if (z.real() > 0.45) s.x.push_back(z.real()), s.y.push_back(z.imag());
    }
  };
  for (int i = 0; i <= 60; ++i) add(path, 1.4 * r.nominal.gain_up * i / 60.0);
  add(here, 1);
  add(edge, r.nominal.gain_up);
  plot.series = {circle, path, here, edge};
  plot.x_range = {{0.5, 1.1}};
  plot.y_range = {{-0.4, 0.4}};
  return plot;
}

/// Phase with the delay margin added.
io::Plot delay_figure(const LoopCurve& curve, const control::Margins& m) {
  auto plot = bode_plots(curve, m)[1];
  plot.title = "Delay margin";
  plot.vertical.clear();
  auto late = plot.series[0];
  plot.series[0].label = "phase of L";
  late.label = fmt::format("with {:.3g} ms more", 1e3 * m.delay_s);
  late.dashed = true;
  for (std::size_t i = 0; i < late.x.size(); ++i) late.y[i] -= 360 * late.x[i] * m.delay_s;
  plot.series.push_back(late);
  plot.vertical.push_back({m.delay_at_rad_per_s / (2 * kPi), "|L| = 1", io::Colour::orange});
  plot.x_range = {{1, 100}};
  plot.y_range = {{-360, 0}};
  return plot;
}

/// What gains and phases the disk margin tolerates together.
io::Plot disk_figure(const control::Margins& m) {
  io::Plot plot{.title = "What a disk margin tolerates at once",
                .x_label = "gain factor",
                .y_label = "phase / deg",
                .log_x = true};
  io::Series s{.label = fmt::format("alpha = {:.3g}", m.disk_alpha)};
  const auto disk = control::disk_guarantee(m.disk_alpha);
  const double centre = 0.5 * (disk.gain_low + disk.gain_high), radius = 0.5 * (disk.gain_high - disk.gain_low);
  for (int i = 0; i <= 200; ++i) {
    const Complex f = centre + std::polar(radius, 2 * kPi * i / 200);
    s.x.push_back(std::abs(f)), s.y.push_back(std::arg(f) * 180 / kPi);
  }
  plot.series = {
      s, {.label = "as built", .x = {1}, .y = {0}, .style = io::Series::Style::points, .colour = io::Colour::ink}};
  if (std::isfinite(m.gain_up)) plot.vertical.push_back({m.gain_up, "gain margin alone", io::Colour::green});
  plot.horizontal.push_back({m.phase_deg, "phase margin alone", io::Colour::orange});
  plot.y_range = {{-60, 60}};
  plot.x_range = {{0.3, std::max(4.0, 1.3 * (std::isfinite(m.gain_up) ? m.gain_up : 3.0))}};
  return plot;
}

io::Plot unstructured_figure(const ScenarioMargins& r) {
  io::Plot plot{.title = "Unstructured uncertainty",
                .x_label = "frequency / Hz",
                .y_label = "|W_u T|",
                .log_x = true,
                .log_y = true};
  for (const auto set : {models::UncertaintySet::percentile67, models::UncertaintySet::maximum}) {
    io::Series s{.label = set == models::UncertaintySet::maximum ? "maximum envelope" : "67 % envelope",
                 .x = frequencies(0.1, 200, 500)};
    for (const double f : s.x) {
      const Complex jw(0, 2 * kPi * f),
          HD = models::compliance(*r.loop.plant.arm, jw) *
               control::faced_stiffness(r.loop.plant, r.loop.timing, r.loop.gains, 2 * kPi * f);
      s.y.push_back(std::abs(models::uncertainty(r.axis, set)(jw) * HD / (1.0 + HD)));
    }
    plot.series.push_back(s);
  }
  plot.horizontal.push_back({1, "robust below"});
  plot.vertical = {{0.6, ""}, {30, "as identified: 0.6 to 30 Hz"}};
  return plot;
}

/// The set that c would have to lie in for a pole on the axis, and the rectangle where it is, at one frequency.
io::Plot value_set_figure(const ScenarioMargins& r) {
  const auto box = control::published_box(r.axis, control::BoxSet::percent67);
  // where the corner of the box that is lost first rings
  double w = r.nominal.disk_at_rad_per_s, limit = std::numeric_limits<double>::infinity();
  for (unsigned v = 0; v < 32; ++v) {
    auto plant = r.loop.plant;
    plant.arm = box.vertex(v);
    const auto stable = control::stable_stiffness(control::sample_plant(plant, r.loop.timing.sample_time_s),
                                                  r.loop.timing, r.loop.gains.damping_Ns_per_m);
    if (stable.count > 0 && stable.intervals[0].high < limit) {
      limit = stable.intervals[0].high, w = stable.intervals[0].high_at_rad_per_s;
    }
  }
  io::Plot plot{.title = fmt::format("Value sets at {:.3g} Hz", w / (2 * kPi)),
                .x_label = "Re c / (N/m)",
                .y_label = "Im c / (N/m)"};
  const auto rectangle = [](double left, double right, double low, double high, auto&& map) {
    std::vector<Complex> edge;
    constexpr int n = 60;
    for (int i = 0; i < n; ++i) edge.push_back(map(Complex(left + (right - left) * i / n, low)));
    for (int i = 0; i < n; ++i) edge.push_back(map(Complex(right, low + (high - low) * i / n)));
    for (int i = 0; i < n; ++i) edge.push_back(map(Complex(right - (right - left) * i / n, high)));
    for (int i = 0; i <= n; ++i) edge.push_back(map(Complex(left, high - (high - low) * i / n)));
    return edge;
  };
  const auto add = [&](std::string label, const std::vector<Complex>& points, bool dashed) {
    io::Series s{.label = std::move(label), .dashed = dashed};
    for (const auto& p : points) s.x.push_back(p.real()), s.y.push_back(p.imag());
    plot.series.push_back(std::move(s));
  };
  const auto same = [](Complex c) { return c; };
  add("c of every arm of the 67 % box",
      rectangle(box.low[2] - w * w * box.high[0], box.high[2] - w * w * box.low[0], w * box.low[4], w * box.high[4],
                same),
      false);
  for (const double K : {r.loop.gains.stiffness_N_per_m, std::round(0.9 * limit), std::round(limit)}) {
    control::WallGains gains{K, r.loop.gains.damping_Ns_per_m};
    const Complex D = control::faced_stiffness(r.loop.plant, r.loop.timing, gains, w);
    add(fmt::format("-aD/(a + D), K = {:g} N/m", gains.stiffness_N_per_m),
        rectangle(box.low[1], box.high[1], w * box.low[3], w * box.high[3],
                  [&](Complex a) { return -a * D / (a + D); }),
        K != r.loop.gains.stiffness_N_per_m);
  }
  // what lies about the rectangle; the last set may reach far
  double left = 0, right = 0, low = 0, high = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& series = plot.series[i];
    left = std::min(left, *std::min_element(series.x.begin(), series.x.end()));
    right = std::max(right, *std::max_element(series.x.begin(), series.x.end()));
    low = std::min(low, *std::min_element(series.y.begin(), series.y.end()));
    high = std::max(high, *std::max_element(series.y.begin(), series.y.end()));
  }
  plot.x_range = {{1.15 * left, right + 0.05 * (right - left)}};
  plot.y_range = {{1.15 * low, 1.4 * high}};
  return plot;
}

io::Plot passivity_figure(const ScenarioMargins& r) {
  io::Plot plot{.title = "Damping that passivity asks for", .x_label = "stiffness K / (N/m)", .y_label = "b / (N s/m)"};
  for (const int delay : {0, 1, 2}) {
    io::Series s{.label = fmt::format("{} samples of delay", delay)};
    auto timing = r.loop.timing;
    timing.delay_samples = delay;
    for (int i = 0; i <= 60; ++i) {
      const double K = 2.0 * r.loop.gains.stiffness_N_per_m * i / 60;
      s.x.push_back(K);
      s.y.push_back(control::colgate_required_damping(timing, {K, r.loop.gains.damping_Ns_per_m}));
    }
    plot.series.push_back(s);
  }
  plot.horizontal.push_back({r.device_damping_Ns_per_m, "the device has"});
  plot.y_range = {{0, 1.02 * plot.series.back().y.back()}};
  plot.vertical.push_back({r.loop.gains.stiffness_N_per_m, "K set", io::Colour::ink});
  return plot;
}

io::Plot llewellyn_figure(const ScenarioMargins& r) {
  io::Plot plot{.title = "Where a free device keeps its wall passive",
                .x_label = "device damping b / (N s/m)",
                .y_label = "stiffness K / (N/m)"};
  io::Series colgate{.label = "Colgate and Schenkel: any hand"},
      llewellyn{.label = "Llewellyn: any hand, any world", .dashed = true};
  const double B = r.loop.gains.damping_Ns_per_m;
  for (int i = 0; i <= 40; ++i) {
    const double b = 3.0 * i / 40;
    const double K = control::colgate_permitted_stiffness(r.loop.timing, B, b);
    colgate.x.push_back(b), colgate.y.push_back(std::isnan(K) ? 0 : K);
    llewellyn.x.push_back(b), llewellyn.y.push_back(control::llewellyn_permitted_stiffness(r.loop.timing, B, b));
  }
  plot.series = {colgate, llewellyn};
  plot.vertical.push_back({r.device_damping_Ns_per_m, "this device"});
  return plot;
}

io::Plot side_by_side_figure(const ScenarioMargins& r) {
  io::Plot plot{.title = "Stiffness that each test permits",
                .x_label = "K / (N/m) with the B that is set",
                .reverse_y = true,
                .height_px = 560};
  io::Series bars{.style = io::Series::Style::horizontal_bars};
  for (const auto& row : r.permitted) {
    plot.y_categories.push_back(row.test);
    bars.x.push_back(std::isfinite(row.stiffness_N_per_m) ? row.stiffness_N_per_m : 0);
    bars.y.push_back(static_cast<double>(plot.y_categories.size()));
  }
  plot.series = {bars};
  plot.vertical.push_back({r.loop.gains.stiffness_N_per_m, "K set", io::Colour::ink});
  return plot;
}

/// Multi-loop disk margin as the arm of the device turns away from home.
io::Plot axes_figure(const models::Scenario& scenario) {
  io::Plot plot{.title = "One wall on three axes", .x_label = "forearm angle q3 / deg", .y_label = "disk margin alpha"};
  io::Series all{.label = "all loops at once, by mu"};
  std::array<io::Series, 3> alone{io::Series{.label = "x alone", .dashed = true},
                                  io::Series{.label = "y alone", .dashed = true},
                                  io::Series{.label = "z alone", .dashed = true}};
  for (double q3 = 0; q3 <= 60; q3 += 7.5) {
    auto turned = scenario;
    turned.device.pose_rad = {0, 0.35, q3 * kPi / 180};
    const auto m = multi_axis_margins(turned);
    all.x.push_back(q3), all.y.push_back(m.stable ? m.disk_alpha : 0);
    for (std::size_t i = 0; i < 3; ++i)
      alone[i].x.push_back(q3), alone[i].y.push_back(m.stable ? m.one_at_a_time[i] : 0);
  }
  plot.series = {all, alone[0], alone[1], alone[2]};
  plot.y_range = {{0, std::max(1.0, 1.1 * *std::max_element(alone[0].y.begin(), alone[0].y.end()))}};
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, io::Plot>> stability_figures(const models::Scenario& scenario) {
  ScenarioMarginsRequest request;
  request.arms = 1000;
  const auto r = scenario_margins(scenario, request);
  if (!r.loop.plant.arm || !r.nominal.stable) {
    throw InputError("scenario '" + scenario.name + "': the pictures need a stable loop held by a five-parameter arm");
  }
  const models::ArmPopulation population(r.axis);
  const auto curve = loop_curve(r.loop);
  const auto bode = bode_plots(curve, r.nominal);
  control::GainWindow window = natural_window(r.loop);
  const auto whole = boundary_families(r.loop, population, window);
  const auto find = [&](const char* quantity) {
    return *std::find_if(whole.begin(), whole.end(), [&](const auto& f) { return f.quantity == quantity; });
  };
  std::vector<std::pair<std::string, io::Plot>> figures;
  figures.emplace_back("loop", bode[0]);
  figures.emplace_back("poles", poles_figure(r));
  figures.emplace_back("nyquist", nyquist_plot(curve, r.nominal));
  figures.emplace_back("delay_margin", delay_figure(curve, r.nominal));
  figures.emplace_back("sensitivity", sensitivity_plot(curve, r.nominal));
  figures.emplace_back("disk_margin", disk_figure(r.nominal));
  figures.emplace_back("three_axes", axes_figure(scenario));
  figures.emplace_back("map", map_plot(find("nominal"), window, r.loop.gains));
  figures.emplace_back("map_delay", map_plot(find("delay_samples"), window, r.loop.gains));
  figures.emplace_back("map_b1", map_plot(find("b1_Ns_per_m"), window, r.loop.gains));
  figures.emplace_back("unstructured", unstructured_figure(r));
  figures.emplace_back("value_set", value_set_figure(r));
  figures.emplace_back("passivity", passivity_figure(r));
  figures.emplace_back("llewellyn", llewellyn_figure(r));
  figures.emplace_back("population", population_plot(*r.population, r.nominal.disk_alpha));
  figures.emplace_back("share", share_plot(population, r.loop, request.arms, request.seed));
  figures.emplace_back("side_by_side", side_by_side_figure(r));
  return figures;
}

void write_stability_figures(const models::Scenario& scenario, const std::string& directory) {
  io::OutputDirectory out(directory);
  const auto figures = stability_figures(scenario);
  std::vector<io::Plot> plots;
  for (const auto& [name, plot] : figures) plots.push_back(plot);
  const auto svgs = io::draw_svg(plots);
  for (std::size_t i = 0; i < svgs.size(); ++i) io::write_file_atomically(out / (figures[i].first + ".svg"), svgs[i]);
  out.commit();
}

}  // namespace handloop::studies
