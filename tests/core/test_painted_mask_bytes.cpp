#include "core/base/word_hash.hpp"
#include "core/rules/painted_mask.hpp"
#include "mask_fixture.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cstddef>
#include <random>
#include <span>
#include <string>
#include <vector>

using namespace thicket;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Replaces the checksum at the end of bytes that a test has changed.
Bytes with_checksum(Bytes bytes) {
	bytes.erase(bytes.end() - 8, bytes.end());
	WordHash hash;
	for (const std::uint8_t byte : bytes) {
		hash.add(std::uint32_t{byte});
	}
	for (int byte = 0; byte < 8; ++byte) {
		bytes.push_back(static_cast<std::uint8_t>(hash.value() >> 8 * byte));
	}
	return bytes;
}

/// Returns a small mask with a block of one value and a block of several values.
PaintedMask small_mask() {
	PaintedMask mask = mask_of(0.5, 0.0);
	write(mask, {{64, -128}, {128, -64}}, std::vector<std::uint8_t>(64 * 64, 9));
	write(mask, {{-5, 70}, {-2, 71}}, {1, 2, 3});
	return mask;
}

constexpr std::size_t header = 17;

/// Returns the bytes of a mask with a background of 0 and one block, which consists of `block`.
Bytes with_block(const Bytes &block) {
	Bytes bytes = mask_of(1.0, 0.0).to_bytes();
	bytes.insert(bytes.end() - 8, block.begin(), block.end());
	return with_checksum(bytes);
}

/// Checks that the bytes are rejected as corrupt, and that the mask does not change.
void check_corrupt(const Bytes &bytes) {
	PaintedMask mask = small_mask();
	const Status status = mask.from_bytes(bytes);
	REQUIRE(status.code == ErrorCode::corrupt);
	REQUIRE(std::string(status.property) == "data");
	REQUIRE(mask == small_mask());
}

} // namespace

TEST_CASE("mask bytes: a loaded mask is equal, and so are its bytes") {
	for (const PaintedMask &mask :
			{PaintedMask(), mask_of(1.0 / 64.0, 0.0), mask_of(1024.0, 0.4), small_mask(), noisy_mask(0.3, 1)}) {
		PaintedMask other = noisy_mask(1.0, 2);
		REQUIRE(other.from_bytes(mask.to_bytes()).ok());
		CHECK(other == mask);
		CHECK(other.to_bytes() == mask.to_bytes());
		CHECK(other.block_count() == mask.block_count());
		CHECK(density(other, {-1.3, 35.2}) == density(mask, {-1.3, 35.2}));
	}
}

TEST_CASE("mask bytes: a loaded mask can be painted, and blocks of one value stay independent") {
	PaintedMask mask = mask_of(1.0, 0.0);
	paint(mask, {.center = {0.0, 0.0}, .radius = 300.0, .hardness = 1.0});
	PaintedMask loaded_mask;
	REQUIRE(loaded_mask.from_bytes(mask.to_bytes()).ok());
	const Brush erase{.mode = Brush::Mode::erase, .center = {32.0, 32.0}, .radius = 20.0};
	paint(mask, erase);
	paint(loaded_mask, erase);
	CHECK(loaded_mask == mask);
	CHECK(pixel(loaded_mask, 32, 32) == 0);
	CHECK(pixel(loaded_mask, 96, 32) == 255);
}

TEST_CASE("mask bytes: equal masks have equal bytes, regardless of the painting") {
	PaintedMask original = mask_of(1.0, 0.0);
	PaintedMask restored = mask_of(1.0, 0.0);
	paint(restored, {.center = {500.0, 0.0}, .radius = 90.0});
	for (int i = 0; i < 5; ++i) {
		paint(original, {.center = {100.0 * i, -77.0}, .radius = 30.0});
		paint(restored, {.center = {100.0 * (4 - i), -77.0}, .radius = 30.0});
	}
	CHECK_FALSE(restored.to_bytes() == original.to_bytes());
	paint(restored, {.mode = Brush::Mode::erase, .center = {510.0, 0.0}, .radius = 101.0, .hardness = 1.0});
	CHECK(restored == original);
	CHECK(restored.to_bytes() == original.to_bytes());
}

TEST_CASE("mask bytes: blocks of one value take few bytes") {
	PaintedMask mask = mask_of(1.0, 0.0);
	const std::size_t empty = mask.to_bytes().size();
	CHECK(empty == 25);
	write(mask, {{-640, -640}, {640, 640}}, std::vector<std::uint8_t>(1280 * 1280, 255));
	CHECK(mask.block_count() == 400);
	CHECK(mask.to_bytes().size() == empty + 400 * 10);
}

TEST_CASE("mask bytes: the format is unchanged") {
	PaintedMask mask = mask_of(0.5, 0.2);
	write(mask, {{-64, 128}, {0, 192}}, std::vector<std::uint8_t>(64 * 64, 7));
	const Bytes expected{'T', 'M', 'S', 'K', 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xe0, 0x3f, 51, // Header.
			2, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 7, // Row 2, column -1, one value, 7.
			0, 0, 0, 0, 0, 0, 0, 0};
	CHECK(mask.to_bytes() == with_checksum(expected));
	// A test value of FNV-1a from the list that its authors published.
	WordHash hash;
	for (const char letter : std::string("foobar")) {
		hash.add(static_cast<std::uint32_t>(letter));
	}
	CHECK(hash.value() == 0x85944171f73967e8);
}

TEST_CASE("mask bytes: every truncation is rejected") {
	const Bytes bytes = small_mask().to_bytes();
	for (std::size_t size = 0; size < bytes.size(); ++size) {
		check_corrupt({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
	}
	Bytes longer = bytes;
	longer.push_back(0);
	check_corrupt(longer);
}

TEST_CASE("mask bytes: every change to a single byte is rejected") {
	PaintedMask mask = mask_of(0.5, 0.0);
	write(mask, {{64, -128}, {128, -64}}, std::vector<std::uint8_t>(64 * 64, 9));
	const Bytes bytes = mask.to_bytes();
	for (std::size_t offset = 0; offset < bytes.size(); ++offset) {
		for (int change = 1; change < 256; ++change) {
			Bytes bad = bytes;
			bad[offset] = static_cast<std::uint8_t>(bad[offset] ^ change);
			const Status status = mask.from_bytes(bad);
			const bool version = offset >= 4 && offset < 8;
			REQUIRE(status.code == (version ? ErrorCode::out_of_range : ErrorCode::corrupt));
		}
	}
	const Bytes large = small_mask().to_bytes();
	for (std::size_t offset = 0; offset < large.size(); ++offset) {
		Bytes bad = large;
		bad[offset] ^= 0x10;
		REQUIRE_FALSE(mask.from_bytes(bad).ok());
	}
	CHECK(mask.to_bytes() == bytes);
}

TEST_CASE("mask bytes: the error names a later version") {
	Bytes bytes = small_mask().to_bytes();
	bytes[4] = 2;
	PaintedMask mask = small_mask();
	check_refused(mask.from_bytes(with_checksum(bytes)), ErrorCode::out_of_range, "version", 2.0);
	CHECK(mask == small_mask());
}

TEST_CASE("mask bytes: invalid content with a valid checksum is rejected") {
	const Bytes bytes = small_mask().to_bytes(); // A block of one value at (-2, 1), and a block at (1, -1).
	constexpr std::size_t uniform_size = 10;
	REQUIRE(bytes.size() == header + uniform_size + 9 + 64 * 64 + 8);
	const auto changed_byte = [&](std::size_t offset, std::uint8_t value) {
		Bytes bad = bytes;
		bad[offset] = value;
		return with_checksum(bad);
	};
	check_corrupt(changed_byte(15, 0x41));         // The pixel size becomes 2^17 m.
	check_corrupt(changed_byte(15, 0xbf));         // The pixel size becomes -0.5 m.
	check_corrupt(changed_byte(header + 3, 0x7f)); // A row out of range.
	check_corrupt(changed_byte(header + 7, 0x7f)); // A column out of range.
	check_corrupt(changed_byte(header + 8, 2));    // An unknown kind of block.
	// The kind with all pixels, which leaves too few bytes for the next block.
	check_corrupt(changed_byte(header + 8, 1));
	check_corrupt(changed_byte(header + 9, 0));                // A block that is all background.
	check_corrupt(changed_byte(header + uniform_size + 8, 0)); // One value, followed by bytes that are not a block.

	// Blocks out of order, and a repeated block.
	Bytes swapped(bytes.begin(), bytes.begin() + header);
	swapped.insert(swapped.end(), bytes.begin() + header + uniform_size, bytes.end() - 8);
	swapped.insert(swapped.end(), bytes.begin() + header, bytes.begin() + header + uniform_size);
	swapped.resize(swapped.size() + 8);
	check_corrupt(with_checksum(swapped));
	Bytes twice(bytes.begin(), bytes.begin() + header + uniform_size);
	twice.insert(twice.end(), bytes.begin() + header, bytes.end());
	check_corrupt(with_checksum(twice));

	// A block of one value that is stored with all its pixels.
	Bytes spelled_out = with_block({0, 0, 0, 0, 0, 0, 0, 0, 1});
	spelled_out.insert(spelled_out.end() - 8, 64 * 64, 5);
	check_corrupt(with_checksum(spelled_out));
}

TEST_CASE("mask bytes: blocks reach the end of the plane and no farther") {
	// The plane extends to 2^30 pixels. Its last block has the number 2^24 - 1, its first one
	// -2^24.
	for (const int flip : {0x00, 0xff}) {
		const auto byte = [flip](int value) {
			return static_cast<std::uint8_t>(value ^ flip);
		};
		const Bytes inside{byte(255), byte(255), byte(255), byte(0)};
		const Bytes outside{byte(0), byte(0), byte(0), byte(1)};
		const auto block = [](Bytes row, const Bytes &column) {
			row.insert(row.end(), column.begin(), column.end());
			row.insert(row.end(), {0, 7});
			return row;
		};
		PaintedMask mask;
		CHECK(mask.from_bytes(with_block(block(inside, inside))).ok());
		const int last = flip ? -PaintedMask::pixel_limit : PaintedMask::pixel_limit - 1;
		CHECK(pixel(mask, last, last) == 7);
		check_corrupt(with_block(block(outside, inside)));
		check_corrupt(with_block(block(inside, outside)));
	}
}

TEST_CASE("mask bytes: truncated bytes are rejected, even with a valid checksum, unless whole blocks remain") {
	const Bytes bytes = small_mask().to_bytes();
	const std::size_t content = bytes.size() - 8;
	for (std::size_t size = 8; size < content; ++size) {
		Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size) + 8);
		if (size == header || size == header + 10) {
			PaintedMask mask;
			CHECK(mask.from_bytes(with_checksum(cut)).ok());
			CHECK(mask.block_count() == (size - header) / 10);
		} else {
			check_corrupt(with_checksum(cut));
		}
	}
}
