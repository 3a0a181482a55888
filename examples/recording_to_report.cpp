// Reads a recording, looks at its spectrum and writes a page that stands alone.
//   recording_to_report RECORDING.csv REPORT.html
#include <complex>
#include <cstdio>
#include <numbers>

#include "identify/spectra.h"
#include "io/recording_file.h"
#include "io/report.h"
#include "models/arm_tables.h"
#include "models/errors.h"

using namespace handloop;

int main(int argc, char** argv) try {
  if (argc != 3) throw InputError("usage: recording_to_report RECORDING.csv REPORT.html");
  const auto recording = io::read_recording(argv[1]);
  const auto settings = identify::long_segment_settings(recording.size(), recording.sample_time_s);
  const auto measured = identify::frequency_response(
      identify::welch(recording.force_N, recording.position_m, recording.sample_time_s, settings));

  io::Plot plot{
      .title = "Compliance", .x_label = "frequency, Hz", .y_label = "|x/F|, m/N", .log_x = true, .log_y = true};
  io::Series points{.label = "measured", .style = io::Series::Style::points}, nominal{.label = "nominal arm, axis X"};
  for (std::size_t i = 0; i < measured.size(); ++i) {
    points.x.push_back(measured.frequency_Hz[i]);
    points.y.push_back(std::abs(measured.response[i]));
    const std::complex<double> s(0, 2 * std::numbers::pi * measured.frequency_Hz[i]);
    nominal.x.push_back(measured.frequency_Hz[i]);
    nominal.y.push_back(std::abs(models::compliance(models::nominal_arm(models::Axis::x), s)));
  }
  plot.series = {points, nominal};
  io::Report report("A recording", recording.name);
  report
      .figures(
          {{"samples", std::to_string(recording.size())}, {"rate", io::pretty(1 / recording.sample_time_s) + " Hz"}})
      .plot(plot)
      .write(argv[2]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
