#include "ui/views/traces_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"
#include "ui/widgets/plot.h"
#include "ui/widgets/signal.h"

namespace handloop::ui {
namespace {

AxisRange shown_range(const TraceStore& store, const std::vector<Channel>& channels, const TraceWindow& window,
                      bool log) {
  MinMax all;
  double scale = 1;
  for (const auto channel : channels) {
    scale = channel_info(channel).scale;
    const auto sample = [&](double t) { return static_cast<std::uint64_t>(std::max(t, 0.0) / store.sample_time_s()); };
    all.add(store[channel].extremes(sample(window.low_s()), sample(window.high_s()) + 1));
  }
  if (all.empty()) return log ? AxisRange{kSmallestOnLog, 1, true} : AxisRange{-1, 1};
  const double low = static_cast<double>(all.low) * scale, high = static_cast<double>(all.high) * scale;
  if (log) return {kSmallestOnLog, std::max({2 * std::abs(low), 2 * std::abs(high), 10 * kSmallestOnLog}), true};
  return range_of(std::array{low, high}, 0.02);
}

}  // namespace

std::vector<TracesView::Group> TracesView::default_groups() {
  return {{"Position", {Channel::position_x, Channel::position_y, Channel::position_z}, true},
          {"Force on the hand", {Channel::force_x, Channel::force_y, Channel::force_z}, true},
          {"Joint torque", {Channel::torque_1, Channel::torque_2, Channel::torque_3}, true},
          {"Encoders", {Channel::counts_1, Channel::counts_2, Channel::counts_3}, false},
          {"Wall force", {Channel::wall_force}, false},
          {"Grip force", {Channel::grip_force}, false},
          {"Energy given", {Channel::energy}, false},
          {"Time of a pass", {Channel::compute}, false}};
}

void TracesView::export_csv(Bench& bench) {
  std::vector<Channel> channels;
  for (const auto& group : groups_) {
    if (group.shown) channels.insert(channels.end(), group.channels.begin(), group.channels.end());
  }
  const auto& store = bench.session.traces();
  const auto sample = [&](double t) { return static_cast<std::uint64_t>(std::max(t, 0.0) / store.sample_time_s()); };
  store.write_csv(csv_, channels, sample(window_.low_s()), sample(window_.high_s()) + 1);
  bench.say("what is shown is in " + csv_);
}

void TracesView::bar(Bench& bench) {
  if (push_button("traces_pause", window_.following() ? "Hold" : "Follow", !window_.following(), px(64))) {
    if (window_.following()) {
      window_.pause();
    } else {
      window_.resume();
    }
  }
  hint("Hold the picture still; the loop goes on");
  ImGui::SameLine(0, px(4));
  const double middle = 0.5 * (window_.low_s() + window_.high_s());
  if (push_button("zoom_in", "+")) window_.zoom(0.5, middle);
  hint("Half as long (or the wheel in a picture)");
  ImGui::SameLine(0, px(4));
  if (push_button("zoom_out", "-")) window_.zoom(2.0, middle);
  ImGui::SameLine(0, px(4));
  if (push_button("log", "log", log_)) log_ = !log_;
  hint("Sizes on a logarithmic axis");
  ImGui::SameLine(0, px(4));
  if (push_button("no_cursors", "Clear cursors")) cursor_a_s_.reset(), cursor_b_s_.reset();
  hint("A click in a picture sets cursor A, with Shift cursor B");
  ImGui::SameLine(0, px(10));
  ImGui::SetNextItemWidth(px(110));
  text_field("##csv", csv_);
  mark("control.csv_file");
  ImGui::SameLine(0, px(3));
  if (push_button("export_csv", "CSV")) export_csv(bench);
  hint("What is shown, every sample, as CSV");
  ImGui::SameLine(0, px(10));
  ImGui::SetNextItemWidth(px(110));
  text_field("##png", png_);
  mark("control.png_file");
  ImGui::SameLine(0, px(3));
  if (push_button("export_png", "PNG")) {
    const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    picture_ = PictureRequest{png_, low.x, low.y, low.x + size.x, low.y + size.y};
    bench.say("the picture is in " + png_);
  }
  hint("The view as it stands");
  for (auto& group : groups_) {
    if (push_button(std::string("show_") + group.name, group.name, group.shown)) group.shown = !group.shown;
    ImGui::SameLine(0, px(3));
  }
  if (push_button("show_deadlines", "Deadlines", deadlines_)) deadlines_ = !deadlines_;
}

void TracesView::mouse(const Plot& plot) {
  if (!plot.hovered()) return;
  const auto& io = ImGui::GetIO();
  if (io.MouseWheel != 0.0f) window_.zoom(io.MouseWheel > 0 ? 0.8 : 1.25, plot.mouse_x());
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 4.0f)) {
    window_.move(static_cast<double>(io.MouseDelta.x / (plot.right() - plot.left())) * window_.length_s());
  } else if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && io.MouseDragMaxDistanceSqr[0] < 16.0f) {
    (io.KeyShift ? cursor_b_s_ : cursor_a_s_) = plot.mouse_x();
    window_.pause();
  }
}

void TracesView::group(Bench& bench, const Group& group, float height, bool last) {
  const auto& store = bench.session.traces();
  const auto& p = palette();
  const auto& unit = channel_info(group.channels.front()).unit;
  Plot plot({.id = std::string("trace_") + group.name,
             .title = group.name,
             .x_label = last ? "s" : "",
             .y_label = std::string(unit),
             .x = {window_.low_s(), window_.high_s()},
             .y = shown_range(store, group.channels, window_, log_),
             .size = {ImGui::GetContentRegionAvail().x, height}});
  if (!log_) plot.horizontal(0, p.line);
  for (std::size_t i = 0; i < group.channels.size(); ++i)
    draw_signal(plot, store[group.channels[i]], store.sample_time_s(), channel_info(group.channels[i]).scale,
                p.series[i]);
  const auto value = [&](Channel channel, double t) {
    const auto sample = static_cast<std::uint64_t>(std::lround(std::max(t, 0.0) / store.sample_time_s()));
    if (sample >= store.count() || sample < store.first()) return NAN;
    return static_cast<float>(static_cast<double>(store[channel][sample]) * channel_info(channel).scale);
  };
  for (std::size_t i = 0; i < group.channels.size(); ++i) {
    const auto channel = group.channels[i];
    std::string text(channel_info(channel).name);
    if (cursor_a_s_) text += fmt::format("  A {:.4g}", value(channel, *cursor_a_s_));
    if (cursor_b_s_) text += fmt::format("  B {:.4g}", value(channel, *cursor_b_s_));
    if (cursor_a_s_ && cursor_b_s_)
      text += fmt::format("  B-A {:.4g}", value(channel, *cursor_b_s_) - value(channel, *cursor_a_s_));
    plot.text(plot.x().low, plot.y().high, text, p.series[i], {8, 4 + 15 * static_cast<float>(i)});
  }
  if (cursor_a_s_) plot.vertical(*cursor_a_s_, p.text), plot.text(*cursor_a_s_, plot.y().low, "A", p.text, {3, -16});
  if (cursor_b_s_) plot.vertical(*cursor_b_s_, p.text), plot.text(*cursor_b_s_, plot.y().low, "B", p.text, {3, -16});
  if (plot.hovered()) plot.read_out(fmt::format("{:.3f} s", plot.mouse_x()));
  mouse(plot);
}

void TracesView::deadlines(const Bench& bench, float height) {
  const auto& p = palette();
  const auto& session = bench.session;
  const auto& times = session.traces().compute_times();
  double most = 10;
  for (const auto count : times.counts()) most = std::max(most, 3.0 * static_cast<double>(count));
  Plot plot({.id = "deadlines",
             .title = fmt::format("Deadlines: {} missed", session.status().missed_deadlines),
             .x_label = "one pass of the loop, us",
             .y_label = "passes",
             .x = {0.1, 1e5, true},
             .y = {0.5, most, true},
             .size = {ImGui::GetContentRegionAvail().x, height}});
  for (int i = 0; i < LogHistogram::kClasses; ++i) {
    const auto count = static_cast<double>(times.counts()[static_cast<std::size_t>(i)]);
    if (count == 0) continue;
    const double from = 1e6 * LogHistogram::kLowest * std::pow(10.0, static_cast<double>(i) / LogHistogram::kPerDecade);
    plot.bar(from, from * std::pow(10.0, 1.0 / LogHistogram::kPerDecade), 0.5, count, p.series[0]);
  }
  const double deadline = 1e6 * session.traces().sample_time_s();
  plot.vertical(deadline, p.unstable, 2);
  plot.text(deadline, most, "deadline", p.unstable, {5, 4});
  if (plot.hovered())
    plot.read_out(fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.0f} us", session.status().p50_us,
                              session.status().p99_us, session.status().p99_9_us, session.status().max_us));
}

void TracesView::show(Bench& bench) {
  ImGui::BeginChild("traces", {0, 0}, true);
  const auto& store = bench.session.traces();
  window_.follow(static_cast<double>(store.count()) * store.sample_time_s());
  bar(bench);
  const auto shown = std::ranges::count_if(groups_, [](const Group& g) { return g.shown; }) + (deadlines_ ? 1 : 0);
  const float room = ImGui::GetContentRegionAvail().y - px(4);
  const float height = std::max(room / static_cast<float>(std::max<std::ptrdiff_t>(shown, 1)) - px(5), px(110));
  std::ptrdiff_t left = shown - (deadlines_ ? 1 : 0);
  for (const auto& g : groups_) {
    if (g.shown) group(bench, g, height, --left == 0);
  }
  if (deadlines_) deadlines(bench, height);
  ImGui::EndChild();
}

}  // namespace handloop::ui
