#pragma once

#include <memory>
#include <string>

#include "ui/background/tuning_jobs.h"
#include "ui/session/live_session.h"
#include "ui/state/scenario_editor.h"

namespace handloop::ui {

enum class View { tune, arms, subject, data, traces, device };

/// Everything the views share: what is edited, what was computed, what runs. Physics is behind each of them.
struct Bench {
  explicit Bench(models::Scenario scenario, std::filesystem::path path)
      : editor(std::move(scenario), std::move(path)) {}

  ScenarioEditor editor;
  TuningJobs tuning;
  LiveSession session;
  View view = View::tune;
  std::string message;  ///< for the status line; the last thing that was done or went wrong
  bool message_is_bad = false;
  double now_s = 0.0;
  double frames_per_s = 0.0;

  void say(const std::string& text, bool bad = false) { message = text, message_is_bad = bad; }
};

}  // namespace handloop::ui
