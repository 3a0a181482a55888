#include "ui/views/tune_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "ui/state/gain_map.h"
#include "ui/views/verdict_card.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/look.h"
#include "ui/widgets/plot.h"

namespace handloop::ui {
namespace {

constexpr double kPi = std::numbers::pi;

double decibels(double x) {
  return 20 * std::log10(std::max(x, 1e-12));
}

/// L near the critical point, the disk that the disk margin keeps it out of, and the crossings.
void nyquist(const studies::NominalTuning& t, ImVec2 size) {
  Plot plot({.id = "nyquist",
             .title = "Nyquist",
             .x_label = "Re L",
             .y_label = "Im L",
             .x = {-2.6, 1.4},
             .y = {-1.5, 1.1},
             .size = size,
             .round = true});
  const auto& p = palette();
  plot.horizontal(0, p.line);
  plot.vertical(0, p.line);
  plot.circle(0, 0, 1, p.line, false, 1.0f);
  const auto& m = t.margins;
  if (m.stable && m.disk_alpha > 0 && m.disk_alpha < 2) {
    // Seiler, Packard and Gahinet (2020), skew 0: L stays outside the disk on -(2 + a)/(2 - a) and its inverse
    const double far = -(2 + m.disk_alpha) / (2 - m.disk_alpha), near = 1 / far;
    plot.circle(0.5 * (far + near), 0, 0.5 * (near - far), p.doubtful.faded(0.18f), true);
    plot.circle(0.5 * (far + near), 0, 0.5 * (near - far), p.doubtful, false);
  }
  std::vector<double> re, im, conjugate;
  for (const auto& L : t.curve.loop) {
    re.push_back(L.real()), im.push_back(L.imag()), conjugate.push_back(-L.imag());
  }
  plot.dashed(re, conjugate, p.series[0].faded(0.45f), 1.0f);
  plot.line(re, im, p.series[0], 2.0f);
  if (m.stable && std::isfinite(m.gain_up)) plot.mark(-1 / m.gain_up, 0, p.series[1], Plot::Mark::diamond);
  if (m.stable && std::isfinite(m.phase_deg)) {
    const double lag = m.phase_deg * kPi / 180;
    plot.mark(-std::cos(lag), -std::sin(lag), p.series[2], Plot::Mark::diamond);
  }
  plot.mark(-1, 0, p.unstable, Plot::Mark::cross, 5);
  plot.text(-1, 0, "-1", p.unstable, {-18, -16});
  if (plot.hovered()) {
    const double x = plot.mouse_x(), y = plot.mouse_y();
    std::size_t nearest = 0;
    double best = 1e9;
    for (std::size_t i = 0; i < re.size(); ++i) {
      const double d = std::hypot(re[i] - x, im[i] - y);
      if (d < best) best = d, nearest = i;
    }
    if (best < 0.25) {
      plot.mark(re[nearest], im[nearest], p.text, Plot::Mark::ring, 4);
      plot.read_out(fmt::format("{:.3g} Hz: |L| {:.3g}, {:.0f}\u00b0", t.curve.frequency_Hz[nearest],
                                std::abs(t.curve.loop[nearest]), std::arg(t.curve.loop[nearest]) * 180 / kPi));
    }
  }
}

struct Bode {
  std::vector<double> magnitude_dB, phase_deg;
};

Bode bode_of(const studies::LoopCurve& curve) {
  Bode bode;
  double last = curve.loop.empty() ? 0 : std::arg(curve.loop.front());
  for (const auto& L : curve.loop) {
    bode.magnitude_dB.push_back(decibels(std::abs(L)));
    double phase = std::arg(L);
    while (phase - last > kPi) phase -= 2 * kPi;
    while (phase - last < -kPi) phase += 2 * kPi;
    bode.phase_deg.push_back(phase * 180 / kPi);
    last = phase;
  }
  return bode;
}

/// Value of a curve at a frequency, between its points.
double at_frequency(const std::vector<double>& x, const std::vector<double>& y, double frequency) {
  const auto after = std::ranges::lower_bound(x, frequency);
  if (after == x.begin() || after == x.end()) return NAN;
  const auto i = static_cast<std::size_t>(after - x.begin());
  const double t = std::log(frequency / x[i - 1]) / std::log(x[i] / x[i - 1]);
  return y[i - 1] + t * (y[i] - y[i - 1]);
}

void bode(const studies::NominalTuning& t, ImVec2 size) {
  const auto& f = t.curve.frequency_Hz;
  const auto& m = t.margins;
  const auto& p = palette();
  const auto curves = bode_of(t.curve);
  const AxisRange frequency{std::max(f.front(), 0.2), f.back(), true};
  const double gain_at = m.gain_up_at_rad_per_s / (2 * kPi), phase_at = m.phase_at_rad_per_s / (2 * kPi);
  const ImVec2 corner = ImGui::GetCursorPos();
  {
    Plot plot(
        {.id = "bode_magnitude",
         .title = "Bode: magnitude of L",
         .x_label = "",
         .y_label = "dB",
         .x = frequency,
         .y = {-60, std::clamp(10 * std::ceil((*std::ranges::max_element(curves.magnitude_dB) + 5) / 10), 20.0, 60.0)},
         .size = {size.x, 0.52f * size.y}});
    plot.horizontal(0, p.muted);
    plot.line(f, curves.magnitude_dB, p.series[0], 2.0f);
    if (m.stable && std::isfinite(m.gain_up)) {
      plot.vertical(gain_at, p.series[1].faded(0.6f));
      plot.mark(gain_at, -decibels(m.gain_up), p.series[1], Plot::Mark::diamond);
      plot.text(gain_at, -decibels(m.gain_up), fmt::format("{:.1f} dB to go", decibels(m.gain_up)), p.series[1],
                {7, -7});
    }
    if (m.stable && std::isfinite(m.phase_deg)) plot.mark(phase_at, 0, p.series[2], Plot::Mark::diamond);
    if (plot.hovered()) {
      plot.vertical(plot.mouse_x(), p.muted);
      plot.read_out(
          fmt::format("{:.3g} Hz: {:.1f} dB", plot.mouse_x(), at_frequency(f, curves.magnitude_dB, plot.mouse_x())));
    }
  }
  ImGui::SetCursorPos({corner.x, corner.y + 0.52f * size.y + px(2)});
  Plot plot({.id = "bode_phase",
             .title = "Bode: phase of L",
             .x_label = "Hz",
             .y_label = "degrees",
             .x = frequency,
             .y = {-270, 90},
             .size = {size.x, 0.48f * size.y - px(2)}});
  plot.horizontal(-180, p.muted);
  plot.line(f, curves.phase_deg, p.series[0], 2.0f);
  if (m.stable && std::isfinite(m.gain_up)) plot.mark(gain_at, -180, p.series[1], Plot::Mark::diamond);
  if (m.stable && std::isfinite(m.phase_deg)) {
    const double phase = at_frequency(f, curves.phase_deg, phase_at);
    plot.vertical(phase_at, p.series[2].faded(0.6f));
    plot.mark(phase_at, phase, p.series[2], Plot::Mark::diamond);
    plot.text(phase_at, phase, fmt::format("{:.0f}\u00b0 to go", std::abs(m.phase_deg)), p.series[2], {7, -16});
  }
  if (plot.hovered()) {
    plot.vertical(plot.mouse_x(), p.muted);
    plot.read_out(
        fmt::format("{:.3g} Hz: {:.0f}\u00b0", plot.mouse_x(), at_frequency(f, curves.phase_deg, plot.mouse_x())));
  }
}

/// The plane of the gains: where this arm's stability ends, where those of the sampled arms end, and where we are. A
/// click, or a drag, sets the gains.
void gain_map(Bench& bench, ImVec2 size) {
  const auto& robust = bench.tuning.robust();
  if (!robust) {
    ImGui::Dummy(size);
    return;
  }
  const auto& window = robust->window;
  const auto& loop = bench.editor.scenario().loop;
  const auto& p = palette();
  // given first, so that it and not the plot below it gets the mouse
  const ImVec2 corner = ImGui::GetCursorPos();
  ImGui::SetCursorPos({corner.x + px(178), corner.y});
  const bool whole = bench.tuning.whole_map();
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2{px(6), 0});
  const bool other = push_button("whole_map", whole ? "Near" : "Whole");
  ImGui::PopStyleVar();
  if (other) return bench.tuning.show_whole_map(!whole);
  hint(whole ? "What is about the gains" : "The whole region of stability");
  ImGui::SetCursorPos(corner);
  Plot plot({.id = "gain_map",
             .title = "Gains: click to set",
             .x_label = "stiffness K, N/m",
             .y_label = "damping B, N s/m",
             .x = {window.stiffness_low, window.stiffness_high},
             .y = {window.damping_low, window.damping_high},
             .size = size});
  if (const auto& limits = bench.tuning.limits()) {
    for (const auto& point : limits->cloud)
      plot.mark(point.stiffness_N_per_m, point.damping_Ns_per_m, p.series[3].faded(0.55f), Plot::Mark::dot, 1.2f);
    std::vector<double> K, B;
    for (const auto& point : limits->line95) K.push_back(point.stiffness_N_per_m), B.push_back(point.damping_Ns_per_m);
    plot.dashed(K, B, p.series[2], 2.0f);
  }
  for (const auto& piece : robust->boundary) {
    std::vector<double> K, B;
    for (const auto& point : piece.points) K.push_back(point.stiffness_N_per_m), B.push_back(point.damping_Ns_per_m);
    plot.line(K, B, p.series[0], 2.4f);
  }
  plot.legend({{"this arm's limit", p.series[0]},
               {"95 % of arms below", p.series[2]},
               {"limits of sampled arms", p.series[3]}});
  const double K = loop.stiffness_N_per_m, B = loop.damping_Ns_per_m;
  const bool stable = bench.tuning.nominal() && bench.tuning.nominal()->margins.stable;
  plot.vertical(K, p.text.faded(0.25f));
  plot.horizontal(B, p.text.faded(0.25f));
  plot.mark(K, B, stable ? p.stable : p.unstable, stable ? Plot::Mark::dot : Plot::Mark::cross, 6);
  plot.mark(K, B, p.text, Plot::Mark::ring, 8);
  if (plot.hovered() || plot.dragged()) {
    const auto gains = gains_at(window, {plot.x().place_of(plot.mouse_x()), plot.y().place_of(plot.mouse_y())});
    plot.read_out(fmt::format("K {:.0f} N/m, B {:.3g} N s/m", gains.stiffness_N_per_m, gains.damping_Ns_per_m));
    if (plot.dragged() && (gains.stiffness_N_per_m != K || gains.damping_Ns_per_m != B))
      bench.editor.set_gains(gains.stiffness_N_per_m, gains.damping_Ns_per_m);
  }
  if (ImGui::IsItemDeactivated()) bench.editor.seal();
}

}  // namespace

void tune_view(Bench& bench) {
  verdict_card(bench);
  if (!bench.tuning.nominal()) return;
  ImGui::BeginChild("pictures", {0, 0}, true);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const auto& nominal = *bench.tuning.nominal();
  if (room.x < px(520)) {  // one below the other
    const float height = px(260);
    gain_map(bench, {room.x, height});
    nyquist(nominal, {room.x, height});
    bode(nominal, {room.x, 1.6f * height});
    ImGui::EndChild();
    return;
  }
  const float half = 0.5f * (room.x - px(8)), height = std::max(room.y, px(400));
  const ImVec2 corner = ImGui::GetCursorPos();
  nyquist(nominal, {half, 0.5f * (height - px(6))});
  ImGui::SetCursorPos({corner.x, corner.y + 0.5f * (height + px(6))});
  gain_map(bench, {half, 0.5f * (height - px(6))});
  ImGui::SetCursorPos({corner.x + half + px(8), corner.y});
  ImGui::BeginGroup();
  bode(nominal, {half, height});
  ImGui::EndGroup();
  ImGui::EndChild();
}

}  // namespace handloop::ui
