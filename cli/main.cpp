#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/usage.h"
#include "models/errors.h"

namespace {

constexpr int kRequirementNotMet = 1;
constexpr int kBadInput = 2;

int complain(const std::string& what, int code) {
  std::fprintf(stderr, "handloop: %s\n", handloop::cli::one_line(what).c_str());
  return code;
}

/// Parses and runs; the exit code.
int run(CLI::App& program, int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "complete-words") {  // asked by the shell, see completion_command.cpp
    std::puts(handloop::cli::completions(program, {words.begin() + 1, words.end()}).c_str());
    return 0;
  }
  if (const auto message = handloop::cli::unknown_command(program, words); !message.empty()) {
    return complain(message, kBadInput);
  }
  try {
    program.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return complain(handloop::cli::explain(program, error), kBadInput);
  } catch (const handloop::InputError& error) {
    return complain(error.what(), kBadInput);
  } catch (const handloop::RequirementError& error) {
    return complain(error.what(), kRequirementNotMet);
  } catch (const std::filesystem::filesystem_error& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this; try a smaller input or fewer jobs", kRequirementNotMet);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kRequirementNotMet);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"handloop: a simulated human hand in the loop of a haptic device"};
  program.set_version_flag("--version", HANDLOOP_VERSION);
  program.require_subcommand(1);
  handloop::cli::add_arm_command(program);
  handloop::cli::add_demo_command(program);
  handloop::cli::add_effects_command(program);
  handloop::cli::add_experiment_command(program);
  handloop::cli::add_explain_command(program);
  handloop::cli::add_identify_command(program);
  handloop::cli::add_margins_command(program);
  handloop::cli::add_doctor_command(program);
  handloop::cli::add_panel_command(program);
  handloop::cli::add_plant_command(program);
  handloop::cli::add_run_command(program);
  handloop::cli::add_sweep_command(program);
  handloop::cli::add_uncertainty_command(program);
  handloop::cli::add_completion_command(program);
  // After the commands, which would inherit it.
  program.footer(
      "Example: handloop arm show --axis x --grip nominal\nEach command explains itself: handloop COMMAND --help");
  const int code = run(program, argc, argv);
  // What went to standard output counts as written only once it is: a full disk must not pass for success.
  if ((std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && code == 0) {
    return complain(std::string("standard output: cannot be written: ") + std::strerror(errno), kBadInput);
  }
  return code;
}
