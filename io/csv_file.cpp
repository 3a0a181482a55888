#include "io/csv_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io {
namespace {

/// std::from_chars, with a short cut for plain decimals of up to 15 digits: both the digits and the power of ten are
/// then exact in a double, so one division rounds as from_chars would. Most recorded numbers are of this kind.
std::from_chars_result fast_from_chars(const char* first, const char* last, double& value) {
  static constexpr double kTens[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const char* at = first;
  const bool negative = at < last && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const char* const begin = at;
  const char* point = nullptr;
  for (; at < last; ++at) {
    const auto digit = static_cast<unsigned>(*at - '0');
    if (digit <= 9) {
      digits = digits * 10 + digit;
    } else if (*at == '.' && point == nullptr) {
      point = at;
    } else {
      break;
    }
  }
  const auto length = at - begin;
  const auto decimals = point != nullptr ? at - point - 1 : 0;
  // Anything else, a lone point or an exponent included, is for the library.
  const bool whole = at == last || *at == ',' || *at == '\n' || *at == '\r';
  if (!whole || length > 15 || length == (point != nullptr ? 1 : 0)) return std::from_chars(first, last, value);
  value = static_cast<double>(digits) / kTens[decimals];
  if (negative) value = -value;
  return {at, std::errc()};
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Takes the next line off the text, without its end.
std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  auto line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void split(std::string_view line, std::vector<std::string>& cells) {
  cells.clear();
  for (;;) {
    const auto start = line.find_first_not_of(" \t");
    if (start != std::string_view::npos && line[start] == '"') {
      line.remove_prefix(start + 1);
      std::string cell;
      while (!line.empty()) {  // a doubled quote stands for one
        const auto quote = line.find('"');
        cell.append(line.substr(0, quote));
        line.remove_prefix(quote == std::string_view::npos ? line.size() : quote + 1);
        if (!line.starts_with('"')) break;
        cell += '"';
        line.remove_prefix(1);
      }
      cells.push_back(std::move(cell));
      const auto comma = line.find(',');
      if (comma == std::string_view::npos) return;
      line.remove_prefix(comma + 1);
      continue;
    }
    const auto comma = line.find(',');
    cells.emplace_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

/// Text from a file as it may stand in a message: short, and printable.
std::string quoted(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  if (text.size() > 40) shown += "...";
  return "'" + shown + "'";
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::nullopt;
  return value;
}

CsvFile::CsvFile(const std::filesystem::path& path) : name_(path.string()), file_(std::make_unique<MappedFile>(path)) {
  read_header(file_->bytes());
}

CsvFile::CsvFile(std::string_view text, std::string name) : name_(std::move(name)) {
  read_header(text);
}

void CsvFile::read_header(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty() && (std::strchr("\r\n \t", text.back()) != nullptr || text.back() == '\0'))
    text.remove_suffix(1);
  if (text.empty())
    throw InputError(name_ + ": is empty; expected a header line like time_s,force_N,position_m and rows");
  const auto no_text = [](char c) { return (c >= 0 && c < '\t') || c == '\x7f'; };
  if (std::any_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.size(), 4096)),
                  no_text)) {
    throw InputError(name_ + ": is not text; expected comma-separated values (or a MATLAB file named *.mat)");
  }
  auto rest = text;
  auto line = take_line(rest);
  while (line.starts_with('#') && !rest.empty()) {
    ++first_line_;
    text = rest;
    line = take_line(rest);
  }
  split(line, columns_);
  if (columns_.size() == 1 && line.find_first_of(";\t") != std::string_view::npos) {
    throw InputError(fmt::format("{}, line {}: columns are separated by {}; write commas, and dots in decimals", name_,
                                 first_line_, line.find(';') != std::string_view::npos ? "';'" : "tabs"));
  }
  has_header_ =
      !std::all_of(columns_.begin(), columns_.end(), [](const auto& cell) { return parse_number(cell).has_value(); });
  if (has_header_) {
    ++first_line_;
    body_ = rest;
  } else {
    for (std::size_t i = 0; i < columns_.size(); ++i) columns_[i] = std::to_string(i + 1);
    body_ = text;
  }
}

std::string CsvFile::column_list() const {
  if (!has_header_) return fmt::format("there is no header line; columns are 1 to {}", columns_.size());
  std::string list = "columns are ";
  for (std::size_t i = 0; i < columns_.size() && i < 12; ++i) list += (i > 0 ? ", " : "") + columns_[i];
  return columns_.size() > 12 ? list + ", ..." : list;
}

std::optional<std::size_t> CsvFile::find(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) return std::nullopt;
  if (std::find(found + 1, columns_.end(), column) != columns_.end()) {
    throw InputError(
        fmt::format("{}: several columns are called {}; name one by its number, from 1", name_, quoted(column)));
  }
  return found - columns_.begin();
}

std::size_t CsvFile::require(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
  if (error == std::errc() && end == column.data() + column.size() && number >= 1 && number <= columns_.size()) {
    return number - 1;
  }
  const std::vector<std::string_view> known(columns_.begin(), columns_.end());
  const auto near = has_header_ ? nearest_word(column, known) : std::string_view();
  throw InputError(fmt::format("{}: no column {}; {}{}", name_, quoted(column),
                               near.empty() ? "" : fmt::format("did you mean '{}'? ", near), column_list()));
}

std::string CsvFile::place(std::size_t row, std::size_t column) const {
  return fmt::format("{}, line {}, column {}", name_, line_of_row(row), columns_[column]);
}

void CsvFile::check_width(std::size_t cells, std::size_t row) const {
  if (cells == columns_.size()) return;
  throw InputError(fmt::format("{}, line {}: has {} cell{} where {} {}", name_, line_of_row(row), cells,
                               cells == 1 ? "" : "s", has_header_ ? "the header has" : "the first line has",
                               columns_.size()));
}

double CsvFile::to_number(std::string_view cell, std::size_t row, std::size_t column) const {
  const auto value = parse_number(cell);
  if (value && std::isfinite(*value)) return *value;
  if (trimmed(cell).empty()) throw InputError(place(row, column) + ": is empty; a number is needed in every row");
  throw InputError(fmt::format("{}: {} is not a {}number", place(row, column), quoted(cell), value ? "finite " : ""));
}

void CsvFile::for_each_row(
    const std::function<void(std::size_t row, std::span<const std::string> cells)>& visit) const {
  std::vector<std::string> cells;
  auto rest = body_;
  for (std::size_t row = 0; !rest.empty(); ++row) {
    split(take_line(rest), cells);
    check_width(cells.size(), row);
    visit(row, cells);
  }
}

std::vector<std::vector<double>> CsvFile::read_numbers(std::span<const std::size_t> wanted) const {
  const auto width = columns_.size();
  std::vector<std::vector<double>> values(wanted.size());
  // Where each column of the file goes, by its own vector's index; a column may be wanted more than once.
  std::vector<int> first_slot(width, -1);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (first_slot[wanted[i]] < 0) first_slot[wanted[i]] = static_cast<int>(i);
  }
  auto probe = body_;
  const auto estimated_rows = body_.size() / (take_line(probe).size() + 1) + 16;
  for (auto& column : values) column.reserve(estimated_rows + estimated_rows / 16);

  std::vector<double> row_values(wanted.size());
  std::vector<std::string> cells;
  const char* position = body_.data();
  const char* const end = body_.data() + body_.size();
  for (std::size_t row = 0; position < end; ++row) {
    // Plain rows are read in place; anything unusual (blanks, quotes, errors) sends the line to the careful reader
    // below.
    const char* const line = position;
    bool plain = true;
    for (std::size_t column = 0; column < width && plain; ++column) {
      const bool last = column + 1 == width;
      if (const auto slot = first_slot[column]; slot >= 0) {
        double value = 0;
        const auto [next, error] = fast_from_chars(position, end, value);
        plain = error == std::errc() && std::isfinite(value);
        row_values[static_cast<std::size_t>(slot)] = value;
        position = next;
      } else {
        while (position < end && *position != ',' && *position != '\n' && *position != '"') ++position;
      }
      if (!plain) break;
      if (last) {
        if (position < end && *position == '\r') ++position;
        plain = position == end || *position == '\n';
      } else {
        plain = position < end && *position == ',';
      }
      if (position < end) ++position;
    }
    if (!plain) {
      auto rest = std::string_view(line, static_cast<std::size_t>(end - line));
      split(take_line(rest), cells);
      check_width(cells.size(), row);
      for (std::size_t column = 0; column < width; ++column) {
        if (const auto slot = first_slot[column]; slot >= 0) {
          row_values[static_cast<std::size_t>(slot)] = to_number(cells[column], row, column);
        }
      }
      position = rest.empty() ? end : rest.data();
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      values[i].push_back(row_values[static_cast<std::size_t>(first_slot[wanted[i]])]);
    }
  }
  return values;
}

}  // namespace handloop::io
