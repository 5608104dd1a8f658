#include "engine/store/sqlite.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <limits>
#include <system_error>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/utf8.h"
#include "engine/store/sqlite_errors.h"

namespace ed3r::store {
namespace {

constexpr int kBusyTimeout_ms = 10000;

int OpenFlags(Connection::Access access) {
  switch (access) {
    case Connection::Access::kReadOnly:
      return SQLITE_OPEN_READONLY;
    case Connection::Access::kReadWrite:
      return SQLITE_OPEN_READWRITE;
    case Connection::Access::kCreate:
      return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  }
  return 0;
}

// SQLite would wait for a pipe, take a folder for a locked file, and make what a link leads to.
void CheckFiles(const std::string& file) {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::error_code error;  // another process may be making or removing them
    const std::filesystem::file_status found = std::filesystem::status(file + suffix, error);
    if (!std::filesystem::exists(found) && std::filesystem::is_symlink(file + suffix, error))
      throw UserError(
          fmt::format("{}{}: is a link to a file that is not there; take it away, or give another directory",
                      file, suffix));
    if (!std::filesystem::exists(found) || std::filesystem::is_regular_file(found)) continue;
    throw UserError(fmt::format("{}{}: cannot be read: {}", file, suffix, WhyNoRegularFile(file + suffix)));
  }
}

// Codes that callers can do something about.
void FailByExtendedCode(const std::string& file, int code, const std::string& reason) {
  switch (code) {
    case SQLITE_IOERR_SHMOPEN:
    case SQLITE_IOERR_SHMSIZE:
    case SQLITE_IOERR_SHMLOCK:
    case SQLITE_IOERR_SHMMAP:
    case SQLITE_PROTOCOL:
      throw SharedMemoryError(fmt::format(
          "{0}: {0}-shm, the memory that its readers and writers share, cannot be used here ({1}, SQLite "
          "code {2}); copy the folder to a local disk, or say ED3R_STORE=shared",
          file, reason, code));
    case SQLITE_READONLY_ROLLBACK:
      throw UnfinishedCommitError(
          fmt::format("{}: a writer was killed in the midst of a commit, or is at one; the run's own command "
                      "continues it",
                      file));
    default:
      return;
  }
}

std::string Reason(int error) { return std::error_code(error, std::generic_category()).message(); }

// What may have stopped a write: SQLite forgets the system's reason.
std::string SizeLimit(int extended_code) {
  rlimit limit{};
  if (extended_code != SQLITE_IOERR_WRITE || getrlimit(RLIMIT_FSIZE, &limit) != 0 ||
      limit.rlim_cur == RLIM_INFINITY)
    return "";
  return fmt::format("; files may have {} bytes here, by ulimit -f", limit.rlim_cur);
}

// Why SQLite could not open a file: it tells of no cause.
std::string WhyNotOpened(const std::string& file, const std::string& reason) {
  if (access(file.c_str(), R_OK) != 0) return fmt::format("{}: cannot be read: {}", file, Reason(errno));
  std::error_code error;
  const auto unmerged_bytes = std::filesystem::file_size(file + "-wal", error);
  const std::string memory = file + "-shm";
  const bool there = std::filesystem::exists(memory);
  const std::string needed = there ? memory : std::filesystem::absolute(file).parent_path().string();
  if (!error && unmerged_bytes > 0 && access(needed.c_str(), R_OK | W_OK) != 0)
    return fmt::format(
        "{0}: its last commits lie in {0}-wal, and to read them {0}-shm cannot be {1}: {2}; read it as a "
        "user who may write there, or copy the folder",
        file, there ? "opened" : "made", Reason(errno));
  if (access(file.c_str(), W_OK) != 0) return fmt::format("{}: cannot be written: {}", file, Reason(errno));
  return fmt::format("{}: cannot be opened for this ({})", file, reason);
}

}  // namespace

void CheckPathLength(const std::string& file) {
  constexpr std::string_view kLongestSuffix = "-journal";
  const auto most = static_cast<std::size_t>(sqlite3_vfs_find(nullptr)->mxPathname) - kLongestSuffix.size();
  std::error_code error;
  const std::filesystem::path real =
      std::filesystem::weakly_canonical(file, error);  // links count by their ends
  const std::size_t bytes = (error ? std::filesystem::absolute(file) : real).native().size();
  if (bytes > most)
    throw UserError(fmt::format(
        "{}: its whole path has {} bytes, and SQLite opens none of more than {}; give a shorter one", file,
        bytes, most));
}

void Connection::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Connection::Connection(const std::string& file, Access access) : file_(file) {
  CheckFiles(file);
  CheckPathLength(file);
  std::error_code error;
  // What a link leads to: SQLite's journals lie beside that.
  const std::filesystem::path real = std::filesystem::canonical(file, error);
  const bool there = !error;
  if (there && std::filesystem::is_symlink(file, error)) {
    CheckFiles(real.string());
    CheckNoJournals(file, "the file that this name leads to");
  }
  if (!there) CheckNoJournals(file, "its results file, which is not there");
  sqlite3* database = nullptr;
  // An absolute path, because Debian's SQLite takes a name that begins with "file:" for a URI.
  path_ = there ? real.string() : std::filesystem::absolute(file).string();
  const int status =
      sqlite3_open_v2(path_.c_str(), &database, OpenFlags(access) | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(database);
  if (!database) throw StoreError(fmt::format("{}: out of memory", file));
  if (status != SQLITE_OK) Fail();
  SetBusyTimeout(kBusyTimeout_ms);
  if (there)
    CheckJournals(path_, [this] { return StateOfFile(); });  // before the first look, which takes them up
}

std::optional<FileState> Connection::StateOfFile() const {
  sqlite3_file* file = nullptr;
  std::array<unsigned char, 48> bytes = {};
  if (sqlite3_file_control(database_.get(), nullptr, SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK ||
      file == nullptr || file->pMethods == nullptr ||
      file->pMethods->xRead(file, bytes.data(), static_cast<int>(bytes.size()), 0) != SQLITE_OK)
    return std::nullopt;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | bytes[i];
    return value;
  };
  return FileState{.changes = number(24), .mark = number(40), .pages = number(28)};
}

bool Connection::HasMoved() const {
  int moved = 0;
  return sqlite3_file_control(database_.get(), nullptr, SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK &&
         moved != 0;
}

void Connection::LeaveLog() {
  sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

void Connection::CheckNotReplaced() const {
  std::error_code error;
  if (HasMoved() && std::filesystem::exists(path_, error))
    throw UserError(
        fmt::format("{}: was replaced since it was opened; open it again (the same command does)", file_));
}

void Connection::Execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) Fail();
}

std::int64_t Connection::Int(const std::string& sql) {
  Statement statement(*this, sql);
  ED3R_CHECK(statement.Step(), sql);
  return statement.Int(0);
}

std::string Connection::Text(const std::string& sql) {
  Statement statement(*this, sql);
  ED3R_CHECK(statement.Step(), sql);
  return statement.Text(0);
}

void Connection::SetBusyTimeout(int milliseconds) { sqlite3_busy_timeout(database_.get(), milliseconds); }

bool Connection::InTransaction() const { return sqlite3_get_autocommit(database_.get()) == 0; }

void Connection::Fail() const {
  const std::string reason = sqlite3_errmsg(database_.get());
  FailByExtendedCode(file_, sqlite3_extended_errcode(database_.get()), reason);
  switch (sqlite3_errcode(database_.get()) & 0xff) {  // the low byte is the kind, the rest details
    case SQLITE_NOTADB:
      throw UserError(fmt::format("{}: not a results file ({})", file_, reason));
    case SQLITE_CORRUPT:
      CheckRead();
      throw UserError(fmt::format("{}: the file is damaged ({})", file_, reason));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw UserError(fmt::format("{}: in use by another process ({}); try again later", file_, reason));
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      throw UserError(WhyNotOpened(file_, reason));
    case SQLITE_IOERR:  // the extended code tells reading from writing and syncing
      throw StoreError(fmt::format(
          "{}: {} (SQLite code {}{}); what is stored is kept, and the same command continues", file_, reason,
          sqlite3_extended_errcode(database_.get()), SizeLimit(sqlite3_extended_errcode(database_.get()))));
    case SQLITE_FULL:
      throw StoreError(fmt::format(
          "{}: {}; what is stored is kept: make room, and the same command continues", file_, reason));
    case SQLITE_NOMEM:
      throw StoreError(
          fmt::format("{}: {}, or a length in it is damaged and asks for more than there is", file_, reason));
    case SQLITE_TOOBIG:
    case SQLITE_PROTOCOL:
    case SQLITE_NOLFS:
      throw StoreError(fmt::format("{}: {}", file_, reason));
    case SQLITE_ERROR:  // our SQL is right where tables and header are as we made them
      throw UserError(fmt::format("{}: the file is damaged ({})", file_, reason));
    default:
      throw InternalError(fmt::format("{}: SQLite: {}", file_, reason));
  }
}

void Connection::CheckRead() const {
  for (const int which : {SQLITE_FCNTL_FILE_POINTER, SQLITE_FCNTL_JOURNAL_POINTER}) {
    sqlite3_file* file = nullptr;
    int error = 0;
    if (sqlite3_file_control(database_.get(), nullptr, which, &file) != SQLITE_OK || file == nullptr ||
        file->pMethods == nullptr ||
        file->pMethods->xFileControl(file, SQLITE_FCNTL_LAST_ERRNO, &error) != SQLITE_OK)
      continue;
    if (error == EIO || error == ENXIO || error == ENOMEM)
      throw StoreError(
          fmt::format("{}: cannot be read: {}; the {} has failed, which says nothing of what is stored",
                      file_, Reason(error), error == ENOMEM ? "system" : "disk"));
  }
}

Statement::Statement(Connection& connection, std::string_view sql) : connection_(connection) {
  sqlite3_stmt* statement = nullptr;
  const int status = sqlite3_prepare_v3(connection.database_.get(), sql.data(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  statement_.reset(statement);
  if (status != SQLITE_OK) connection.Fail();
}

void Statement::Bind(int parameter, std::int64_t value) {
  if (sqlite3_bind_int64(statement_.get(), parameter + 1, value) != SQLITE_OK) connection_.Fail();
}

void Statement::Bind(int parameter, double value) {
  if (sqlite3_bind_double(statement_.get(), parameter + 1, value) != SQLITE_OK) connection_.Fail();
}

void Statement::Bind(int parameter, std::string_view value) {
  // A host or a path of the system may be called anything; as it is, readers would take it for damage.
  if (!IsUtf8(value)) return Bind(parameter, std::string_view(AsUtf8(value)));
  if (sqlite3_bind_text64(statement_.get(), parameter + 1, value.data(), value.size(), SQLITE_TRANSIENT,
                          SQLITE_UTF8) != SQLITE_OK)
    connection_.Fail();
}

void Statement::BindBlob(int parameter, std::string_view bytes) {
  if (sqlite3_bind_blob64(statement_.get(), parameter + 1, bytes.data(), bytes.size(), SQLITE_TRANSIENT) !=
      SQLITE_OK)
    connection_.Fail();
}

void Statement::BindNull(int parameter) {
  if (sqlite3_bind_null(statement_.get(), parameter + 1) != SQLITE_OK) connection_.Fail();
}

bool Statement::Step() {
  const int status = sqlite3_step(statement_.get());
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  connection_.Fail();
}

void Statement::Reset() { sqlite3_reset(statement_.get()); }

void Statement::Run() {
  while (Step()) {
  }
  Reset();
}

std::int64_t Statement::Int(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Statement::Real(int column) const {
  // NULL reads as 0.0, and few values do: most need no second call.
  const double value = sqlite3_column_double(statement_.get(), column);
  return value == 0.0 && IsNull(column) ? std::numeric_limits<double>::quiet_NaN() : value;
}

std::string Statement::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  const int bytes = sqlite3_column_bytes(statement_.get(), column);
  if (text == nullptr) return "";
  std::string value(reinterpret_cast<const char*>(text), static_cast<std::size_t>(bytes));
  if (!IsUtf8(value))
    throw UserError(fmt::format("{}: the file is damaged (a text that is not UTF-8)", connection_.file()));
  return value;
}

std::string Statement::Blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return bytes ? std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size)) : "";
}

int Statement::Columns() const { return sqlite3_column_count(statement_.get()); }

bool Statement::IsNull(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

Transaction::Transaction(Connection& connection, Kind kind)
    : connection_(connection), within_(kind == Kind::kRead && connection.InTransaction()) {
  if (within_) return;
  connection_.Execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  // SQLite rolls back by itself after some errors; then there is nothing left to do.
  try {
    if (!within_ && connection_.InTransaction()) connection_.Execute("ROLLBACK");
  } catch (...) {  // the connection is closed next, which rolls back as well
  }
}

void Transaction::Commit() { connection_.Execute("COMMIT"); }

}  // namespace ed3r::store
