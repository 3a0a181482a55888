#include <cstdio>
#include <exception>
#include <string>

#include "cli/commands.h"
#include "models/errors.h"

namespace {

constexpr int kRequirementNotMet = 1;
constexpr int kBadInput = 2;

int complain(const char* what, int code) {
  std::fprintf(stderr, "handloop: %s\n", what);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"handloop: a simulated human hand in the loop of a haptic device"};
  program.set_version_flag("--version", HANDLOOP_VERSION);
  program.require_subcommand(1);
  handloop::cli::add_arm_command(program);
  handloop::cli::add_margins_command(program);
  handloop::cli::add_uncertainty_command(program);
  try {
    program.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return complain(error.what(), kBadInput);
  } catch (const handloop::InputError& error) {
    return complain(error.what(), kBadInput);
  } catch (const handloop::RequirementError& error) {
    return complain(error.what(), kRequirementNotMet);
  } catch (const std::exception& error) {
    return complain((std::string("internal error: ") + error.what()).c_str(), kRequirementNotMet);
  }
}
