#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "device/device.h"

/// Broken hardware on purpose: a device that passes everything on to another and spoils it. For tests, and for
/// `handloop run --inject NAME@SAMPLE` to see what a fault does before a hand is in the loop.
namespace handloop::device {

/// Where a fault strikes.
enum class Hook : std::uint8_t { start, read, write, stop };

struct InjectedFault {
  std::string_view name;     ///< "encoder_stuck_1", "throw_on_read"
  std::string_view meaning;  ///< one line
  Hook hook;
};

/// Every fault that can be injected.
std::span<const InjectedFault> injectable_faults();

/// Wraps a device so that it has the fault from sample `from_sample` on. Throws InputError for an unknown name,
/// suggesting the nearest. The inner device must outlive the result.
class FaultyDevice final : public Device {
 public:
  FaultyDevice(Device& inner, std::string_view fault, std::uint64_t from_sample);
  ~FaultyDevice() override;

  std::string_view name() const override { return inner_.name(); }
  const DeviceDescription& description() const override { return inner_.description(); }
  void start() override;
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override;
  bool lock_step() const override { return inner_.lock_step(); }

 private:
  struct Spoiler;
  Device& inner_;
  std::uint64_t from_sample_;
  std::uint64_t reads_ = 0;
  std::unique_ptr<Spoiler> spoiler_;
};

/// "NAME@SAMPLE" or "NAME" (from the first sample). Throws InputError where it is neither.
struct Injection {
  std::string name;
  std::uint64_t from_sample = 0;
};
Injection parse_injection(std::string_view text);

}  // namespace handloop::device
