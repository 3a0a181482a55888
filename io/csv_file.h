#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/mapped_file.h"

namespace handloop::io {

/// A comma-separated table: at most one header line, dot decimals, UTF-8, LF or CRLF. Lines before the header that
/// begin with '#' are skipped, so are empty lines at the end. Cells may stand in double quotes.
///
/// A first line of numbers only means that there is no header; columns are then named by number.
class CsvFile {
 public:
  /// Maps the file and reads its header. Throws InputError where there is nothing in it.
  explicit CsvFile(const std::filesystem::path& path);
  /// The same for text in memory; `name` stands for the file in messages. The text must outlive the object.
  CsvFile(std::string_view text, std::string name);

  const std::string& name() const { return name_; }
  bool has_header() const { return has_header_; }
  /// Names in the header, or "1", "2", ... without one.
  const std::vector<std::string>& columns() const { return columns_; }

  /// Index of the column of that name, if there is one. Throws InputError where several have it.
  std::optional<std::size_t> find(std::string_view column) const;
  /// The same, 1-based numbers accepted too. Throws InputError naming the columns there are.
  std::size_t require(std::string_view column) const;

  /// Line number in the file (from 1) of a row (from 0).
  std::size_t line_of_row(std::size_t row) const { return first_line_ + row; }
  /// "FILE, line 12, column force_N"
  std::string place(std::size_t row, std::size_t column) const;

  /// The named columns as numbers, one vector each. Throws InputError for the first cell that is not a finite number
  /// and for the first row that does not have as many cells as the header.
  std::vector<std::vector<double>> read_numbers(std::span<const std::size_t> wanted) const;

  /// Calls `visit(row, cells)` for every row; the cells are valid during the call. Throws InputError for a row of
  /// another width than the header.
  void for_each_row(const std::function<void(std::size_t row, std::span<const std::string> cells)>& visit) const;

  /// A cell as a finite number. Throws InputError naming its place.
  double to_number(std::string_view cell, std::size_t row, std::size_t column) const;

 private:
  std::string name_;
  std::unique_ptr<MappedFile> file_;
  std::string_view body_;
  std::vector<std::string> columns_;
  std::size_t first_line_ = 1;
  bool has_header_ = false;

  void read_header(std::string_view text);
  void check_width(std::size_t cells, std::size_t row) const;
  std::string column_list() const;
};

/// The number that the whole text is, blanks around it allowed; "nan" and "inf" are numbers here.
std::optional<double> parse_number(std::string_view text);

}  // namespace handloop::io
