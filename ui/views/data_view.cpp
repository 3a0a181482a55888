#include "ui/views/data_view.h"

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

std::string unit_of(const ExplainedRecording& found) {
  const auto& recording = found.study.recording;
  return found.study.options.driven_by == identify::DrivenBy::force ? recording.position_unit : recording.force_unit;
}

/// In mm where the unit is m; otherwise as it is.
std::pair<double, std::string> drawn_unit(const std::string& unit) {
  return unit == "m" ? std::pair{1e3, std::string("mm")} : std::pair{1.0, unit};
}

std::string names_of(const identify::Explanation& e) {
  std::string names;
  for (const auto& effect : e.effects)
    names += (names.empty() ? "" : " and ") + std::string(models::find_effect_type(effect.name).info.title);
  return names;
}

}  // namespace

void DataView::open(const Bench& bench, const std::filesystem::path& recording) {
  path_ = recording.string();
  request_.recording = recording;
  request_.options.axis = bench.editor.axis();
  margins_before_.reset();
  applied_.clear();
  job_.start(request_);
}

void DataView::request(Bench& bench) {
  if (push_button("open_recording", "Open a recording ...", false))
    dialog_.ask("Open a recording", FileDialog::Purpose::open, {".csv", ".mat"}, path_.empty() ? "." : path_);
  ImGui::SameLine(0, px(5));
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - px(330), px(120)));
  const bool entered = text_field("##recording", path_);
  mark("control.recording");
  ImGui::SameLine(0, px(5));
  bool arm = request_.options.base == models::BaseModel::arm5;
  if (push_button("base", arm ? "arm" : "mass-spring"))
    request_.options.base = arm ? models::BaseModel::msd : models::BaseModel::arm5;
  hint("The base model: the five-parameter arm, or mass, spring and damper");
  ImGui::SameLine(0, px(3));
  bool force = request_.options.driven_by == identify::DrivenBy::force;
  if (push_button("driven_by", force ? "force in" : "position in"))
    request_.options.driven_by = force ? identify::DrivenBy::position : identify::DrivenBy::force;
  hint("What is given and what is predicted");
  ImGui::SameLine(0, px(5));
  ImGui::BeginDisabled(path_.empty());
  if (push_button("explain", "Explain", true) || (entered && !path_.empty())) open(bench, path_);
  ImGui::EndDisabled();
  if (const auto chosen = dialog_.show()) open(bench, *chosen);
}

void DataView::waiting() {
  if (!job_.busy()) return;
  ImGui::ProgressBar(static_cast<float>(job_.share()), {ImGui::GetContentRegionAvail().x - px(90), 0},
                     job_.note().c_str());
  mark("explain_progress");
  ImGui::SameLine();
  if (push_button("cancel_explain", "Cancel", false, px(80))) job_.cancel();
}

void DataView::verdict(const ExplainedRecording& found) {
  const auto& e = found.outcome.explanation;
  const auto& p = palette();
  std::string word, sentence;
  Colour colour = p.stable;
  if (e.verdict == identify::Verdict::no_effect) {
    word = "NOTHING MISSING";
    sentence = "the base model explains the recording as far as its noise allows";
  } else {
    const double before = e.base.errors.rmse_validation, after = e.after.errors.rmse_validation;
    word = e.verdict == identify::Verdict::effect_added ? "FOUND" : "UNEXPLAINED";
    colour = e.verdict == identify::Verdict::effect_added ? p.stable : p.doubtful;
    sentence = (e.effects.empty() ? std::string("no catalogued effect explains it") : names_of(e)) +
               fmt::format(": error on held-out data {:.0f} % smaller", 100 * (1 - after / before));
    if (e.verdict == identify::Verdict::unexplained_residual) sentence += "; structure is left";
  }
  {
    const TextStyle style(look().title, colour);
    ImGui::TextUnformatted(word.c_str());
  }
  mark("found", word + ": " + sentence);
  ImGui::SameLine(0, px(12));
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + px(8));
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(sentence.c_str());
  ImGui::PopTextWrapPos();
}

void DataView::before_after(const ExplainedRecording& found, float width) {
  const auto& e = found.outcome.explanation;
  const auto [scale, unit] = drawn_unit(unit_of(found));
  if (!ImGui::BeginTable("before_after", 3, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp,
                         {width, 0}))
    return;
  ImGui::TableSetupColumn("");
  ImGui::TableSetupColumn("before");
  ImGui::TableSetupColumn("after");
  ImGui::TableHeadersRow();
  const auto row = [](const char* name, const std::string& before, const std::string& after) {
    ImGui::TableNextRow();
    for (const auto& text : {std::string(name), before, after}) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(text.c_str());
    }
  };
  const auto number = [&](double value) { return fmt::format("{:.3g} {}", scale * value, unit); };
  row("held-out error", number(e.base.errors.rmse_validation), number(e.after.errors.rmse_validation));
  row("of the signal", fmt::format("{:.1f} %", 100 * e.base.errors.nrmse_validation),
      fmt::format("{:.1f} %", 100 * e.after.errors.nrmse_validation));
  row("noise floor", number(e.floor.rmse), "");
  const auto& m = found.outcome.margins;
  if (m.before && m.after) {
    const auto disk = [](const control::Margins& margins) {
      return margins.stable ? fmt::format("{:.3f}", margins.disk_alpha) : std::string("UNSTABLE");
    };
    row("disk margin*", disk(*m.before), disk(*m.after));
    row("stiffest wall*", fmt::format("{:.0f} N/m", m.critical_stiffness_before),
        fmt::format("{:.0f} N/m", m.critical_stiffness_after));
  }
  ImGui::EndTable();
  for (const auto& effect : e.effects) {
    for (std::size_t i = 0; i < effect.keys.size(); ++i) {
      if (effect.half_width95[i] > 0)
        note(fmt::format("{} {} = {:.4g} \u00b1 {:.2g}", effect.name, effect.keys[i], effect.values[i],
                         effect.half_width95[i]));
    }
  }
  note("* at the default wall, 400 N/m and 1 N s/m, with a tip of 75 g");
}

void DataView::apply(Bench& bench, const ExplainedRecording& found) {
  const auto& model = found.outcome.explanation.after.model;
  const bool usable = !model.rotary;
  const auto applying = [&](const std::string& what, auto&& change) {
    margins_before_ = bench.tuning.nominal() ? std::optional(bench.tuning.nominal()->margins) : std::nullopt;
    change();
    applied_ = what;
    bench.say(what + " is in the simulation and the margins now (Ctrl+Z takes it out)");
  };
  ImGui::BeginDisabled(!usable || model.effects.empty());
  if (push_button("apply_effect", "Apply the found effect", true, px(200)))
    applying("the found effect", [&] { bench.editor.apply_effects(model.effects); });
  ImGui::EndDisabled();
  hint("Adds it to the arm on the wall's axis: the running simulation feels it and the margins move");
  ImGui::SameLine(0, px(5));
  ImGui::BeginDisabled(!usable);
  if (push_button("apply_model", "Apply arm and effect", false, px(170)))
    applying("the found model", [&] { bench.editor.apply_model(model); });
  ImGui::EndDisabled();
  hint("The whole fitted model takes the place of the arm on the wall's axis");
  if (!usable) note("A rotary plant cannot hold the stylus.");
  if (applied_.empty() || !bench.tuning.nominal()) return;
  const auto& now = bench.tuning.nominal()->margins;
  const auto words = [](const control::Margins& m) {
    return m.stable ? fmt::format("STABLE, disk margin {:.3f}, {:.3g} x the gain", m.disk_alpha, m.gain_up)
                    : std::string("UNSTABLE");
  };
  ImGui::PushTextWrapPos(0.0f);
  const std::string text =
      fmt::format("This bench: {} before, {} now", margins_before_ ? words(*margins_before_) : "?", words(now));
  const TextStyle style(look().bold, now.stable ? palette().stable : palette().unstable);
  ImGui::TextUnformatted(text.c_str());
  mark("applied", text);
  ImGui::PopTextWrapPos();
}

void DataView::signals(const ExplainedRecording& found, float width, float height) {
  const auto& recording = found.study.recording;
  const auto& p = palette();
  const double end = static_cast<double>(recording.size()) * recording.sample_time_s;
  const auto range = [](const MinMaxRing& ring, double scale) {
    const auto all = ring.extremes(0, ring.count());
    return range_of(std::array{scale * static_cast<double>(all.low), scale * static_cast<double>(all.high)}, 1e-6);
  };
  const auto [position_scale, position_unit] = drawn_unit(recording.position_unit);
  {
    Plot plot({.id = "recording_force",
               .title = "Recorded force",
               .x_label = "",
               .y_label = recording.force_unit,
               .x = {0, end},
               .y = range(found.force, 1),
               .size = {width, 0.3f * height}});
    draw_signal(plot, found.force, recording.sample_time_s, 1, p.series[1]);
  }
  {
    Plot plot({.id = "recording_position",
               .title = "Recorded position",
               .x_label = "",
               .y_label = position_unit,
               .x = {0, end},
               .y = range(found.position, position_scale),
               .size = {width, 0.3f * height}});
    draw_signal(plot, found.position, recording.sample_time_s, position_scale, p.series[0]);
  }
  const auto [scale, unit] = drawn_unit(unit_of(found));
  Plot plot({.id = "residual",
             .title = "Residual",
             .x_label = "s",
             .y_label = unit,
             .x = {0, end},
             .y = range(found.residual_before, scale),
             .size = {width, 0.4f * height}});
  draw_signal(plot, found.residual_before, recording.sample_time_s, scale, p.series[1].faded(0.8f));
  draw_signal(plot, found.residual_after, recording.sample_time_s, scale, p.series[0]);
  plot.legend({{"before", p.series[1]}, {"after", p.series[0]}});
}

void DataView::fingerprints(const ExplainedRecording& found, float width, float height) {
  const auto& p = palette();
  auto prints = found.outcome.explanation.fingerprints;
  std::ranges::sort(prints, [](const auto& a, const auto& b) { return a.share > b.share; });
  ImGui::BeginChild("fingerprints", {width, height}, false);
  heading("Fingerprints: what of the residual each effect would explain");
  for (const auto& print : prints) {
    const auto& title = models::find_effect_type(print.name).info.title;
    const TextStyle style(look().small, print.significant ? p.text : p.muted);
    ImGui::TextUnformatted(std::string(title).c_str());
    hint((print.meaning + fmt::format("; {:.1f} standard deviations, p = {:.2g}", print.statistic, print.p_value))
             .c_str());
    ImGui::SameLine(px(168));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float full = std::max(width - px(250), px(40)),
                bar = full * static_cast<float>(std::clamp(print.share, 0.0, 1.0));
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + px(2)},
                                              {at.x + std::max(bar, 1.0f), at.y + look().small->FontSize},
                                              packed(print.significant ? p.series[0] : p.muted.faded(0.5f)));
    ImGui::SetCursorScreenPos({at.x + full + px(8), at.y});
    ImGui::Text("%.0f %%%s", 100 * print.share, print.significant ? " *" : "");
  }
  note("* significant, all that was tried taken into account");
  rivals(found);
  ImGui::EndChild();
}

void DataView::rivals(const ExplainedRecording& found) {
  const auto& e = found.outcome.explanation;
  const bool any = std::ranges::any_of(e.rivals, [](const auto& r) { return r.indistinguishable; });
  if (any) heading("This recording cannot tell it from");
  for (const auto& rival : e.rivals) {
    if (rival.indistinguishable) note(fmt::format("{}: {} would", rival.name, rival.separate_by));
  }
  if (e.rest) {
    heading("Unexplained");
    note(e.rest->description);
  }
}

void DataView::show(Bench& bench) {
  job_.follow();
  ImGui::BeginChild("data", {0, 0}, true);
  request(bench);
  waiting();
  if (!job_.problem().empty()) {
    const TextStyle style(look().body, palette().unstable);
    ImGui::TextWrapped("%s", job_.problem().c_str());
    mark("explain_problem", job_.problem());
  }
  const auto& found = job_.result();
  if (!found) {
    if (!job_.busy() && job_.problem().empty())
      note(
          "Open a recording of force and position (docs/file-formats.md). The base model is fitted, the noise floor "
          "measured, every effect of the catalogue tried, and judged on data held out.");
    ImGui::EndChild();
    return;
  }
  verdict(*found);
  apply(bench, *found);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float half = 0.5f * (room.x - px(10)), height = std::max(room.y - px(4), px(430));
  const ImVec2 corner = ImGui::GetCursorPos();
  signals(*found, half, height - px(10));
  ImGui::SetCursorPos({corner.x + half + px(10), corner.y});
  ImGui::BeginGroup();
  before_after(*found, half);
  fingerprints(*found, half, std::max(height - (ImGui::GetCursorPosY() - corner.y), px(160)));
  ImGui::EndGroup();
  ImGui::EndChild();
}

}  // namespace handloop::ui
