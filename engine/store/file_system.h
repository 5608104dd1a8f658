// Where a store lies, and which way of writing it is safe there.
#pragma once

#include <optional>
#include <string>

namespace ed3r::store {

// The results file of a run directory: DIR/results.sqlite, or what that is a link to. SQLite keeps its logs beside the latter,
// and two directories that lead to one file must find one lock.
std::string ResultsFileOf(const std::string& dir);
// The directory that it is in.
std::string PlaceOf(const std::string& dir);

// What ED3R_STORE=local|shared says. UserError for another value.
std::optional<bool> SaidToBeShared();

// Whether several machines may see this directory (NFS, Lustre, GPFS, BeeGFS, Ceph, SMB ...), by the type that the kernel
// tells, or as ED3R_STORE says in its place. UserError when the directory is not there.
bool IsSharedFileSystem(const std::string& dir);

}  // namespace ed3r::store
