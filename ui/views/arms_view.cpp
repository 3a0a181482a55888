#include "ui/views/arms_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/margins.h"
#include "studies/scenario_loop.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"
#include "ui/widgets/plot.h"

namespace handloop::ui {
namespace {

constexpr std::array<const char*, 5> kShort{"M", "k1", "k2", "b1", "b2"};
constexpr std::array<const char*, 5> kWords{"mass of the arm", "grasp stiffness", "arm stiffness", "grasp damping",
                                            "arm damping"};
constexpr std::array<const char*, 5> kUnits{"kg", "N/m", "N/m", "N s/m", "N s/m"};
constexpr std::size_t kArms = 2000;
constexpr int kBins = 36;

/// Magnitude of x/F in dB over the frequencies.
std::vector<double> magnitude(const models::ArmParameters& arm, const std::vector<double>& frequency_Hz) {
  std::vector<double> result;
  for (const double f : frequency_Hz)
    result.push_back(20 * std::log10(std::abs(models::compliance(arm, {0, 2 * std::numbers::pi * f}))));
  return result;
}

}  // namespace

void ArmsView::follow(const Bench& bench) {
  const auto axis = bench.editor.axis();
  if (!population_ || population_->axis() != axis) {
    population_.emplace(axis);
    survey_.reset();
    revision_ = 0;
  }
  if (auto answer = job_.take()) survey_ = std::move(*answer);
  if (revision_ == bench.editor.revision() && asked_seed_ == seed_) return;
  revision_ = bench.editor.revision();
  asked_seed_ = seed_;
  job_.request(
      [scenario = bench.editor.scenario(), seed = seed_](JobContext& context) {
        return studies::survey_arms(scenario, kArms, seed, context.stop_token(),
                                    [&](std::size_t done, std::size_t total) {
                                      context.progress(static_cast<double>(done) / static_cast<double>(total));
                                    });
      },
      false);
}

void ArmsView::chooser(Bench& bench) {
  auto& editor = bench.editor;
  ImGui::BeginChild("chooser", {0, 2 * ImGui::GetFrameHeight() + px(26)}, true, ImGuiWindowFlags_NoScrollbar);
  {
    const TextStyle style(look().bold, palette().text);
    ImGui::AlignTextToFramePadding();
    ImGui::Text("Axis %s: %s", std::string(models::axis_name(editor.axis())).c_str(), editor.arm_source().c_str());
    mark("arm", editor.arm_source());
  }
  if (const auto& nominal = bench.tuning.nominal()) {
    ImGui::SameLine(0, px(18));
    const auto& m = nominal->margins;
    const TextStyle style(look().body, m.stable ? palette().stable : palette().unstable);
    ImGui::Text("%s",
                m.stable ? fmt::format("STABLE, disk margin {:.3f}", m.disk_alpha).c_str() : "UNSTABLE with this arm");
  }
  if (push_button("draw", "Draw a subject", true)) editor.draw_subject(seed_, subject_++);
  hint("The next arm of the population");
  ImGui::SameLine(0, px(4));
  if (push_button("new_population", "Other people")) ++seed_, subject_ = 0;
  hint("Another seed: 2000 other arms");
  ImGui::SameLine(0, px(4));
  if (push_button("nominal_arm", "Nominal")) editor.set_arm(models::nominal_arm(editor.axis()), "Table II, nominal");
  ImGui::SameLine(0, px(14));
  ImGui::SetNextItemWidth(px(230));
  if (ImGui::BeginCombo("##literature", compared_.empty() ? "Compare with Table V ..." : compared_.c_str(),
                        ImGuiComboFlags_HeightLarge)) {
    if (ImGui::Selectable("none")) compared_.clear();
    for (const auto& arm : models::literature_arms()) {
      if (ImGui::Selectable(fmt::format("{} ({}, {})", arm.name, arm.source, arm.grasp).c_str())) compared_ = arm.name;
    }
    ImGui::EndCombo();
  }
  mark("control.literature");
  if (!compared_.empty()) {
    const auto& arm = models::find_literature_arm(compared_);
    ImGui::SameLine(0, px(4));
    ImGui::BeginDisabled(arm.rigid_grasp);
    if (push_button("use_literature", "Use it")) editor.set_arm(arm.arm, "Table V, " + compared_);
    ImGui::EndDisabled();
    if (arm.rigid_grasp) hint("Its hand is one with the stylus: no five-parameter arm");
  }
  ImGui::EndChild();
}

void ArmsView::histogram(Bench& bench, std::size_t i, float height) {
  const auto& p = palette();
  const auto& distribution = population_->parameter(i);
  const auto& table = distribution.statistics();
  std::array<double, kBins> share{};
  const double width = (table.maximum - table.minimum) / kBins;
  if (survey_) {
    for (const auto& entry : survey_->arms) {
      const double value = models::to_array(entry.arm)[i];
      const auto bin = std::clamp(static_cast<int>((value - table.minimum) / width), 0, kBins - 1);
      share[static_cast<std::size_t>(bin)] += 1.0 / static_cast<double>(survey_->arms.size());
    }
  }
  const double most = std::max(*std::ranges::max_element(share), 0.02);
  Plot plot({.id = fmt::format("histogram_{}", kShort[i]),
             .title = "",
             .x_label = "",
             .y_label = "",
             .x = {table.minimum - width, table.maximum + width},
             .y = {0, 1.12 * most},
             .size = {ImGui::GetContentRegionAvail().x, height}});
  for (int bin = 0; bin < kBins; ++bin) {
    const double from = table.minimum + bin * width;
    plot.bar(from, from + width, 0, share[static_cast<std::size_t>(bin)], p.series[3].faded(0.75f));
  }
  std::vector<double> x, y;
  for (int k = 0; k <= 160; ++k) {
    x.push_back(table.minimum + (table.maximum - table.minimum) * k / 160.0);
    y.push_back(distribution.density(x.back()) * width);
  }
  plot.line(x, y, p.series[1], 1.4f);
  for (const double end : {table.ci95_minimum, table.ci95_maximum}) plot.vertical(end, p.muted.faded(0.6f));
  for (const double end : {table.ci67_minimum, table.ci67_maximum}) plot.vertical(end, p.muted);
  plot.vertical(table.mean, p.text);
  const double value = models::to_array(bench.editor.arm())[i];
  plot.mark(value, 0.06 * most, p.accent, Plot::Mark::diamond, 6);
  plot.vertical(value, p.accent, 1.6f);
  if (plot.hovered())
    plot.read_out(fmt::format("{:.4g} {}: {:.0f} % lie below", plot.mouse_x(), kUnits[i],
                              100 * distribution.cdf(plot.mouse_x())));
}

void ArmsView::parameters(Bench& bench) {
  auto& editor = bench.editor;
  const float left = ImGui::GetContentRegionAvail().y - 5 * (ImGui::GetFrameHeight() + look().small->FontSize + px(20));
  const float height = std::max(left / 5, px(64));
  const auto percentiles = population_->percentiles(editor.arm());
  for (std::size_t i = 0; i < 5; ++i) {
    auto values = models::to_array(editor.arm());
    const auto& table = population_->parameter(i).statistics();
    double value = values[i];
    {
      const TextStyle style(look().bold, palette().text);
      ImGui::Text("%s", kShort[i]);
    }
    ImGui::SameLine(0, px(6));
    note(fmt::format("{}, {}", kWords[i], kUnits[i]));
    ImGui::SameLine(ImGui::GetContentRegionMax().x - px(104));
    {
      const TextStyle style(look().small, palette().text);
      ImGui::Text("percentile %.0f", 100 * percentiles[i]);
      mark(std::string("percentile.") + kShort[i], fmt::format("{:.0f}", 100 * percentiles[i]));
    }
    ImGui::SetNextItemWidth(-1);
    const std::string name = fmt::format("arm_{}", kShort[i]);
    const bool changed = ImGui::SliderScalar(("##" + name).c_str(), ImGuiDataType_Double, &value, &table.minimum,
                                             &table.maximum, "%.4g", ImGuiSliderFlags_AlwaysClamp);
    mark("control." + name);
    if (changed) {
      values[i] = value;
      editor.edit(name, [&](models::Scenario& s) {
        s.arm.attached = true;
        s.arm.axes[static_cast<std::size_t>(s.wall.axis)] = models::arm_from_array(values);
      });
    }
    if (ImGui::IsItemDeactivatedAfterEdit()) editor.seal();
    histogram(bench, i, height);
  }
}

void ArmsView::bode(const Bench& bench, float width, float height) {
  const auto& p = palette();
  Plot plot({.id = "arm_bode",
             .title = "Compliance x/F of the arms",
             .x_label = "Hz",
             .y_label = "dB re 1 m/N",
             .x = {0.1, 100, true},
             .y = {-75, -25},
             .size = {width, height}});
  if (!survey_) return;
  const auto& b = survey_->bode;
  plot.area(b.frequency_Hz, b.magnitude_dB.p05, b.magnitude_dB.p95, p.series[3].faded(0.25f));
  for (std::size_t i = 0; i < std::min<std::size_t>(b.samples.size(), 24); ++i)
    plot.line(b.frequency_Hz, b.samples[i].magnitude_dB, p.series[3].faded(0.4f), 0.8f);
  for (const auto& curve : b.literature) {
    if (curve.name == compared_) plot.line(b.frequency_Hz, curve.magnitude_dB, p.series[1], 2.0f);
  }
  plot.line(b.frequency_Hz, magnitude(models::nominal_arm(survey_->axis), b.frequency_Hz), p.text.faded(0.8f), 1.4f);
  plot.line(b.frequency_Hz, magnitude(bench.editor.arm(), b.frequency_Hz), p.accent, 2.4f);
  plot.vertical(0.6, p.line);
  plot.vertical(30, p.line);
  if (compared_.empty()) {
    plot.legend({{"this arm", p.accent}, {"nominal", p.text}, {"5 to 95 % of arms", p.series[3]}}, true);
  } else {
    plot.legend({{"this arm", p.accent},
                 {"nominal", p.text},
                 {"5 to 95 % of arms", p.series[3]},
                 {compared_.c_str(), p.series[1]}},
                true);
  }
}

void ArmsView::envelopes(float width, float height) {
  const auto& p = palette();
  Plot plot({.id = "envelopes",
             .title = "|W_u|: how far arms stray",
             .x_label = "Hz",
             .y_label = "dB",
             .x = {0.6, 30, true},
             .y = {-30, 10},
             .size = {width, height}});
  plot.horizontal(0, p.muted);
  if (!survey_) return;
  plot.line(survey_->envelope_Hz, survey_->maximum_dB, p.series[1], 2.0f);
  plot.line(survey_->envelope_Hz, survey_->percentile67_dB, p.series[0], 2.0f);
  plot.legend({{"all arms", p.series[1]}, {"67 %", p.series[0]}}, true);
}

void ArmsView::margins(Bench& bench, float width, float height) {
  const auto& p = palette();
  // given first, so that they and not the plot below them get the mouse
  const ImVec2 corner = ImGui::GetCursorPos();
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2{px(5), 0});
  ImGui::SetCursorPos({corner.x + px(290), corner.y});
  for (std::size_t i = 0; i < 5; ++i) {
    if (push_button(fmt::format("against_{}", kShort[i]), kShort[i], against_ == i)) against_ = i;
    ImGui::SameLine(0, px(3));
  }
  ImGui::PopStyleVar();
  ImGui::SetCursorPos(corner);
  const auto& table = population_->parameter(against_).statistics();
  double most = 0.1;
  if (survey_) {
    for (const auto& entry : survey_->arms) most = std::max(most, entry.disk_alpha);
  }
  Plot plot({.id = "arm_margins",
             .title = "Each arm's disk margin against",
             .x_label = fmt::format("{}, {}", kWords[against_], kUnits[against_]),
             .y_label = "",
             .x = {table.minimum, table.maximum},
             .y = {-0.03 * most, 1.05 * most},
             .size = {width, height}});
  if (!survey_) return;
  const studies::SurveyedArm* nearest = nullptr;
  float distance = px(14);
  for (const auto& entry : survey_->arms) {
    const double value = models::to_array(entry.arm)[against_];
    if (entry.stable) {
      plot.mark(value, entry.disk_alpha, p.series[0].faded(0.5f), Plot::Mark::dot, 1.3f);
    } else {
      plot.mark(value, 0, p.unstable, Plot::Mark::cross, 3);
    }
    const ImVec2 at = plot.at(value, entry.disk_alpha), mouse = plot.mouse();
    const float here = std::hypot(at.x - mouse.x, at.y - mouse.y);
    if (here < distance) distance = here, nearest = &entry;
  }
  if (const auto& nominal = bench.tuning.nominal()) {
    const double value = models::to_array(bench.editor.arm())[against_];
    plot.mark(value, nominal->margins.stable ? nominal->margins.disk_alpha : 0, p.accent, Plot::Mark::diamond, 6);
    plot.mark(value, nominal->margins.stable ? nominal->margins.disk_alpha : 0, p.text, Plot::Mark::ring, 7);
  }
  if (!plot.hovered() || nearest == nullptr) return;
  plot.mark(models::to_array(nearest->arm)[against_], nearest->disk_alpha, p.text, Plot::Mark::ring, 5);
  const auto number = static_cast<std::uint64_t>(nearest - survey_->arms.data());
  plot.read_out(fmt::format("arm {}: {}, stiffest wall {:.0f} N/m; click to hold with it", number,
                            nearest->stable ? fmt::format("disk margin {:.3f}", nearest->disk_alpha) : "UNSTABLE",
                            nearest->critical_stiffness_N_per_m));
  if (plot.clicked()) bench.editor.draw_subject(survey_->seed, number);
}

void ArmsView::show(Bench& bench) {
  follow(bench);
  chooser(bench);
  ImGui::BeginChild("arms", {0, 0}, true);
  if (job_.busy() && !survey_) ImGui::ProgressBar(static_cast<float>(job_.share()), {-1, px(6)}, "");
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float column = std::max(0.40f * room.x, px(230)), height = std::max(room.y, px(560));
  ImGui::BeginChild("parameters", {column, height}, false);
  parameters(bench);
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginGroup();
  const float right = std::max(ImGui::GetContentRegionAvail().x, px(300));
  bode(bench, right, 0.38f * height);
  envelopes(right, 0.25f * height);
  margins(bench, right, 0.37f * height - px(16));
  ImGui::EndGroup();
  ImGui::EndChild();
}

}  // namespace handloop::ui
