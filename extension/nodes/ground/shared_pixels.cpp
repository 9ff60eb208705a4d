#include "nodes/ground/shared_pixels.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/ground/image_posts.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <memory>
#include <utility>

using namespace godot;

namespace thicket {

Ref<Image> image_in(const Variant &p_value) {
	const Ref<Image> image = Object::cast_to<Image>(p_value.get_validated_object());
	return has_content(image) ? image : Ref<Image>();
}

bool share_pixels(const Ref<Image> &p_image, int pixel_bytes, PixelGrid &r_pixels) {
	const auto bytes = std::make_shared<PackedByteArray>(p_image->get_data());
	SharedBytes shared{bytes, span_of(*bytes)};
	return r_pixels.set({p_image->get_width(), p_image->get_height()}, pixel_bytes, std::move(shared)).ok();
}

bool share_pixels_as(const Ref<Image> &p_image, Image::Format format, int pixel_bytes, PixelGrid &r_pixels) {
	if (p_image->get_format() == format) {
		// No conversion is necessary, so share the memory of the image.
		return share_pixels(p_image, pixel_bytes, r_pixels);
	}
	const Ref<Image> image = p_image->duplicate();
	if (image->is_compressed() && image->decompress() != OK) {
		return false;
	}
	image->convert(format);
	return image->get_format() == format && share_pixels(image, pixel_bytes, r_pixels);
}

bool patch_pixels(const Ref<Image> &p_image, const PixelRect &rect, PixelGrid &r_pixels) {
	if (glm::ivec2(p_image->get_width(), p_image->get_height()) != r_pixels.size()) {
		return false;
	}
	const PackedByteArray bytes = p_image->get_data(); // Shares memory only during this call.
	return r_pixels.patch(rect, span_of(bytes)).ok();
}

} // namespace thicket
