#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "control/transfer_loop.h"
#include "io/json.h"

/// Margins in the machine form of CONTRACT.md: infinity is the string "inf", a margin of an unstable loop null.
namespace handloop::studies {

/// Keys stable, rho, gm_up, gm_down, pm_deg, dm_s, sm, disk_alpha, each margin with its frequency w_<key> in rad/s, and
/// what the disk margin guarantees at once (disk_gain, disk_phase_deg).
nlohmann::ordered_json to_json(const control::Margins& margins);

/// The same of a transfer function, with its closed-loop poles.
nlohmann::ordered_json to_json(const control::TransferMargins& margins);

using io::json_number;
using io::write_json;

}  // namespace handloop::studies
