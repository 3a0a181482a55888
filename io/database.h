#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// SQLite, with errors as InputError naming the file and the reason (a full disk, a locked or damaged file). What a
/// transaction committed survives kill -9 of the program at any moment; what it did not commit leaves no trace.
/// Not real-time safe; a database belongs to one thread.
namespace handloop::io {

class Database {
 public:
  enum class Open { create, existing, read_only };

  /// Opens or creates. Throws InputError where that is not possible or the file is not a database.
  Database(const std::filesystem::path& path, Open open);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs one or more statements that return nothing.
  void run(const std::string& sql);
  bool has_table(std::string_view name);
  const std::filesystem::path& path() const { return path_; }
  /// Folds the write-ahead log into the file and goes back to a single file, so that it can be moved or copied.
  void settle();

 private:
  friend class Statement;
  [[noreturn]] void fail(const std::string& doing);

  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
};

/// A prepared statement. Columns and parameters count from 0.
class Statement {
 public:
  Statement(Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, int value) { return bind(index, static_cast<std::int64_t>(value)); }
  Statement& bind(int index, double value);  ///< NaN is stored as NULL, infinity as infinity
  Statement& bind(int index, std::string_view value);
  Statement& bind_null(int index);

  /// True while there is a row to read.
  bool step();
  /// Steps once, expecting no row, and makes the statement ready to be bound and run again.
  void run();
  void reset();

  std::int64_t integer(int column) const;
  double real(int column) const;  ///< NaN for NULL
  bool is_null(int column) const;
  std::string text(int column) const;

 private:
  Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

/// Rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace handloop::io
