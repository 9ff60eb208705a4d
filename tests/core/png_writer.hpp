#pragma once

// Writes PNG files of all types, for tests of the reader. The data is not compressed, and the
// rows use all five filters in turn.

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <vector>

namespace thicket::png {

using Stored = std::vector<std::uint8_t>;

struct Layout {
	glm::ivec2 size{1};
	int color_type = 0; ///< 0 gray, 2 RGB, 3 palette, 4 gray and alpha, 6 RGBA.
	int bits = 16;      ///< Bits per channel.
	bool interlaced = false;

	int channels() const { return std::array{1, 0, 3, 1, 2, 0, 4}[static_cast<std::size_t>(color_type)]; }
};

/// Returns the value of a channel of a pixel.
using Values = std::function<unsigned(glm::ivec2 pixel, int channel)>;

inline void append_big(Stored &r_bytes, std::uint32_t number) {
	for (int shift = 24; shift >= 0; shift -= 8) {
		r_bytes.push_back(static_cast<std::uint8_t>(number >> shift));
	}
}

inline std::uint32_t crc_of(const std::uint8_t *bytes, std::size_t size) {
	std::uint32_t crc = ~0u;
	for (std::size_t i = 0; i < size; ++i) {
		crc ^= bytes[i];
		for (int bit = 0; bit < 8; ++bit) {
			crc = crc >> 1u ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
		}
	}
	return ~crc;
}

inline void append_chunk(Stored &r_file, std::string_view type, const Stored &data) {
	append_big(r_file, static_cast<std::uint32_t>(data.size()));
	const std::size_t start = r_file.size();
	r_file.insert(r_file.end(), type.begin(), type.end());
	r_file.insert(r_file.end(), data.begin(), data.end());
	append_big(r_file, crc_of(r_file.data() + start, r_file.size() - start));
}

/// Returns a zlib stream of stored blocks.
inline Stored zlib_of(const Stored &data) {
	Stored stream{0x78, 0x01};
	std::uint32_t a = 1;
	std::uint32_t b = 0;
	for (std::size_t first = 0; first < data.size() || first == 0; first += 65535) {
		const std::size_t size = std::min<std::size_t>(65535, data.size() - first);
		stream.push_back(first + size == data.size() ? 1 : 0);
		for (const std::size_t number : {size, ~size}) {
			stream.push_back(static_cast<std::uint8_t>(number));
			stream.push_back(static_cast<std::uint8_t>(number >> 8u));
		}
		for (std::size_t i = first; i < first + size; ++i) {
			stream.push_back(data[i]);
			a = (a + data[i]) % 65521;
			b = (b + a) % 65521;
		}
	}
	append_big(stream, b << 16u | a);
	return stream;
}

inline std::uint8_t predicted(int filter, int left, int above, int corner) {
	const int sum = left + above - corner;
	const int paeth = std::abs(sum - left) <= std::abs(sum - above) && std::abs(sum - left) <= std::abs(sum - corner)
			? left
			: std::abs(sum - above) <= std::abs(sum - corner) ? above
															  : corner;
	return static_cast<std::uint8_t>(
			std::array{0, left, above, (left + above) / 2, paeth}[static_cast<std::size_t>(filter)]);
}

/// Appends the filtered rows of the pixels first, first + step, ...
inline void append_pass(Stored &r_rows, const Layout &layout, const Values &values, glm::ivec2 first, glm::ivec2 step) {
	if (first.x >= layout.size.x) {
		return;
	}
	const auto pixel_bytes = static_cast<std::size_t>(std::max(1, layout.bits * layout.channels() / 8));
	Stored above;
	int filter = 0;
	for (glm::ivec2 pixel = first; pixel.y < layout.size.y; pixel.y += step.y) {
		Stored row;
		int bit = 0;
		for (pixel.x = first.x; pixel.x < layout.size.x; pixel.x += step.x) {
			for (int channel = 0; channel < layout.channels(); ++channel) {
				const unsigned value = values(pixel, channel);
				for (int shift = layout.bits - 1; shift >= 0; --shift, ++bit) {
					if (bit % 8 == 0) {
						row.push_back(0);
					}
					row.back() = static_cast<std::uint8_t>(row.back() | (value >> shift & 1u) << (7 - bit % 8));
				}
			}
		}
		above.resize(row.size());
		r_rows.push_back(static_cast<std::uint8_t>(filter));
		for (std::size_t i = 0; i < row.size(); ++i) {
			const bool has_left = i >= pixel_bytes;
			r_rows.push_back(static_cast<std::uint8_t>(row[i] -
					predicted(filter, has_left ? row[i - pixel_bytes] : 0, above[i],
							has_left ? above[i - pixel_bytes] : 0)));
		}
		above = row;
		filter = (filter + 1) % 5;
	}
}

inline Stored rows_of(const Layout &layout, const Values &values) {
	Stored rows;
	if (!layout.interlaced) {
		append_pass(rows, layout, values, {0, 0}, {1, 1});
		return rows;
	}
	const std::array<std::array<int, 4>, 7> passes{
			{{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}}};
	for (const auto &[x, y, across, down] : passes) {
		append_pass(rows, layout, values, {x, y}, {across, down});
	}
	return rows;
}

inline Stored header_of(const Layout &layout) {
	Stored header;
	append_big(header, static_cast<std::uint32_t>(layout.size.x));
	append_big(header, static_cast<std::uint32_t>(layout.size.y));
	for (const int byte : {layout.bits, layout.color_type, 0, 0, layout.interlaced ? 1 : 0}) {
		header.push_back(static_cast<std::uint8_t>(byte));
	}
	return header;
}

/// Returns the bytes of a file whose image data, after inflating, are `rows`.
inline Stored file_of(const Layout &layout, const Stored &rows) {
	Stored file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
	append_chunk(file, "IHDR", header_of(layout));
	append_chunk(file, "tEXt", Stored{'a', 0, 'b'});
	if (layout.color_type == 3) {
		append_chunk(file, "PLTE", Stored(static_cast<std::size_t>(3) << std::min(layout.bits, 8), 7));
	}
	const Stored stream = zlib_of(rows);
	const auto half = static_cast<std::ptrdiff_t>(stream.size() / 2); // The data may be divided anywhere.
	append_chunk(file, "IDAT", Stored(stream.begin(), stream.begin() + half));
	append_chunk(file, "IDAT", Stored(stream.begin() + half, stream.end()));
	append_chunk(file, "IEND", {});
	return file;
}

inline Stored file_of(const Layout &layout, const Values &values) { return file_of(layout, rows_of(layout, values)); }

} // namespace thicket::png
