#pragma once

#include <string>

namespace thicket {

// Atomic replacement of files, implemented for each operating system. All paths are in UTF-8.

/// True if the functions below can access the operating system's files. In web builds, the engine
/// manages all files, and these functions have no effect.
#ifdef __wasm__
inline constexpr bool has_disk = false;
#else
inline constexpr bool has_disk = true;
#endif

/// Returns the file that a symbolic link points to, so that replacing the file keeps the link.
/// Returns `path` if the file does not exist. On Windows and the web, always returns `path`.
std::string resolved_path(const std::string &path);

/// Returns false for folders, devices and read-only files, although the system would permit
/// replacing a read-only file in a writable folder. Returns true if `path` does not exist.
bool can_be_replaced(const std::string &path);

/// Waits until the file `path` is written to the disk. Before that, copies the permissions of the
/// file `replaced`, if it exists, to `path` (not on Windows). Returns false on failure.
bool sync_file(const std::string &path, const std::string &replaced);

/// Atomically replaces the file `to` with the file `from` and waits until the change is written to
/// the disk. If the function returns false, both files are unchanged.
bool move_over(const std::string &from, const std::string &to);

} // namespace thicket
