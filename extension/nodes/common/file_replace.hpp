#pragma once

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// Makes `p_path` (user://, res:// or a path of the system) a file that holds these bytes. They go into a new file beside it first, which
/// takes its place once the disk has all of it. After an error the old file is as it was, and `r_problem` says why, as
/// "cannot write PATH: REASON. REMEDY".
godot::Error replace_file(const godot::String &p_path, const godot::PackedByteArray &p_bytes, godot::String &r_problem);

/// All bytes of a file that `save_to_file` of a class wrote. Refuses a resource of the engine, which loading could let run scripts. After an
/// error `r_problem` says why, as for `replace_file`.
godot::Error read_saved_file(const godot::String &p_path, godot::PackedByteArray &r_bytes, godot::String &r_problem);

} // namespace thicket
