#pragma once

#include <CLI/CLI.hpp>

/// Each command is one file cli/<name>_command.cpp with one function that adds it to the program. A command parses and
/// prints; what it does is a call into studies/. Errors are thrown as InputError (exit code 2) or RequirementError (1).
namespace handloop::cli {

void add_arm_command(CLI::App& program);
void add_completion_command(CLI::App& program);
void add_demo_command(CLI::App& program);
void add_effects_command(CLI::App& program);
void add_experiment_command(CLI::App& program);
void add_explain_command(CLI::App& program);
void add_identify_command(CLI::App& program);
void add_margins_command(CLI::App& program);
void add_panel_command(CLI::App& program);
void add_sweep_command(CLI::App& program);
void add_uncertainty_command(CLI::App& program);
void add_doctor_command(CLI::App& program);
void add_plant_command(CLI::App& program);
void add_run_command(CLI::App& program);

}  // namespace handloop::cli
