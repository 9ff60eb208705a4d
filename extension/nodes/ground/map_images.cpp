#include "nodes/ground/map_images.hpp"

#include "nodes/ground/shared_pixels.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/texture2d.hpp>
#include <godot_cpp/core/object.hpp>

using namespace godot;

namespace thicket {

Ref<Image> MapImages::read(const Variant &p_data, int kind, int index) {
	const Variant count = has_method(p_data, "get_map_count") ? result_of(p_data, "get_map_count", {kind}) : Variant();
	if (!is_number(count) || index >= static_cast<int>(count)) {
		return {};
	}
	Ref<Image> image = image_in(result_of(p_data, "get_image", {kind, index}));
	if (image.is_null() && has_method(p_data, "get_texture")) {
		image = read_texture(result_of(p_data, "get_texture", {kind, index}));
	}
	lacks_pixels_ = lacks_pixels_ || image.is_null();
	return image;
}

/// Reads back the pixels of a texture, or reuses those of an imported texture.
Ref<Image> MapImages::read_texture(const Variant &p_texture) {
	const Ref<Texture2D> texture = Object::cast_to<Texture2D>(p_texture.get_validated_object());
	if (texture.is_null()) {
		return {};
	}
	const std::uint64_t id = texture->get_instance_id();
	if (const auto entry = previous_.find(id); entry != previous_.end()) {
		// An imported texture never changes, so its pixels need not be read back again.
		imported_[id] = entry->second;
		return entry->second;
	}
	const Ref<Image> image = image_in(texture->get_image());
	if (image.is_valid() && texture->is_class("CompressedTexture2D")) {
		imported_[id] = image;
	}
	return image;
}

} // namespace thicket
