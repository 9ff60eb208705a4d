#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <functional>
#include <span>

namespace thicket {

// The implementation of save_to_file and load_from_file of several classes. Errors are printed as "METHOD: cannot write PATH: REASON.
// REMEDY".

/// Replaces the file at `p_path` (user://, res:// or a system path) with these bytes. First writes a new file beside
/// the old one. The new file replaces the old one once the disk has stored all of it. After an error the old file is
/// unchanged.
godot::Error replace_file(const char *p_method, const godot::String &p_path, const godot::PackedByteArray &p_bytes);

/// Passes all bytes of a file to `load`, and returns an error if `load` refuses them. Refuses files that contain a
/// resource of the engine, because loading one could run scripts.
godot::Error load_saved_file(const char *p_method, const godot::String &p_path,
		const std::function<Status(std::span<const std::uint8_t> bytes)> &load);

} // namespace thicket
