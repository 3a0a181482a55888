#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "cli/commands.h"
#include "cli/scenario_argument.h"
#include "device/stop_signals.h"
#include "models/errors.h"
#include "studies/plant_service.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string scenario, listen, key;
};

void serve(const Options& given) {
  studies::PlantServiceOptions options;
  options.scenario = read_scenario_argument(given.scenario);
  options.listen = given.listen;
  if (!given.key.empty()) options.key = given.key;
  options.stop = &device::stop_on_signals();
  options.on_ready = [&](const std::string& address, bool loopback) {
    fmt::print("{} on {}{}\n", options.scenario.name, address, options.key ? ", authenticated packets only" : "");
    std::fflush(stdout);
    if (!loopback && !options.key) {
      fmt::print(stderr, "handloop: {} can be reached from other machines and has no --key: anybody may drive it\n",
                 address);
    }
  };
  const auto outcome = studies::serve_plant(options);
  const auto& c = outcome.counters;
  fmt::print("{} sessions; {} packets received, {} refused, {} doubled, {} reordered; {} silences\n", outcome.sessions,
             c.received, c.refused(), c.doubled, c.reordered, c.silences);
}

}  // namespace

void add_plant_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  options->scenario = "scenes/phantom_wall.toml";
  auto* command = program.add_subcommand("plant", "The simulated device as a server, for controllers elsewhere");
  command->add_option("scenario", options->scenario, "Scenario file (default: the Phantom at a virtual wall)");
  command->add_option("--listen", options->listen, "HOST:PORT, or PORT on this machine only")->required();
  command->add_option("--key", options->key, "File with the key: take authenticated packets only");
  command->footer("Example: handloop plant scenes/phantom_wall.toml --listen 127.0.0.1:5000");
  command->callback([options] { serve(*options); });
}

}  // namespace handloop::cli
