// This file contains the methods of ScatterMask that save and load files.

#include "nodes/common/convert.hpp"
#include "nodes/common/file_replace.hpp"
#include "nodes/layer/scatter_mask.hpp"

using namespace godot;

namespace thicket {

Error ScatterMask::save_to_file(const String &p_path) const {
	return replace_file("ScatterMask.save_to_file", p_path, packed_bytes(mask_.to_bytes()));
}

Error ScatterMask::load_from_file(const String &p_path) {
	return load_saved_file("ScatterMask.load_from_file", p_path,
			[this](std::span<const std::uint8_t> bytes) { return replace_content(bytes); });
}

} // namespace thicket
