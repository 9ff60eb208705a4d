#include "nodes/ground/image_posts.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/classes/texture2d.hpp>
#include <godot_cpp/core/object.hpp>

#include <cstring>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns an uncompressed copy without mipmaps; null if the engine cannot decompress the image.
Ref<Image> plain_copy(const Ref<Image> &image) {
	Ref<Image> copy = image->duplicate();
	if (copy->is_compressed() && copy->decompress() != OK) {
		return {};
	}
	copy->clear_mipmaps();
	return copy;
}

/// Returns true for formats whose channels are floating-point numbers.
bool holds_floats(Image::Format format) {
	switch (format) {
		case Image::FORMAT_RF:
		case Image::FORMAT_RGF:
		case Image::FORMAT_RGBF:
		case Image::FORMAT_RGBAF:
		case Image::FORMAT_RH:
		case Image::FORMAT_RGH:
		case Image::FORMAT_RGBH:
		case Image::FORMAT_RGBAH:
		case Image::FORMAT_RGBE9995: return true;
		default: return false;
	}
}

/// Returns the number of color channels of a format, not counting those that a conversion to RGBA
/// would add.
int channels_of(Image::Format format) {
	switch (format) {
		case Image::FORMAT_L8:
		case Image::FORMAT_R8:
		case Image::FORMAT_RF:
		case Image::FORMAT_RH:
		case Image::FORMAT_RGTC_R:
		case Image::FORMAT_ETC2_R11: return 1;
		case Image::FORMAT_RG8:
		case Image::FORMAT_RGF:
		case Image::FORMAT_RGH:
		case Image::FORMAT_RGTC_RG:
		case Image::FORMAT_ETC2_RG11: return 2;
		case Image::FORMAT_RGB8:
		case Image::FORMAT_RGB565:
		case Image::FORMAT_RGBF:
		case Image::FORMAT_RGBH:
		case Image::FORMAT_RGBE9995:
		case Image::FORMAT_DXT1:
		case Image::FORMAT_BPTC_RGBF:
		case Image::FORMAT_BPTC_RGBFU:
		case Image::FORMAT_ETC:
		case Image::FORMAT_ETC2_RGB8: return 3;
		default: return 4;
	}
}

/// Returns the bytes per pixel of an uncompressed format; 0 for compressed and unknown formats.
std::int64_t pixel_bytes_of(Image::Format format) {
	switch (format) {
		case Image::FORMAT_L8:
		case Image::FORMAT_R8: return 1;
		case Image::FORMAT_LA8:
		case Image::FORMAT_RG8:
		case Image::FORMAT_RGBA4444:
		case Image::FORMAT_RGB565:
		case Image::FORMAT_RH: return 2;
		case Image::FORMAT_RGB8: return 3;
		case Image::FORMAT_RGBA8:
		case Image::FORMAT_RF:
		case Image::FORMAT_RGH:
		case Image::FORMAT_RGBE9995: return 4;
		case Image::FORMAT_RGBH: return 6;
		case Image::FORMAT_RGF:
		case Image::FORMAT_RGBAH: return 8;
		case Image::FORMAT_RGBF: return 12;
		case Image::FORMAT_RGBAF: return 16;
		default: return 0;
	}
}

/// Names the bits per channel of an image.
const char *format_of(const Ref<Image> &image) {
	const Image::Format format = image->get_format();
	if (image->is_compressed()) {
		return "compressed image";
	}
	switch (format) {
		case Image::FORMAT_RF:
		case Image::FORMAT_RGF:
		case Image::FORMAT_RGBF:
		case Image::FORMAT_RGBAF: return "32-bit image";
		default: break;
	}
	// The formats after the last one of Godot 4.4 are 16-bit integers.
	return holds_floats(format) || format > Image::FORMAT_ASTC_8x8_HDR ? "16-bit image" : "8-bit image";
}

std::uint16_t step_of(float unit) { return static_cast<std::uint16_t>(unit * 65535.0F + 0.5F); }

} // namespace

Ref<Image> image_of(const Ref<Resource> &p_resource) {
	if (const Ref<Texture2D> texture = p_resource; texture.is_valid()) {
		return texture->get_image();
	}
	return p_resource;
}

bool has_content(const Ref<Image> &p_image) {
	return p_image.is_valid() && p_image->get_width() > 0 && p_image->get_height() > 0;
}

Status read_posts(const Ref<Image> &p_image, const char *p_property, Posts &r_posts) {
	if (!has_content(p_image)) {
		return Status::wrong_size(p_property, 0, at_least(1, "pixels"));
	}
	const Ref<Image> image = plain_copy(p_image);
	if (image.is_null()) {
		return {ErrorCode::out_of_range, p_property, static_cast<double>(p_image->get_format()), {}, {},
				"Use an image format that the engine can decompress"};
	}
	const bool is_float = holds_floats(image->get_format());
	image->convert(Image::FORMAT_RF); // Represents 16-bit values exactly.
	const PackedByteArray bytes = image->get_data();
	Posts posts;
	posts.count = {image->get_width(), image->get_height()};
	posts.format = format_of(p_image);
	posts.floats.resize(static_cast<std::size_t>(bytes.size()) / sizeof(float));
	if (posts.floats.size() != static_cast<std::size_t>(posts.count.x) * static_cast<std::size_t>(posts.count.y)) {
		throw std::bad_alloc(); // The engine ran out of memory during the conversion.
	}
	std::memcpy(posts.floats.data(), bytes.ptr(), posts.floats.size() * sizeof(float));
	if (!is_float) {
		posts.steps.reserve(posts.floats.size());
		for (const float value : posts.floats) {
			posts.steps.push_back(step_of(value));
		}
		posts.floats = {};
	}
	r_posts = std::move(posts);
	return {};
}

bool read_region(const Ref<Image> &p_image, const PixelRect &rect, Posts &r_posts) {
	const Image::Format format = p_image->get_format();
	const std::int64_t pixel_bytes = pixel_bytes_of(format);
	if (pixel_bytes == 0) {
		return false;
	}
	const PackedByteArray image_bytes = p_image->get_data(); // Shares memory only during this call.
	const std::int64_t row_bytes = pixel_bytes * rect.size().x;
	PackedByteArray region_bytes;
	std::uint8_t *out = resize(region_bytes, row_bytes * rect.size().y).data();
	for (std::int64_t y = rect.min.y; y < rect.max.y; ++y, out += row_bytes) {
		std::memcpy(out, image_bytes.ptr() + (y * p_image->get_width() + rect.min.x) * pixel_bytes,
				static_cast<std::size_t>(row_bytes));
	}
	const Ref<Image> region = Image::create_from_data(rect.size().x, rect.size().y, false, format, region_bytes);
	return read_posts(region, "image", r_posts).ok();
}

Status read_weights(const Ref<Image> &p_image, const char *p_property, WeightMap &r_weights) {
	if (!has_content(p_image)) {
		return Status::wrong_size(p_property, 0, at_least(1, "pixels"));
	}
	const Ref<Image> image = plain_copy(p_image);
	if (image.is_null()) {
		return {ErrorCode::out_of_range, p_property, static_cast<double>(p_image->get_format()), {}, {},
				"Use an image format that the engine can decompress"};
	}
	const auto channels = static_cast<std::size_t>(channels_of(p_image->get_format()));
	image->convert(Image::FORMAT_RGBA8);
	const PackedByteArray bytes = image->get_data();
	std::vector<std::uint8_t> weights;
	weights.reserve(static_cast<std::size_t>(bytes.size()) / 4 * channels);
	for (int64_t pixel = 0; pixel + 3 < bytes.size(); pixel += 4) {
		const std::uint8_t *first = bytes.ptr() + pixel;
		weights.insert(weights.end(), first, first + channels);
	}
	return r_weights.set({image->get_width(), image->get_height()}, static_cast<int>(channels), weights);
}

} // namespace thicket
