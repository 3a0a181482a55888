#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "ui/app/shortcuts.h"
#include "ui/traces/pixel_columns.h"
#include "ui/traces/trace_store.h"
#include "ui/traces/trace_window.h"
#include "ui/widgets/axis_ticks.h"
#include "ui/widgets/theme.h"

namespace handloop::ui {
namespace {

TEST(MinMaxRing, FindsTheExtremesThatBruteForceFinds) {
  MinMaxRing ring;
  std::mt19937 generator(1);
  std::normal_distribution<float> normal;
  std::vector<float> all;
  for (int i = 0; i < 70000; ++i) {
    all.push_back(normal(generator));
    ring.add(all.back());
  }
  std::uniform_int_distribution<std::uint64_t> place(0, all.size());
  for (int trial = 0; trial < 2000; ++trial) {
    auto from = place(generator), to = place(generator);
    if (from > to) std::swap(from, to);
    const auto found = ring.extremes(from, to);
    if (from == to) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    const auto [low, high] = std::minmax_element(all.begin() + static_cast<std::ptrdiff_t>(from),
                                                 all.begin() + static_cast<std::ptrdiff_t>(to));
    ASSERT_EQ(found.low, *low) << from << ' ' << to;
    ASSERT_EQ(found.high, *high) << from << ' ' << to;
  }
}

TEST(MinMaxRing, ForgetsTheOldestAndKeepsItsNumbers) {
  MinMaxRing ring;
  const std::uint64_t count = MinMaxRing::kCapacity + 5000;
  for (std::uint64_t i = 0; i < count; ++i) ring.add(static_cast<float>(i));
  EXPECT_EQ(ring.count(), count);
  EXPECT_EQ(ring.first(), 5000u);
  EXPECT_EQ(ring[count - 1], static_cast<float>(count - 1));
  const auto all = ring.extremes(0, count);
  EXPECT_EQ(all.low, 5000.0f);
  EXPECT_EQ(all.high, static_cast<float>(count - 1));
  const auto oldest = ring.extremes(0, 5010);
  EXPECT_EQ(oldest.low, 5000.0f);
  EXPECT_EQ(oldest.high, 5009.0f);
}

TEST(MinMaxRing, DrawsAMillionSamplesWithNoPeakLost) {
  MinMaxRing ring;
  for (std::uint64_t i = 0; i < MinMaxRing::kCapacity; ++i) ring.add(static_cast<float>(i % 500));
  const auto columns = pixel_columns(ring, 1e-3, 0.0, 1048.576, 1200);  // 873 samples a pixel
  ASSERT_EQ(columns.size(), 1200u);
  for (const auto& column : columns) {
    EXPECT_EQ(column.low, 0.0f);
    EXPECT_EQ(column.high, 499.0f);
  }
}

TEST(PixelColumns, HoldEverySampleOnceAndNoOther) {
  MinMaxRing ring;
  for (int i = 0; i < 10000; ++i) ring.add(static_cast<float>(i));
  const auto columns = pixel_columns(ring, 1e-3, 2.0, 7.0, 613);
  float next = 2000.0f;
  for (const auto& column : columns) {
    if (column.empty()) continue;
    EXPECT_EQ(column.low, next);
    next = column.high + 1;
  }
  EXPECT_EQ(next, 7000.0f);
}

TEST(PixelColumns, AreEmptyBeforeTheFirstSampleAndAfterTheLast) {
  MinMaxRing ring;
  for (int i = 0; i < 100; ++i) ring.add(1.0f);
  const auto columns = pixel_columns(ring, 1e-3, -0.1, 0.3, 40);
  EXPECT_TRUE(columns.front().empty());
  EXPECT_FALSE(columns[12].empty());
  EXPECT_TRUE(columns.back().empty());
}

TEST(TraceStore, TurnsRecordsIntoTheHandsAxesAndUnits) {
  TraceStore store;
  device::DeviceDescription description;
  description.torque_Nm_per_A = {0.0234, 0.0234, 0.0234};
  description.transmission_ratio = {13.3, 11.2, 11.2};
  description.amplifier_A_per_V = 0.3;
  description.current_limit_A = 3.0;
  store.begin(description, {0.2, 0.0, -0.1});
  device::StepRecord record;
  record.tip_m = {0.21, 0.003, -0.102};  // device frame: fore-aft, lateral, up
  record.sensed_force_N = {1, 2, 3};
  record.reading.encoder_counts = {-5, 6, 7};
  record.command.dac_codes = {4095, 2048, 0};
  record.compute_ns = 12000;
  store.add(record);
  EXPECT_NEAR(store[Channel::position_x][0], 0.003, 1e-7);
  EXPECT_NEAR(store[Channel::position_y][0], -0.002, 1e-7);
  EXPECT_NEAR(store[Channel::position_z][0], 0.01, 1e-7);
  EXPECT_EQ(store[Channel::force_z][0], 1.0f);
  EXPECT_EQ(store[Channel::counts_1][0], -5.0f);
  EXPECT_NEAR(store[Channel::torque_1][0], 13.3 * 0.0234 * 3.0, 1e-4);  // 10 V, 3 A
  EXPECT_NEAR(store[Channel::torque_3][0], -11.2 * 0.0234 * 3.0, 1e-4);
  EXPECT_EQ(store.compute_times().total(), 1u);
}

TEST(TraceStore, ExportsTheStretchThatIsShown) {
  TraceStore store;
  store.begin({}, Eigen::Vector3d::Zero());
  for (int i = 0; i < 50; ++i) {
    device::StepRecord record;
    record.tip_m = {0.001 * i, 0, 0};
    store.add(record);
  }
  const auto path = std::filesystem::temp_directory_path() / "handloop_panel_traces.csv";
  const std::array channels{Channel::position_z, Channel::energy};
  store.write_csv(path, channels, 10, 13);
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  std::filesystem::remove(path);
  EXPECT_EQ(text.str(),
            "time_s,position_z_m,energy_J\n0.01,0.00999999978,0\n0.011,0.0109999999,0\n0.012,0.0120000001,0\n");
}

TEST(LogHistogram, PutsValuesWhereTheyBelong) {
  LogHistogram histogram;
  histogram.add(1.05e-6);
  histogram.add(0.0);
  histogram.add(50.0);
  EXPECT_EQ(histogram.counts()[10], 1u);
  EXPECT_EQ(histogram.counts().front(), 1u);
  EXPECT_EQ(histogram.counts().back(), 1u);
}

TEST(TraceWindow, FollowsUntilItIsHeld) {
  TraceWindow window;
  window.follow(30.0);
  EXPECT_DOUBLE_EQ(window.high_s(), 30.0);
  window.pause();
  window.follow(60.0);
  EXPECT_DOUBLE_EQ(window.high_s(), 30.0);
  window.resume();
  window.follow(61.0);
  EXPECT_DOUBLE_EQ(window.high_s(), 61.0);
}

TEST(TraceWindow, ZoomsAboutTheMomentUnderTheMouse) {
  TraceWindow window;
  window.follow(30.0);
  window.pause();
  window.zoom(0.5, 22.0);  // window was 20 to 30
  EXPECT_DOUBLE_EQ(window.low_s(), 21.0);
  EXPECT_DOUBLE_EQ(window.high_s(), 26.0);
}

TEST(AxisTicks, AreRoundAndInside) {
  for (const auto& range : {AxisRange{-2.6, 1.4}, AxisRange{0, 1458}, AxisRange{1e-6, 3e-6}, AxisRange{-270, 90}}) {
    const auto ticks = ticks_of(range, 6);
    EXPECT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 8u);
    for (const auto& tick : ticks) {
      EXPECT_GE(tick.value, range.low - 1e-12);
      EXPECT_LE(tick.value, range.high + 1e-12);
      EXPECT_LE(tick.label.size(), 8u) << tick.label;
    }
  }
}

TEST(AxisTicks, MarkDecadesOnLogarithmicAxes) {
  std::vector<std::string> labels;
  for (const auto& tick : ticks_of({0.1, 1000, true}, 8)) {
    if (!tick.label.empty()) labels.push_back(tick.label);
  }
  EXPECT_EQ(labels, (std::vector<std::string>{"0.1", "1", "10", "100", "1000"}));
}

TEST(AxisRange, GoesThereAndBack) {
  for (const auto& range : {AxisRange{-3, 5}, AxisRange{0.2, 700, true}}) {
    for (const double place : {0.0, 0.3, 1.0}) EXPECT_NEAR(range.place_of(range.value_at(place)), place, 1e-12);
  }
}

TEST(AxisRange, KeepsTheCentreWhenZoomed) {
  const auto near = zoomed({0, 10}, 0.25, 0.5);
  EXPECT_DOUBLE_EQ(near.value_at(0.25), 2.5);
  EXPECT_DOUBLE_EQ(near.high - near.low, 5.0);
}

TEST(Palette, IsReadable) {
  for (const auto brightness : {Brightness::dark, Brightness::light}) {
    const auto& p = palette_of(brightness);
    // WCAG 2: 4.5 for text, 3 for large text and what carries meaning
    for (const auto* ground : {&p.window, &p.surface}) {
      EXPECT_GE(contrast(p.text, *ground), 7.0);
      EXPECT_GE(contrast(p.muted, *ground), 4.5);
      for (const auto* colour : {&p.stable, &p.doubtful, &p.unstable}) EXPECT_GE(contrast(*colour, *ground), 4.5);
      for (const auto& colour : p.series) EXPECT_GE(contrast(colour, *ground), 3.0);
    }
    EXPECT_GE(contrast({1, 1, 1, 1}, p.stop), 4.5);
  }
}

/// Difference in CIE L*a*b*, where 2.3 is just noticeable.
double difference(const Colour& first, const Colour& second) {
  const auto lab = [](const Colour& c) {
    const auto linear = [](float v) {
      return v <= 0.04045f ? static_cast<double>(v) / 12.92 : std::pow((static_cast<double>(v) + 0.055) / 1.055, 2.4);
    };
    const double r = linear(c.r), g = linear(c.g), b = linear(c.b);
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
    const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047), y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
                 z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883);
    return std::array{116 * y - 16, 500 * (x - y), 200 * (y - z)};
  };
  const auto a = lab(first), b = lab(second);
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(Palette, IsToldApartWithAnyColourVision) {
  for (const auto brightness : {Brightness::dark, Brightness::light}) {
    const auto& p = palette_of(brightness);
    for (const auto vision : {ColourVision::normal, ColourVision::protanope, ColourVision::deuteranope}) {
      EXPECT_GE(difference(as_seen(p.stable, vision), as_seen(p.unstable, vision)), 30.0);
      // the three curves that share most pictures
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = i + 1; k < 3; ++k)
          EXPECT_GE(difference(as_seen(p.series[i], vision), as_seen(p.series[k], vision)), 15.0) << i << ' ' << k;
      }
    }
  }
}

TEST(Shortcuts, StopWorksWhileTypingAndWithAnythingHeld) {
  constexpr int kEscape = 256, kShiftAndControl = 3;
  for (const int held : {0, kShiftAndControl}) {
    EXPECT_EQ(commands_of({{kEscape, held}}, true), std::vector{Command::stop});
    EXPECT_EQ(commands_of({{kEscape, held}}, false), std::vector{Command::stop});
  }
}

TEST(Shortcuts, LeaveUndoToTheTextThatIsTyped) {
  constexpr int kZ = 90, kControl = 2;
  EXPECT_EQ(commands_of({{kZ, kControl}}, false), std::vector{Command::undo});
  EXPECT_TRUE(commands_of({{kZ, kControl}}, true).empty());
}

TEST(Shortcuts, AreDifferent) {
  const auto& all = shortcuts();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = i + 1; k < all.size(); ++k)
      EXPECT_FALSE(all[i].key == all[k].key && all[i].modifiers == all[k].modifiers) << all[i].keys;
  }
}

}  // namespace
}  // namespace handloop::ui
