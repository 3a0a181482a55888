#include "device/log_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "io/csv_file.h"
#include "models/errors.h"

namespace handloop::device {
namespace {

namespace fs = std::filesystem;

TEST(LogFile, EveryPageEndsWithACompleteRowAndNumbersAreUnharmed) {
  const fs::path path = fs::path(testing::TempDir()) / "pages.csv";
  {
    LogFile log(path, {});
    StepRecord record;
    for (int i = 0; i < 3000; ++i) {
      record.reading.sample = static_cast<std::uint64_t>(i);
      record.reading.time_ns = 1'000'000LL * i;
      record.tip_m = {1e-3 * std::sin(0.1 * i), -1.0 / (i + 1), i % 7 == 0 ? 0.0 : 1.23456789e-17 * i};
      record.sensed_force_N = record.tip_m * 3.3;
      EXPECT_TRUE(log.add(record));
    }
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(text.size(), 100 * 4096u);
  for (std::size_t end = 4096; end <= text.size(); end += 4096) EXPECT_EQ(text[end - 1], '\n') << end;
  const io::CsvFile table(path);
  const std::vector<std::size_t> columns{table.require("time_s"), table.require("y_m"), table.require("z_m")};
  const auto values = table.read_numbers(columns);
  ASSERT_EQ(values[0].size(), 3000u);
  for (int i = 0; i < 3000; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(values[0][k], 1e6 * i / 1e9);
    EXPECT_EQ(values[2][k], 1e-3 * std::sin(0.1 * i));  // z of the hand is x of the device
  }
  fs::remove(path);
}

TEST(LogFile, ADiskThatTakesNothingIsNoticedAtOnce) {
  LogFile log("/dev/full", {});
  EXPECT_TRUE(log.failed());
  EXPECT_FALSE(log.add({}));
  EXPECT_FALSE(log.error().empty());
  EXPECT_THROW(LogFile("/does/not/exist/log.csv", {}), InputError);
}

}  // namespace
}  // namespace handloop::device
