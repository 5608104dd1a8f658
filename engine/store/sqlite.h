// The little of SQLite's C API that the store needs, with RAII and the engine's errors:
//   UserError      the file cannot be used as asked: not a database, damaged, locked, no permission
//   StoreError     the machine failed: disk full, input/output error, out of memory
//   InternalError  wrong SQL or a broken constraint: a defect of the engine
// Each is one line that begins with the file. Threads: a connection and its statements serve one thread at
// a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/store/journals.h"

struct sqlite3;
struct sqlite3_stmt;

namespace ed3r::store {

// The disk or the machine failed, not the input.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// UserError where the path of FILE, which need not be there, is longer than SQLite takes.
void CheckPathLength(const std::string& file);

class Connection {
 public:
  enum class Access { kReadOnly, kReadWrite, kCreate };
  Connection(const std::string& file, Access access);

  void Execute(const std::string& sql);      // one or more statements without results
  std::int64_t Int(const std::string& sql);  // the first column of the first row
  std::string Text(const std::string& sql);  // likewise
  void SetBusyTimeout(int milliseconds);     // how long to wait for other processes
  bool InTransaction() const;
  const std::string& file() const { return file_; }

  // What the file itself tells, without what is in its journals; none where it is empty.
  std::optional<FileState> StateOfFile() const;
  // Whether the path that was opened leads to nothing now, or to another file.
  bool HasMoved() const;
  // UserError where the path that was opened leads to another file now. What this connection reads is still the first; what
  // opens the path again would read the other. A file that is gone is no other.
  void CheckNotReplaced() const;

  // The log stays beside the file when this connection is closed, instead of being written into it.
  void LeaveLog();

  // Throws the error of the last call on this connection.
  [[noreturn]] void Fail() const;
  // StoreError where the disk has refused to give what was read for: SQLite calls that damage.
  void CheckRead() const;

 private:
  friend class Statement;
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::string file_;
  std::string path_;  // absolute
  std::unique_ptr<sqlite3, Close> database_;
};

// A compiled statement. Parameters and columns are numbered from 0.
class Statement {
 public:
  Statement(Connection& connection, std::string_view sql);

  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);  // NaN becomes NULL
  void Bind(int parameter, std::string_view value);
  void BindBlob(int parameter, std::string_view bytes);
  void BindNull(int parameter);

  bool Step();   // true: a row is there; false: the end
  void Reset();  // ready for the next Bind and Step; keeps the bindings
  void Run();    // Step to the end, then Reset

  // Binds the values in order from parameter 0, then runs.
  template <class... Values>
  void Run(const Values&... values) {
    int parameter = 0;
    (Bind(parameter++, values), ...);
    Run();
  }

  std::int64_t Int(int column) const;
  double Real(int column) const;  // NULL becomes NaN
  std::string Text(int column) const;
  std::string Blob(int column) const;
  int Columns() const;
  bool IsNull(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Connection& connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

// Commits when told so, else rolls back. A read transaction sees one moment of the file; one within another sees that
// other's.
class Transaction {
 public:
  enum class Kind { kRead, kWrite };
  Transaction(Connection& connection, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void Commit();

 private:
  Connection& connection_;
  bool within_ = false;
};

}  // namespace ed3r::store
