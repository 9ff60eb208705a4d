#pragma once

#include <string>

namespace thicket {

// How a system puts a file in the place of another one, whole or not at all. All paths are in UTF-8.

/// False in a browser, whose files are the engine's: there none of these does anything.
#ifdef __wasm__
inline constexpr bool has_disk = false;
#else
inline constexpr bool has_disk = true;
#endif

/// The file that a link leads to, for the link is to stay; the path itself where it is no link or leads nowhere.
std::string resolved_path(const std::string &path);

/// False for folders, devices and files that may not be written: the folder alone would let any of them be replaced. True where nothing is.
bool can_be_replaced(const std::string &path);

/// Waits until the disk has a file, and gives it the permissions of the one that it will replace, if that is there. False where the disk fails.
bool sync_file(const std::string &path, const std::string &replaced);

/// Puts the file `from` in the place of `to`, in one step, and waits until the disk has done so. After false both are as they were.
bool move_over(const std::string &from, const std::string &to);

} // namespace thicket
