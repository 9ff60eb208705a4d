#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <functional>
#include <span>

namespace thicket {

// The common parts of save_to_file and load_from_file. An error is printed as "METHOD: cannot write PATH: REASON. REMEDY".

/// Makes `p_path` (user://, res:// or a path of the system) a file that holds these bytes. They go into a new file beside it first, which
/// takes its place once the disk has all of it. After an error the old file is unchanged.
godot::Error replace_file(const char *p_method, const godot::String &p_path, const godot::PackedByteArray &p_bytes);

/// Hands all bytes of a file to `load`, whose refusal becomes the error. Refuses a resource of the engine, which loading could let run
/// scripts.
godot::Error load_saved_file(const char *p_method, const godot::String &p_path,
		const std::function<Status(std::span<const std::uint8_t> bytes)> &load);

} // namespace thicket
