#include "ui/views/effects_controls.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "models/errors.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

/// Ends of a slider: the admissible range, cut to what is usual where that is endless.
std::pair<double, double> slider_range(const models::EffectParameter& p) {
  const double reach = 20 * std::max(std::abs(p.typical), 1e-6);
  return {std::max(p.lower, -reach), std::min(p.upper, reach)};
}

void parameters(Bench& bench, std::size_t number, const models::Effect& effect) {
  const auto& info = effect.info();
  constexpr std::size_t kMost = 4;  // a table's knots are no sliders
  if (info.parameters.size() > kMost + 2) {
    note("its values come from a recording");
    return;
  }
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const auto& p = info.parameters[i];
    auto [low, high] = slider_range(p);
    double value = effect.parameters()[i];
    low = std::min(low, value), high = std::max(high, value);
    const std::string name = std::string(p.name);
    const auto edited = value_slider("effect_" + std::to_string(number) + "_" + name, name.c_str(), value, low, high,
                                     "%.4g", false, std::string(p.meaning).c_str());
    if (edited.changed) {
      bench.editor.edit("effect " + std::to_string(number) + " " + name, [&](models::Scenario& s) {
        std::vector<double> values(effect.parameters().begin(), effect.parameters().end());
        values[i] = value;
        auto& slot = s.arm.effects[number].second;
        slot = models::make_effect(info.name, slot->place(), values);
      });
    }
    if (edited.finished) bench.editor.seal();
  }
}

}  // namespace

void effects_controls(Bench& bench) {
  const auto effects = bench.editor.scenario().arm.effects;  // a copy: what follows may change the list
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const auto& [axis, effect] = effects[i];
    ImGui::PushID(static_cast<int>(i));
    const TextStyle style(look().body, axis == bench.editor.axis() ? palette().text : palette().muted);
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%s (%s, axis %s)", std::string(effect->info().title).c_str(),
                std::string(models::place_name(effect->place())).c_str(), std::string(models::axis_name(axis)).c_str());
    hint(std::string(effect->info().equation).c_str());
    ImGui::SameLine(ImGui::GetContentRegionMax().x - px(62));
    const bool removed = push_button("remove_effect_" + std::to_string(i), "Remove", false, px(62));
    if (!removed) parameters(bench, i, *effect);
    ImGui::PopID();
    if (removed) return bench.editor.remove_effect(i);
  }
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##add_effect", "Add an effect ...", ImGuiComboFlags_HeightLarge)) {
    for (const auto& type : models::effect_catalogue()) {
      const bool chosen = ImGui::Selectable(std::string(type.info.title).c_str());
      mark("effect." + std::string(type.info.name));
      hint(std::string(type.info.equation).c_str());
      if (chosen)
        bench.editor.add_effect(models::make_typical_effect(type.info.name, type.info.places.front()),
                                bench.editor.axis());
    }
    ImGui::EndCombo();
  }
  mark("control.add_effect");
}

}  // namespace handloop::ui
