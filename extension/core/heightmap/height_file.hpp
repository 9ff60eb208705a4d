#pragma once

#include "core/base/status.hpp"
#include "core/heightmap/posts.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// The kinds of height files, identified by their first bytes. All other files are raw.
enum class HeightFileKind : std::uint8_t { raw, png, exr, tiff };

HeightFileKind kind_of_height_file(std::span<const std::uint8_t> bytes);

/// The layout of a raw file: little-endian height samples in row-major order, without a header.
struct RawLayout {
	/// Columns and rows, or (0, 0) for a square whose size is derived from the size of the file.
	glm::ivec2 count{0};
	/// 1 or 2 for unsigned integers, 4 for floats, 0 if unknown. Ignored if `count` is set, because
	/// the size of the file then determines it.
	int bytes_per_post = 0;
};

/// Reads the height samples of a raw file. If a square fits both as 8-bit integers and as floats,
/// reads floats. Errors name `property`, which must be a string literal.
Status read_raw(std::span<const std::uint8_t> bytes, const RawLayout &layout, const char *property, Posts &r_posts);

/// Reads the first channel of a PNG file at full precision. Integers of fewer than 16 bits are
/// scaled so that the largest value becomes 65535. Files with a palette are an error. Errors name
/// `property`, which must be a string literal.
Status read_png(std::span<const std::uint8_t> bytes, const char *property, Posts &r_posts);

} // namespace thicket
