// Errors of a connection that callers can do something about.
#pragma once

#include "engine/core/check.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// The file system cannot hold the shared memory that WAL mode needs.
class SharedMemoryError : public StoreError {
 public:
  using StoreError::StoreError;
};

// A writer was killed in the midst of a commit without WAL: what it left must be rolled back, which a read-only connection
// cannot do.
class UnfinishedCommitError : public UserError {
 public:
  using UserError::UserError;
};

}  // namespace ed3r::store
