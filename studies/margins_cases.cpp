#include "studies/margins_cases.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include "io/output.h"
#include "models/axis.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::studies {
namespace {

enum Column : std::size_t {
  kId,
  kAxis,
  kM,
  kK1,
  kK2,
  kB1,
  kB2,
  kK,
  kB,
  kTipMass,
  kTipDamping,
  kT,
  kDelay,
  kCutoff,
  kColumns
};
constexpr std::array<std::string_view, kColumns> kNames{
    "id", "axis", "M", "k1", "k2", "b1", "b2", "K", "B", "m", "b", "T", "delay_samples", "cutoff_Hz"};
constexpr std::size_t kRequired = kTipMass;
constexpr std::string_view kOutputHeader = "id,stable,rho,gm_up,gm_down,pm_deg,dm_s,sm,disk_alpha\n";

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

/// Where each known column stands in a row, or npos.
struct Layout {
  std::vector<std::size_t> column_of;  ///< by position in the file: a Column, or kColumns for one that is ignored
  std::array<bool, kColumns> present{};
};

Layout read_header(std::string_view line, const std::string& file) {
  Layout layout;
  std::size_t begin = 0;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view name = trimmed(line.substr(begin, end - begin));
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    const auto at = static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin());
    if (at < kColumns && layout.present[at]) {
      throw InputError(file + ", line 1: column '" + std::string(name) + "' appears twice; it must appear once");
    }
    if (at < kColumns) layout.present[at] = true;
    layout.column_of.push_back(at);
    begin = end + 1;
  }
  for (std::size_t i = 0; i < kRequired; ++i) {
    if (!layout.present[i]) {
      throw InputError(
          file + ", line 1: no column '" + std::string(kNames[i]) +
          "'; the header must name id,axis,M,k1,k2,b1,b2,K,B (and may name m,b,T,delay_samples,cutoff_Hz)");
    }
  }
  return layout;
}

[[noreturn]] void complain(const std::string& file, std::size_t line, const std::string& what) {
  throw InputError(file + ", line " + std::to_string(line) + ": " + what);
}

/// One worker: parses, evaluates and prints the rows of its part of the text.
class Worker {
 public:
  Worker(const Layout& layout, const std::string& file) : layout_(layout), file_(file) {}

  void run(std::string_view text, std::size_t first_line, std::string& out) {
    out.reserve(text.size() / 2 + 1024);
    std::size_t line = first_line;
    while (!text.empty()) {
      const auto* newline = static_cast<const char*>(std::memchr(text.data(), '\n', text.size()));
      const std::size_t length = newline ? static_cast<std::size_t>(newline - text.data()) : text.size();
      const std::string_view row = text.substr(0, length);
      text.remove_prefix(newline ? length + 1 : length);
      if (!trimmed(row).empty()) one_row(row, line, out);
      ++line;
    }
  }

 private:
  void one_row(std::string_view row, std::size_t line, std::string& out) {
    std::array<std::string_view, kColumns> field;
    std::size_t begin = 0, position = 0;
    for (; begin <= row.size(); ++position) {
      const auto* comma = begin < row.size()
                              ? static_cast<const char*>(std::memchr(row.data() + begin, ',', row.size() - begin))
                              : nullptr;
      const std::size_t end = comma ? static_cast<std::size_t>(comma - row.data()) : row.size();
      if (position < layout_.column_of.size() && layout_.column_of[position] < kColumns) {
        field[layout_.column_of[position]] = trimmed(row.substr(begin, end - begin));
      }
      begin = end + 1;
    }
    if (position != layout_.column_of.size()) {
      complain(file_, line,
               "has " + std::to_string(position) + " fields where the header has " +
                   std::to_string(layout_.column_of.size()));
    }
    const auto number = [&](Column column) {
      double value = 0;
      const auto& text = field[column];
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size()) {
        complain(file_, line,
                 "column '" + std::string(kNames[column]) + "': '" + std::string(text) + "' is not a number");
      }
      return value;
    };
    const auto& axis = field[kAxis];
    if (axis.size() != 1 || std::strchr("xyzXYZ", axis[0]) == nullptr) {
      complain(file_, line, "column 'axis': '" + std::string(axis) + "' is no axis; it must be X, Y or Z");
    }
    control::Loop loop;
    loop.plant.arm = models::ArmParameters{number(kM), number(kK1), number(kK2), number(kB1), number(kB2)};
    loop.gains = {number(kK), number(kB)};
    if (layout_.present[kTipMass]) loop.plant.tip_mass_kg = number(kTipMass);
    if (layout_.present[kTipDamping]) loop.plant.tip_damping_Ns_per_m = number(kTipDamping);
    if (layout_.present[kT]) loop.timing.sample_time_s = number(kT);
    if (layout_.present[kCutoff]) loop.timing.cutoff_Hz = number(kCutoff);
    if (layout_.present[kDelay]) {
      const double delay = number(kDelay);
      if (!(delay >= 0 && delay <= control::kMaxDelaySamples && delay == std::floor(delay))) {
        complain(file_, line,
                 "column 'delay_samples': " + std::string(field[kDelay]) + " must be a whole number from 0 to " +
                     std::to_string(control::kMaxDelaySamples));
      }
      loop.timing.delay_samples = static_cast<int>(delay);
    }
    control::Margins margins;
    try {
      margins = control::evaluate(loop);
    } catch (const InputError& error) {
      complain(file_, line, error.what());
    }
    print(field[kId], margins, out);
  }

  static void print(std::string_view id, const control::Margins& m, std::string& out) {
    std::array<char, 400> buffer;
    char* at = buffer.data();
    char* const end = buffer.data() + buffer.size();
    const auto put = [&](double value) {
      *at++ = ',';
      if (std::isinf(value)) {
        std::memcpy(at, value > 0 ? "inf" : "-inf", value > 0 ? 3 : 4);
        at += value > 0 ? 3 : 4;
      } else {
        at = std::to_chars(at, end, value).ptr;
      }
    };
    out.append(id);
    *at++ = ',', *at++ = m.stable ? '1' : '0';
    put(m.rho);
    if (m.stable) {
      for (const double value : {m.gain_up, m.gain_down, m.phase_deg, m.delay_s, m.modulus, m.disk_alpha}) put(value);
    } else {
      std::memcpy(at, ",,,,,,", 6);
      at += 6;
    }
    *at++ = '\n';
    out.append(buffer.data(), static_cast<std::size_t>(at - buffer.data()));
  }

  const Layout& layout_;
  const std::string& file_;
};

}  // namespace

std::string margins_of_cases(std::string_view csv, const std::string& file, unsigned threads) {
  if (csv.starts_with("\xEF\xBB\xBF")) csv.remove_prefix(3);
  const std::size_t header_end = std::min(csv.find('\n'), csv.size());
  const Layout layout = read_header(trimmed(csv.substr(0, header_end)), file);
  const std::string_view body = header_end < csv.size() ? csv.substr(header_end + 1) : std::string_view{};

  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  // parts end at line ends and are taken in turn, so that slow rows do not hold one thread up
  constexpr std::size_t kPart = 1 << 18;
  struct Part {
    std::string_view text;
    std::size_t first_line = 0;
    std::string out;
    std::exception_ptr error;
  };
  std::vector<Part> parts;
  std::size_t line = 2;
  for (std::size_t begin = 0; begin < body.size();) {
    std::size_t end = std::min(begin + kPart, body.size());
    if (end < body.size()) end = std::min(body.find('\n', end), body.size() - 1) + 1;
    parts.push_back({body.substr(begin, end - begin), line, {}, {}});
    line += static_cast<std::size_t>(std::count(body.begin() + static_cast<std::ptrdiff_t>(begin),
                                                body.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    begin = end;
  }
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&] {
    Worker worker(layout, file);
    for (std::size_t i; (i = next++) < parts.size() && !failed;) {
      try {
        worker.run(parts[i].text, parts[i].first_line, parts[i].out);
      } catch (...) {
        parts[i].error = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> crew;
  for (unsigned i = 1; i < std::min<std::size_t>(threads, parts.size()); ++i) crew.emplace_back(work);
  work();
  for (auto& thread : crew) thread.join();
  std::size_t size = kOutputHeader.size();
  for (const auto& part : parts) {
    if (part.error) std::rethrow_exception(part.error);
    size += part.out.size();
  }
  std::string out;
  out.reserve(size);
  out.append(kOutputHeader);
  for (const auto& part : parts) out.append(part.out);
  return out;
}

std::size_t margins_of_case_file(const std::filesystem::path& input, const std::filesystem::path& output,
                                 unsigned threads) {
  std::ifstream in(input, std::ios::binary);
  if (!in || std::filesystem::is_directory(input))
    throw InputError(input.string() + ": cannot be read; give a CSV file of cases");
  std::string text;
  in.seekg(0, std::ios::end);
  text.resize(static_cast<std::size_t>(std::max<std::streamoff>(in.tellg(), 0)));
  in.seekg(0);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (text.empty()) throw InputError(input.string() + ": is empty; its first line must name id,axis,M,k1,k2,b1,b2,K,B");
  const std::string result = margins_of_cases(text, input.string(), threads);

  io::write_file_atomically(output, result);
  return static_cast<std::size_t>(std::count(result.begin(), result.end(), '\n')) - 1;
}

}  // namespace handloop::studies
