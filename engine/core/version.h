// Which code this is. Generated at build time from the source tree.
#pragma once

namespace ed3r {

struct CodeVersion {
  const char* source_hash;  // of the sources that results depend on; equal hashes give equal results
  const char* commit;       // "unknown" outside a git checkout
  bool dirty;               // the checkout had uncommitted changes
  const char* compiler;
  const char* flags;
};

CodeVersion ThisCode();

}  // namespace ed3r
