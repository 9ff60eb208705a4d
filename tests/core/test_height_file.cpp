#include "core/heightmap/height_file.hpp"
#include "png_writer.hpp"
#include "refusal.hpp"

#include "core/terrain/heightfield.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <set>
#include <string>
#include <vector>

using namespace thicket;
using png::Layout;
using png::Stored;

namespace {

constexpr const char *property = "heightmap_path";

/// A value that depends on all coordinates, with all bits of a channel.
unsigned value_at(glm::ivec2 pixel, int channel, int bits) {
	const auto mixed = static_cast<unsigned>(pixel.x * 40503 + pixel.y * 30011 + channel * 9973);
	return (mixed ^ mixed >> 7u) & ((1u << static_cast<unsigned>(bits)) - 1);
}

Stored file_of(const Layout &layout) {
	return png::file_of(layout, [&](glm::ivec2 pixel, int channel) { return value_at(pixel, channel, layout.bits); });
}

void check_read(const Layout &layout) {
	CAPTURE(layout.color_type);
	CAPTURE(layout.bits);
	CAPTURE(layout.interlaced);
	CAPTURE(layout.size.x);
	CAPTURE(layout.size.y);
	Posts posts;
	const Status status = read_png(file_of(layout), property, posts);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	REQUIRE(posts.count == layout.size);
	CHECK(posts.format == std::to_string(layout.bits) + "-bit PNG");
	CHECK(posts.floats.empty());
	const unsigned largest = (1u << static_cast<unsigned>(layout.bits)) - 1;
	std::size_t wrong_count = 0;
	for (glm::ivec2 pixel{0}; pixel.y < layout.size.y; ++pixel.y) {
		for (pixel.x = 0; pixel.x < layout.size.x; ++pixel.x) {
			const std::size_t index = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(layout.size.x) +
					static_cast<std::size_t>(pixel.x);
			wrong_count += posts.steps[index] == value_at(pixel, 0, layout.bits) * (65535 / largest) ? 0 : 1;
		}
	}
	CHECK(wrong_count == 0);
}

constexpr std::array<std::array<int, 2>, 11> types{
		{{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {4, 8}, {4, 16}, {6, 8}, {6, 16}}};

Posts read_raw_bytes(std::size_t size, const RawLayout &layout) {
	Posts posts;
	const Status status = read_raw(Stored(size), layout, property, posts);
	CHECK_MESSAGE(status.ok(), describe(status));
	return posts;
}

} // namespace

TEST_CASE("height file: PNG files of all types have the first channel's heights") {
	for (const auto &[color_type, bits] : types) {
		for (const bool interlaced : {false, true}) {
			for (const glm::ivec2 size : {glm::ivec2(2, 2), glm::ivec2(3, 5), glm::ivec2(7, 2), glm::ivec2(33, 40)}) {
				check_read({size, color_type, bits, interlaced});
			}
		}
	}
}

TEST_CASE("height file: a 16-bit PNG preserves all 65,536 heights") {
	for (const bool interlaced : {false, true}) {
		const Stored file = png::file_of({{256, 256}, 0, 16, interlaced},
				[](glm::ivec2 pixel, int) { return static_cast<unsigned>(pixel.y * 256 + pixel.x); });
		Posts posts;
		REQUIRE(read_png(file, property, posts).ok());
		CHECK(std::set<std::uint16_t>(posts.steps.begin(), posts.steps.end()).size() == 65536);
		CHECK(std::ranges::is_sorted(posts.steps));
	}
}

TEST_CASE("height file: a PNG file that is truncated anywhere is rejected") {
	for (const bool interlaced : {false, true}) {
		const Stored file = file_of({{5, 4}, 2, 16, interlaced});
		for (std::size_t size = 8; size < file.size(); ++size) {
			CAPTURE(size);
			Posts posts;
			posts.format = "before";
			const Status status = read_png({file.data(), size}, property, posts);
			check_refused(status, ErrorCode::corrupt, property, 0.0);
			CHECK(describe(status).find("ends too early") != std::string::npos);
			CHECK(posts.format == std::string("before"));
		}
	}
}

TEST_CASE("height file: PNG files with too few or too many rows are rejected") {
	const Layout layout{{16, 16}, 0, 16, false};
	const Stored rows = png::rows_of(layout, [](glm::ivec2, int) { return 1000u; });
	Posts posts;
	REQUIRE(read_png(png::file_of(layout, rows), property, posts).ok());
	Stored few_rows(rows.begin(), rows.end() - 1);
	CHECK(read_png(png::file_of(layout, few_rows), property, posts).code == ErrorCode::corrupt);
	Stored many_rows = rows;
	many_rows.resize(rows.size() + 1000);
	CHECK(read_png(png::file_of(layout, many_rows), property, posts).code == ErrorCode::corrupt);
	Stored no_filter = rows;
	no_filter[0] = 9;
	const Status status = read_png(png::file_of(layout, no_filter), property, posts);
	check_refused(status, ErrorCode::corrupt, property, 0.0);
	CHECK(describe(status).find("is damaged") != std::string::npos);
}

TEST_CASE("height file: PNG files with a palette are rejected") {
	Posts posts;
	const Status status = read_png(file_of({{4, 4}, 3, 8, false}), property, posts);
	check_refused(status, ErrorCode::wrong_type, property, 0.0);
	CHECK(describe(status).find("palette") != std::string::npos);
}

TEST_CASE("height file: PNG files of unsuitable size are rejected before they are inflated") {
	Posts posts;
	check_refused(read_png(file_of({{1, 4}, 0, 8, false}), property, posts), ErrorCode::out_of_range, property, 1);
	const Stored wide = png::file_of({{32769, 2}, 0, 16, false}, Stored(4));
	check_refused(read_png(wide, property, posts), ErrorCode::out_of_range, property, 32769);
	const Stored huge = png::file_of({{4, 0x7fffffff}, 0, 16, false}, Stored(4));
	check_refused(read_png(huge, property, posts), ErrorCode::out_of_range, property, 0x7fffffff);
	// Inflating this image would need 8 GB.
	const Stored empty = png::file_of({{32768, 32768}, 6, 16, false}, Stored(1000));
	check_refused(read_png(empty, property, posts), ErrorCode::corrupt, property, 0);
}

TEST_CASE("height file: the size of a raw square determines its count and depth") {
	for (const int side : {2, 3, 129, 512, 513, 1025}) {
		CAPTURE(side);
		const auto area = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
		const Posts words = read_raw_bytes(2 * area, {});
		CHECK(words.count == glm::ivec2(side));
		CHECK(words.format == std::string("16-bit raw"));
		CHECK(words.steps.size() == area);
		const Posts floats = read_raw_bytes(4 * area, {});
		CHECK(floats.count == glm::ivec2(side));
		CHECK(floats.format == std::string("32-bit raw"));
		CHECK(floats.floats.size() == area);
		const Posts bytes = read_raw_bytes(area, {{0, 0}, 1});
		CHECK(bytes.count == glm::ivec2(side));
		CHECK(bytes.format == std::string("8-bit raw"));
		CHECK(bytes.steps.size() == area);
	}
	CHECK(read_raw_bytes(9, {}).format == std::string("8-bit raw"));
	CHECK(read_raw_bytes(4 * 16, {{0, 0}, 1}).count == glm::ivec2(8));
	CHECK(read_raw_bytes(4 * 16, {{0, 0}, 4}).count == glm::ivec2(4));
	CHECK(read_raw_bytes(4 * 16, {{4, 8}, 4}).format == std::string("16-bit raw")); // The count takes priority.
}

TEST_CASE("height file: raw values are little-endian") {
	Posts posts;
	REQUIRE(read_raw(Stored{0x34, 0x12, 0xff, 0xff, 0, 0, 1, 0}, {}, property, posts).ok());
	CHECK(posts.steps == std::vector<std::uint16_t>{0x1234, 0xffff, 0, 1});
	Stored file;
	for (const float value : {1.5F, -2.25F, 1e6F, 0.0F}) {
		const auto bits = std::bit_cast<std::uint32_t>(value);
		for (unsigned shift = 0; shift < 32; shift += 8) {
			file.push_back(static_cast<std::uint8_t>(bits >> shift));
		}
	}
	REQUIRE(read_raw(file, {}, property, posts).ok());
	CHECK(posts.floats == std::vector<float>{1.5F, -2.25F, 1e6F, 0.0F});
	REQUIRE(read_raw(Stored{0, 1, 128, 255, 3, 4}, {{3, 2}, 0}, property, posts).ok());
	CHECK(posts.steps == std::vector<std::uint16_t>{0, 257, 32896, 65535, 771, 1028});
}

TEST_CASE("height file: raw files that match neither a square nor the specified count are rejected") {
	Posts posts;
	for (const std::size_t size : {0, 1, 2, 10, 22, 4 * 12}) {
		const Status status = read_raw(Stored(size), {}, property, posts);
		check_refused(status, ErrorCode::wrong_size, property, static_cast<double>(size));
		CHECK(describe(status).find("post_count") != std::string::npos);
	}
	CHECK(read_raw(Stored(16), {{0, 0}, 2}, property, posts).code == ErrorCode::wrong_size);
	CHECK(read_raw(Stored(22), {{4, 3}, 0}, property, posts).code == ErrorCode::wrong_size);
	CHECK(read_raw(Stored(), {{4, 3}, 0}, property, posts).code == ErrorCode::wrong_size);
	check_refused(read_raw(Stored(22), {{4, 1}, 0}, property, posts), ErrorCode::out_of_range, "post_count", 1);
	check_refused(read_raw(Stored(22), {{32769, 9}, 0}, property, posts), ErrorCode::out_of_range, "post_count", 32769);
}

TEST_CASE("height file: the error for a TIFF file explains how to convert it") {
	for (const std::array<std::uint8_t, 4> &start : {std::array<std::uint8_t, 4>{'I', 'I', '*', 0},
				 std::array<std::uint8_t, 4>{'M', 'M', 0, '*'}, std::array<std::uint8_t, 4>{'I', 'I', '+', 0}}) {
		Stored file(32);
		std::ranges::copy(start, file.begin());
		CHECK(kind_of_height_file(file) == HeightFileKind::tiff);
		Posts posts;
		for (const glm::ivec2 count : {glm::ivec2(0), glm::ivec2(5, 5)}) {
			const Status status = read_raw(file, {count, 0}, property, posts);
			check_refused(status, ErrorCode::wrong_type, property, 0.0);
			CHECK(describe(status).find("gdal_translate") != std::string::npos);
		}
		CHECK(read_raw(file, {{4, 4}, 0}, property, posts).ok()); // The user has specified a raw file of this size.
	}
}

TEST_CASE("height file: the first bytes of a file determine its format") {
	CHECK(kind_of_height_file(file_of({{2, 2}, 0, 8, false})) == HeightFileKind::png);
	CHECK(kind_of_height_file(Stored{0x76, 0x2f, 0x31, 0x01, 2}) == HeightFileKind::exr);
	CHECK(kind_of_height_file(Stored{0x76, 0x2f}) == HeightFileKind::raw);
	CHECK(kind_of_height_file(Stored{}) == HeightFileKind::raw);
}
