// A ScatterMask as a file of bytes.

#include "nodes/common/convert.hpp"
#include "nodes/common/file_replace.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/layer/scatter_mask.hpp"

#include <godot_cpp/core/error_macros.hpp>

using namespace godot;

namespace thicket {

Error ScatterMask::save_to_file(const String &p_path) const {
	String problem;
	const Error error = replace_file(p_path, packed_bytes(mask_.to_bytes()), problem);
	if (error != OK) {
		ERR_PRINT("ScatterMask.save_to_file: " + problem);
	}
	return error;
}

Error ScatterMask::load_from_file(const String &p_path) {
	PackedByteArray bytes;
	String problem;
	const Error error = read_saved_file(p_path, bytes, problem);
	if (error != OK) {
		ERR_PRINT("ScatterMask.load_from_file: " + problem);
		return error;
	}
	const Status status = take(bytes);
	if (!status.ok()) {
		ERR_PRINT(vformat("ScatterMask.load_from_file: cannot load %s: %s", p_path, String(describe(status).c_str())));
	}
	return error_of(status);
}

} // namespace thicket
