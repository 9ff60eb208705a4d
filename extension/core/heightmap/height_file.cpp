#include "core/heightmap/height_file.hpp"

#include "core/base/guard.hpp"
#include "core/terrain/heightfield.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string_view>
#include <utility>

namespace thicket {

namespace {

using Bytes = std::span<const std::uint8_t>;

bool begins_with(Bytes bytes, std::string_view signature) {
	return bytes.size() >= signature.size() &&
			std::equal(signature.begin(), signature.end(), bytes.begin(),
					[](char expected, std::uint8_t byte) { return static_cast<std::uint8_t>(expected) == byte; });
}

/// Returns the edge length of the square with this area, or 0 if it is not a permitted length.
int side_of_square(std::uint64_t area) {
	if (area > std::uint64_t{max_heightfield_posts} * max_heightfield_posts) {
		return 0;
	}
	int side = 0;
	for (int step = max_heightfield_posts; step > 0; step /= 2) { // Finds the largest side that fits.
		const auto next = static_cast<std::uint64_t>(side + step);
		side += next * next <= area ? step : 0;
	}
	const auto found = static_cast<std::uint64_t>(side);
	return side >= min_heightfield_posts && found * found == area ? side : 0;
}

/// Derives the layout of a square from the size of a file. The count is 0 if no square fits.
RawLayout square_of(std::uint64_t size, int bytes_per_post) {
	// The size of a square of 16-bit integers fits neither of the other types.
	for (const int each : {2, 4, 1}) {
		const bool allowed = bytes_per_post == 0 || bytes_per_post == each;
		const int side = allowed && size % static_cast<std::uint64_t>(each) == 0
				? side_of_square(size / static_cast<std::uint64_t>(each))
				: 0;
		if (side > 0) {
			return {glm::ivec2(side), each};
		}
	}
	return {};
}

float float_at(const std::uint8_t *byte) {
	return std::bit_cast<float>(std::uint32_t{byte[0]} | std::uint32_t{byte[1]} << 8u | std::uint32_t{byte[2]} << 16u |
			std::uint32_t{byte[3]} << 24u);
}

Posts raw_posts(Bytes bytes, const RawLayout &layout) {
	const auto each = static_cast<std::size_t>(layout.bytes_per_post);
	const std::size_t count = bytes.size() / each;
	Posts posts;
	posts.count = layout.count;
	posts.format = each == 1 ? "8-bit raw" : each == 2 ? "16-bit raw" : "32-bit raw";
	posts.steps.reserve(each == 4 ? 0 : count);
	posts.floats.reserve(each == 4 ? count : 0);
	const std::uint8_t *byte = bytes.data();
	for (std::size_t post = 0; post < count; ++post, byte += each) {
		if (each == 1) {
			posts.steps.push_back(static_cast<std::uint16_t>(byte[0] * 257));
		} else if (each == 2) {
			posts.steps.push_back(static_cast<std::uint16_t>(byte[0] | byte[1] << 8));
		} else {
			posts.floats.push_back(float_at(byte));
		}
	}
	return posts;
}

Status refused_tiff(const char *property) {
	return Status::wrong_type(property,
			"TIFF files cannot be read: convert the file with gdal_translate -of PNG -ot UInt16 -scale LOWEST HIGHEST "
			"0 65535");
}

} // namespace

HeightFileKind kind_of_height_file(Bytes bytes) {
	using namespace std::string_view_literals;
	if (begins_with(bytes, "\x89PNG\r\n\x1a\n"sv)) {
		return HeightFileKind::png;
	}
	if (begins_with(bytes, "\x76\x2f\x31\x01"sv)) {
		return HeightFileKind::exr;
	}
	constexpr std::array tiff{"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv};
	const bool is_tiff = std::ranges::any_of(tiff, [bytes](std::string_view each) { return begins_with(bytes, each); });
	return is_tiff ? HeightFileKind::tiff : HeightFileKind::raw;
}

Status read_raw(Bytes bytes, const RawLayout &layout, const char *property, Posts &r_posts) {
	const bool is_tiff = kind_of_height_file(bytes) == HeightFileKind::tiff;
	RawLayout found = layout;
	if (layout.count == glm::ivec2(0)) {
		found = square_of(bytes.size(), layout.bytes_per_post);
		if (is_tiff) { // The size may match a square by chance.
			return refused_tiff(property);
		}
		if (found.count.x == 0) {
			return Status::wrong_size(property, bytes.size(), AllowedRange(),
					"No square has this number of bytes at 1, 2 or 4 bytes per height: set post_count, or use a PNG "
					"or EXR file");
		}
	} else {
		for (const int side : {layout.count.x, layout.count.y}) {
			if (side < min_heightfield_posts || side > max_heightfield_posts) {
				return Status::out_of_range("post_count", side, between(min_heightfield_posts, max_heightfield_posts));
			}
		}
		const auto count = static_cast<std::uint64_t>(layout.count.x) * static_cast<std::uint64_t>(layout.count.y);
		const std::uint64_t each = bytes.size() % count == 0 ? bytes.size() / count : 0;
		if (each != 1 && each != 2 && each != 4) {
			return is_tiff ? refused_tiff(property)
						   : Status::wrong_size(property, bytes.size(),
									 between(count, 4 * count, "bytes: 1, 2 or 4 per height of post_count"));
		}
		found.bytes_per_post = static_cast<int>(each);
	}
	return guarded(property, static_cast<double>(bytes.size()), [&] { r_posts = raw_posts(bytes, found); });
}

} // namespace thicket
