#include "ui/views/verdict_card.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/state/verdict.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

const Colour& colour_of(Outlook outlook) {
  const auto& p = palette();
  return outlook == Outlook::stable ? p.stable : outlook == Outlook::doubtful ? p.doubtful : p.unstable;
}

/// Told apart by shape as well: a disc, a triangle, a square.
void sign(ImDrawList* draw, ImVec2 centre, float radius, Outlook outlook) {
  const ImU32 colour = packed(colour_of(outlook));
  if (outlook == Outlook::stable) {
    draw->AddCircleFilled(centre, radius, colour);
  } else if (outlook == Outlook::doubtful) {
    draw->AddTriangleFilled({centre.x, centre.y - radius}, {centre.x + radius, centre.y + 0.8f * radius},
                            {centre.x - radius, centre.y + 0.8f * radius}, colour);
  } else {
    draw->AddRectFilled({centre.x - 0.9f * radius, centre.y - 0.9f * radius},
                        {centre.x + 0.9f * radius, centre.y + 0.9f * radius}, colour);
  }
}

void tile(const Figure& figure, float width) {
  ImGui::BeginGroup();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  {
    const TextStyle style(look().small, palette().muted);
    ImGui::TextUnformatted(figure.name.c_str());
  }
  {
    const auto& p = palette();
    const TextStyle style(look().bold, figure.good ? (*figure.good ? p.text : p.unstable) : p.text);
    ImGui::TextUnformatted(figure.value.c_str());
  }
  ImGui::SetCursorScreenPos(corner);
  ImGui::Dummy({width, look().small->FontSize + look().bold->FontSize + px(8)});
  ImGui::EndGroup();
  mark("figure." + figure.name, figure.value);
  if (!figure.hint.empty()) hint(figure.hint.c_str());
}

}  // namespace

void verdict_card(Bench& bench) {
  const auto& tuning = bench.tuning;
  constexpr int kFigures = 7;
  const int columns = std::clamp(static_cast<int>((ImGui::GetContentRegionAvail().x - px(16)) / px(96)), 3, kFigures);
  const int rows = (kFigures + columns - 1) / columns;
  const float tile_height = look().small->FontSize + look().bold->FontSize + px(8);
  const float height =
      look().title->FontSize + static_cast<float>(rows) * tile_height + px(30) + (rows > 1 ? px(16) : 0.0f);
  ImGui::BeginChild("verdict", {0, height}, true, ImGuiWindowFlags_NoScrollbar);
  if (!tuning.nominal()) {
    const TextStyle style(look().bold, palette().unstable);
    ImGui::TextWrapped("No verdict: %s", tuning.problem().empty() ? "being computed" : tuning.problem().c_str());
    ImGui::EndChild();
    return;
  }
  const auto verdict = verdict_of(*tuning.nominal(), tuning.population());
  const float radius = 0.36f * look().title->FontSize;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  sign(ImGui::GetWindowDrawList(), {corner.x + radius, corner.y + 0.55f * look().title->FontSize}, radius,
       verdict.outlook);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 2 * radius + px(10));
  {
    const TextStyle style(look().title, colour_of(verdict.outlook));
    ImGui::TextUnformatted(verdict.word.c_str());
    mark("verdict", verdict.word + ": " + verdict.sentence);
  }
  ImGui::SameLine(0, px(12));
  {
    const float rest = ImGui::GetContentRegionAvail().x;
    const auto fits = look().body->CalcTextSizeA(look().body->FontSize, 1e9f, 0, verdict.sentence.c_str()).x < rest;
    const TextStyle style(fits ? look().body : look().small, palette().text);
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + (fits ? px(8) : px(2)));
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(verdict.sentence.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::SetCursorPosY(look().title->FontSize + px(22) + (rows > 1 ? px(16) : 0.0f));
  const auto figures = figures_of(*tuning.nominal(), tuning.robust(), tuning.population());
  const float gap = px(6);
  const float width =
      (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (i % static_cast<std::size_t>(columns) != 0) ImGui::SameLine(0, gap);
    tile(figures[i], width);
  }
  ImGui::EndChild();
}

}  // namespace handloop::ui
