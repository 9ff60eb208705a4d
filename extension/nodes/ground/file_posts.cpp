#include "nodes/ground/file_posts.hpp"

#include "core/heightmap/height_file.hpp"
#include "nodes/ground/image_posts.hpp"

#include <godot_cpp/classes/file_access.hpp>
#include <godot_cpp/classes/resource_loader.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *file_property = "heightmap_path";

/// Returns the bytes per height sample that the extension of a raw file specifies, or 0.
int bytes_per_post_of(const String &p_path) {
	const String extension = p_path.get_extension().to_lower();
	if (extension == "r8") {
		return 1;
	}
	if (extension == "r16") {
		return 2;
	}
	return extension == "r32" || extension == "f32" ? 4 : 0;
}

Status unreadable_error(const String &p_path) {
	// The export of an imported file contains only the imported resource.
	return Status::missing(file_property,
			ResourceLoader::get_singleton()->exists(p_path)
					? "The exported game contains only the imported image: in the Import dock, set the file to Keep "
					  "File, or set image instead"
					: "Check that the file exists, can be read and is not empty");
}

/// Reads an EXR file through the engine. Requires Godot 4.6.
Status read_exr(const PackedByteArray &bytes, Posts &r_posts) {
	const Ref<Image> image(memnew(Image));
	if (!image->has_method("load_exr_from_buffer")) { // Called by name, because Godot 4.4 lacks it.
		return Status::wrong_type(
				file_property, "EXR files need Godot 4.6 or newer: import the file as an Image, and set image instead");
	}
	const Variant error = image->call("load_exr_from_buffer", bytes);
	if (static_cast<std::int64_t>(error) != OK || !has_content(image)) {
		return {ErrorCode::corrupt, file_property, 0.0, {}, {},
				"The engine cannot read this EXR file: save it as a single part with 16-bit or 32-bit floats"};
	}
	const Status status = read_posts(image, file_property, r_posts);
	r_posts.format = image->get_format() >= Image::FORMAT_RH ? "16-bit EXR" : "32-bit EXR";
	return status;
}

} // namespace

Status read_file_posts(const String &p_path, glm::ivec2 post_count, Posts &r_posts) {
	if (p_path.is_empty()) {
		return Status::missing(file_property, "Set heightmap_path or image");
	}
	const PackedByteArray file = FileAccess::get_file_as_bytes(p_path);
	if (file.is_empty()) {
		return unreadable_error(p_path);
	}
	const std::span<const std::uint8_t> bytes(file.ptr(), static_cast<std::size_t>(file.size()));
	switch (kind_of_height_file(bytes)) {
		case HeightFileKind::png: return read_png(bytes, file_property, r_posts);
		case HeightFileKind::exr: return read_exr(file, r_posts);
		case HeightFileKind::tiff:
		case HeightFileKind::raw: break;
	}
	return read_raw(bytes, {post_count, bytes_per_post_of(p_path)}, file_property, r_posts);
}

} // namespace thicket
