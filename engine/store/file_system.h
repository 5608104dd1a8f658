// Which way of writing a store is safe where it lies.
#pragma once

#include <string>

namespace ed3r::store {

// Whether several machines may see this directory (NFS, Lustre, GPFS, BeeGFS, Ceph, SMB ...), by the type that the kernel
// tells. ED3R_STORE=local|shared decides in its place. UserError for another value of it, or when the directory is not
// there.
bool IsSharedFileSystem(const std::string& dir);

}  // namespace ed3r::store
