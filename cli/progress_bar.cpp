#include "cli/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

namespace handloop::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// "42 s", "3 min 20 s", "2 h 05 min".
std::string duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

class Bar {
 public:
  explicit Bar(std::string what) : what_(std::move(what)), start_(Clock::now()) {}

  void show(std::size_t done, std::size_t total) {
    const auto now = Clock::now();
    const bool finished = done >= total;
    if (!finished && now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    if (finished) {
      fmt::print(stderr, "\r\033[K");
    } else {
      constexpr std::size_t kWidth = 30;
      const double share = static_cast<double>(done) / static_cast<double>(total);
      const auto filled = static_cast<std::size_t>(share * kWidth);
      const double passed_s = std::max(std::chrono::duration<double>(now - start_).count(), 1e-6);
      fmt::print(stderr, "\r{} [{}{}] {}/{}", what_, std::string(filled, '#'), std::string(kWidth - filled, '.'), done,
                 total);
      if (done > 0) {
        fmt::print(stderr, ", {:.3g}/s, {} left", static_cast<double>(done) / passed_s,
                   duration(passed_s * (1 / share - 1)));
      }
      fmt::print(stderr, "\033[K");
    }
    std::fflush(stderr);
  }

 private:
  std::string what_;
  Clock::time_point start_, shown_{};
};

}  // namespace

studies::Progress progress_bar(std::string what) {
  if (isatty(STDERR_FILENO) == 0) return {};
  const auto bar = std::make_shared<Bar>(std::move(what));
  return [bar](std::size_t done, std::size_t total) { bar->show(done, total); };
}

}  // namespace handloop::cli
