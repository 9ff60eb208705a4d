// LodePNG reads the file and leaves the pixels in the format of the file. They are converted here,
// because LodePNG would mix the channels of a color image.

#include "core/base/guard.hpp"
#include "core/heightmap/height_file.hpp"
#include "core/terrain/heightfield.hpp"

#include <lodepng.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>
#include <utility>

namespace thicket {

namespace {

struct Free {
	void operator()(void *memory) const { std::free(memory); } // NOLINT(*-no-malloc): LodePNG allocates with malloc.
};
using Pixels = std::unique_ptr<unsigned char, Free>;

/// The largest ratio of inflated to deflated bytes.
constexpr std::uint64_t max_deflate_ratio = 1032;

// Two of LodePNG's error codes.
constexpr unsigned out_of_memory = 83;
constexpr unsigned too_few_pixels = 91;

Status status_of(unsigned error, const char *property) {
	constexpr std::array truncated{10u, 23u, 27u, 30u, 49u, 50u, 51u, 52u, 53u, 64u, too_few_pixels};
	if (error == out_of_memory) {
		return {ErrorCode::out_of_memory, property, 0.0};
	}
	for (const unsigned each : truncated) {
		if (error == each) {
			return {ErrorCode::corrupt, property, 0.0, {}, {}, "The PNG file ends too early: save or copy it again"};
		}
	}
	return {ErrorCode::corrupt, property, 0.0, {}, {}, "The PNG file is damaged: save or copy it again"};
}

/// Rejects files that have no heights or are too small to contain all their pixels.
Status check_header(glm::uvec2 size, const LodePNGColorMode &color, std::size_t bytes, const char *property) {
	for (const unsigned side : {size.x, size.y}) {
		if (side < min_heightfield_posts || side > max_heightfield_posts) {
			return Status::out_of_range(property, side,
					between(min_heightfield_posts, max_heightfield_posts, "pixels along an edge of the PNG file"),
					"Scale or crop the image");
		}
	}
	if (color.colortype == LCT_PALETTE) {
		return Status::wrong_type(property, "The PNG file has a palette: save it as grayscale with 16 bits");
	}
	const std::uint64_t bits = std::uint64_t{size.x} * size.y * lodepng_get_bpp(&color);
	return bits / 8 > max_deflate_ratio * bytes ? status_of(too_few_pixels, property) : Status();
}

const char *format_of(unsigned bits) {
	switch (bits) {
		case 1: return "1-bit PNG";
		case 2: return "2-bit PNG";
		case 4: return "4-bit PNG";
		case 8: return "8-bit PNG";
		default: return "16-bit PNG";
	}
}

/// Converts the first channel. `bits` is the size of a channel: 16 or 8, or less if there is a
/// single channel.
void convert(const unsigned char *pixels, unsigned bits, unsigned channels, std::span<std::uint16_t> r_steps) {
	if (bits == 16) {
		for (std::uint16_t &step : r_steps) {
			step = static_cast<std::uint16_t>(pixels[0] << 8 | pixels[1]);
			pixels += std::size_t{2} * channels;
		}
		return;
	}
	if (bits == 8) {
		for (std::uint16_t &step : r_steps) {
			step = static_cast<std::uint16_t>(pixels[0] * 257);
			pixels += channels;
		}
		return;
	}
	const unsigned largest = (1u << bits) - 1; // Divides 65535.
	std::size_t bit = 0;
	for (std::uint16_t &step : r_steps) {
		const unsigned value = static_cast<unsigned>(pixels[bit / 8]) >> (8 - bits - bit % 8) & largest;
		step = static_cast<std::uint16_t>(value * (65535 / largest));
		bit += bits;
	}
}

Status read(std::span<const std::uint8_t> bytes, const char *property, Posts &r_posts) {
	lodepng::State state;
	glm::uvec2 size{0};
	if (const unsigned error = lodepng_inspect(&size.x, &size.y, &state, bytes.data(), bytes.size()); error != 0) {
		return status_of(error, property);
	}
	const LodePNGColorMode &color = state.info_png.color;
	if (const Status refused = check_header(size, color, bytes.size(), property); !refused.ok()) {
		return refused;
	}
	const unsigned bits = color.bitdepth;
	const unsigned channels = lodepng_get_channels(&color);
	const std::uint64_t count = std::uint64_t{size.x} * size.y;
	// Each row of a pass may have an incomplete byte and has one byte for its filter. All passes
	// together have up to twice as many rows.
	const std::uint64_t inflated = count * bits * channels / 8 + std::uint64_t{size.y} * 4 + 64;
	state.decoder.zlibsettings.max_output_size =
			static_cast<std::size_t>(std::min<std::uint64_t>(inflated, std::numeric_limits<std::size_t>::max()));
	state.decoder.color_convert = 0;
	unsigned char *decoded = nullptr;
	const unsigned error = lodepng_decode(&decoded, &size.x, &size.y, &state, bytes.data(), bytes.size());
	const Pixels pixels(decoded);
	if (error != 0) {
		return status_of(error, property);
	}
	Posts posts;
	posts.count = glm::ivec2(size);
	posts.format = format_of(bits);
	posts.steps.resize(static_cast<std::size_t>(count));
	convert(pixels.get(), bits, channels, posts.steps);
	r_posts = std::move(posts);
	return {};
}

} // namespace

Status read_png(std::span<const std::uint8_t> bytes, const char *property, Posts &r_posts) {
	return guarded(property, static_cast<double>(bytes.size()), [&] { return read(bytes, property, r_posts); });
}

} // namespace thicket
