#pragma once

#include <string>

namespace thicket {

// Atomic replacement of one file by another, as each operating system does it. All paths are in UTF-8.

/// False in a browser, where the engine owns the files. None of these functions has an effect there.
#ifdef __wasm__
inline constexpr bool has_disk = false;
#else
inline constexpr bool has_disk = true;
#endif

/// The file that a link leads to, so that the link itself survives. Returns `path` if it is not a link or leads nowhere.
std::string resolved_path(const std::string &path);

/// False for folders, devices and read-only files: the system would permit their replacement if their folder is
/// writable. True if `path` does not exist.
bool can_be_replaced(const std::string &path);

/// Waits until the file is on the disk. If the file `replaced` exists, first copies its permissions to the new file.
/// Returns false if the disk fails.
bool sync_file(const std::string &path, const std::string &replaced);

/// Moves the file `from` over `to` in one step, and waits until the move is on the disk. If the function returns false,
/// both files are unchanged.
bool move_over(const std::string &from, const std::string &to);

} // namespace thicket
