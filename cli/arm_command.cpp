#include "cli/commands.h"

namespace handloop::cli {

void add_arm_command(CLI::App& program) {
  auto* arm = program.add_subcommand("arm", "The measured arms: show, sample and plot them");
  arm->require_subcommand(1);
}

}  // namespace handloop::cli
