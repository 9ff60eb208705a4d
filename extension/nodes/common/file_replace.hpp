#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <functional>
#include <span>

namespace thicket {

// These functions implement save_to_file and load_from_file of several classes. They print errors
// in the form "METHOD: cannot write PATH: REASON. HOW TO FIX IT".

/// Atomically replaces the contents of the file at `p_path` (user://, res:// or a system path).
/// Writes a temporary file next to it, flushes the temporary file to disk, then renames it. After
/// an error, the old file is unchanged.
godot::Error replace_file(const char *p_method, const godot::String &p_path, const godot::PackedByteArray &p_bytes);

/// Passes the bytes of a file to `load`. Prints and returns an error if the file cannot be read or
/// `load` rejects the bytes. Also rejects Godot resource files, because loading a resource could
/// run scripts.
godot::Error load_saved_file(const char *p_method, const godot::String &p_path,
		const std::function<Status(std::span<const std::uint8_t> bytes)> &load);

} // namespace thicket
