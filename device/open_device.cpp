#include "device/open_device.h"

#include <array>
#include <string_view>

#include "device/comedi/comedi_device.h"
#include "device/replay_device.h"
#include "device/seven_bar_device.h"
#include "device/wire/wire_device.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::device {
namespace {

DeviceDescription simulated_description(const models::Scenario& scenario) {
  return make_simulated_device(scenario)->description();
}

}  // namespace

std::unique_ptr<Device> open_device(const std::string& address, const OpenOptions& options) {
  const std::string_view text = address;
  const auto after = [&](std::string_view prefix) { return std::string(text.substr(prefix.size())); };
  if (options.key && !text.starts_with("udp://")) throw InputError("--key is only for --device udp://HOST:PORT");
  if (text == "sim") return make_simulated_device(options.scenario);
  if (text.starts_with("udp://")) {
    wire::WireOptions wire;
    wire.plant = wire::parse_address(after("udp://"), "--device");
    wire.scenario_hash = plant_hash(options.scenario);
    wire.seed = options.scenario.run.seed;
    wire.lock_step = !options.realtime;
    if (options.key) wire.key.emplace(wire::read_key_file(*options.key));
    return std::make_unique<wire::WireDevice>(simulated_description(options.scenario), std::move(wire));
  }
  if (text.starts_with("replay:")) {
    return std::make_unique<ReplayDevice>(simulated_description(options.scenario), options.scenario, after("replay:"));
  }
  if (options.scenario.device.model == models::DeviceModel::seven_bar && text.starts_with("comedi")) {
    throw InputError("--device '" + address +
                     "': boards are wired for the Phantom; the seven-bar runs on sim, udp and replay");
  }
  if (text == "comedi" || text.starts_with("comedi:")) {
    const auto config = text == "comedi" ? comedi::ComediConfig{} : comedi::read_comedi_config(after("comedi:"));
    return std::make_unique<comedi::ComediDevice>(config, options.scenario.device.pose_rad,
                                                  options.scenario.loop.sample_time_s);
  }
  constexpr std::array<std::string_view, 4> kKnown{"sim", "udp://HOST:PORT", "comedi", "replay:FILE"};
  throw InputError("--device '" + address + "' is not known" + suggestion(address, kKnown));
}

std::uint64_t plant_hash(models::Scenario scenario) {
  const models::Scenario usual;
  scenario.name = usual.name;
  scenario.description = usual.description;
  const double sample_time_s = scenario.loop.sample_time_s;
  scenario.loop = usual.loop;
  scenario.loop.sample_time_s = sample_time_s;
  scenario.wall = usual.wall;
  scenario.safety = usual.safety;
  const auto hand_and_load = scenario.force_amplifier;
  scenario.force_amplifier = usual.force_amplifier;
  scenario.force_amplifier.load_kg = hand_and_load.load_kg;
  scenario.force_amplifier.hand = hand_and_load.hand;
  scenario.force_amplifier.hand_rms_N = hand_and_load.hand_rms_N;
  scenario.force_amplifier.hand_bandwidth_Hz = hand_and_load.hand_bandwidth_Hz;
  scenario.force_amplifier.hand_cubic_N_per_m3 = hand_and_load.hand_cubic_N_per_m3;
  scenario.force_amplifier.hand_leaves_s = hand_and_load.hand_leaves_s;
  scenario.run.duration_s = usual.run.duration_s;
  scenario.run.seed = usual.run.seed;
  return wire::text_hash(io::to_toml(scenario));
}

}  // namespace handloop::device
