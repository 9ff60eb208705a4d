#include "core/terrain/pixel_grid.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

using namespace thicket;

namespace {

using Bytes = std::vector<std::uint8_t>;

SharedBytes shared(const std::shared_ptr<Bytes> &bytes) { return {bytes, *bytes}; }

/// On both axes, larger than a block and not a multiple of its size.
const glm::ivec2 size{300, 200};
constexpr int pixel_bytes = 3;

std::shared_ptr<Bytes> random_bytes(unsigned seed) {
	auto bytes = std::make_shared<Bytes>(static_cast<std::size_t>(size.x) * size.y * pixel_bytes);
	std::mt19937 random(seed);
	for (std::uint8_t &byte : *bytes) {
		byte = static_cast<std::uint8_t>(random());
	}
	return bytes;
}

PixelGrid grid_of(const std::shared_ptr<Bytes> &bytes) {
	PixelGrid grid;
	REQUIRE(grid.set(size, pixel_bytes, shared(bytes)).ok());
	return grid;
}

bool same_pixels(const PixelGrid &grid, const Bytes &bytes) {
	for (int row = 0; row < size.y; ++row) {
		for (int column = 0; column < size.x; ++column) {
			const std::size_t at = (static_cast<std::size_t>(row) * size.x + column) * pixel_bytes;
			if (!std::equal(grid.pixel(column, row), grid.pixel(column, row) + pixel_bytes, bytes.data() + at)) {
				return false;
			}
		}
	}
	return true;
}

/// Copies the pixels of `rect` from `image` to `bytes`, the expected content.
void paint(Bytes &bytes, const PixelRect &rect, const Bytes &image) {
	for (int row = rect.min.y; row < rect.max.y; ++row) {
		const std::ptrdiff_t at = (static_cast<std::ptrdiff_t>(row) * size.x + rect.min.x) * pixel_bytes;
		std::copy_n(image.begin() + at, rect.size().x * pixel_bytes, bytes.begin() + at);
	}
}

} // namespace

TEST_CASE("pixel grid: shares bytes until it is patched, and patches like an image") {
	const auto bytes = random_bytes(1);
	const PixelGrid first = grid_of(bytes);
	CHECK(first.pixel(0, 0) == bytes->data()); // The grid has not copied the bytes.
	CHECK(same_pixels(first, *bytes));
	PixelGrid patched = first;
	Bytes painted = *bytes;
	std::mt19937 random(2);
	for (int i = 0; i < 40; ++i) {
		const glm::ivec2 min{static_cast<int>(random() % 299), static_cast<int>(random() % 199)};
		const glm::ivec2 max_offset = size - min;
		const PixelRect rect{min, min + 1 + glm::ivec2(random() % max_offset.x, random() % max_offset.y)};
		const auto other = random_bytes(100 + static_cast<unsigned>(i));
		REQUIRE(patched.patch(rect, *other).ok());
		paint(painted, rect, *other);
		CHECK(same_pixels(patched, painted));
	}
	CHECK(same_pixels(first, *bytes)); // The patched copy has not changed the original.
}

TEST_CASE("pixel grid: keeps shared bytes alive") {
	auto bytes = random_bytes(3);
	const std::weak_ptr<Bytes> watched = bytes;
	PixelGrid grid = grid_of(bytes);
	bytes.reset();
	CHECK_FALSE(watched.expired());
	grid = {};
	CHECK(watched.expired());
}

TEST_CASE("pixel grid: finds the rectangle of different pixels") {
	const auto bytes = random_bytes(4);
	const PixelGrid before = grid_of(bytes);
	CHECK(before.difference(before).empty());
	// The memory differs, but the pixels are the same.
	CHECK(before.difference(grid_of(std::make_shared<Bytes>(*bytes))).empty());
	std::mt19937 random(5);
	for (int i = 0; i < 60; ++i) {
		auto changed_bytes = std::make_shared<Bytes>(*bytes);
		PixelRect expected{size, glm::ivec2(0)};
		PixelGrid patched = before;
		for (unsigned pixel = 0; pixel < 1 + random() % 4; ++pixel) {
			const glm::ivec2 at{static_cast<int>(random() % 300), static_cast<int>(random() % 200)};
			const std::size_t byte = (static_cast<std::size_t>(at.y) * size.x + at.x) * pixel_bytes + random() % 3;
			(*changed_bytes)[byte] = static_cast<std::uint8_t>((*bytes)[byte] + 1);
			REQUIRE(patched.patch({at, at + 1}, *changed_bytes).ok());
			expected = {glm::min(expected.min, at), glm::max(expected.max, at + 1)};
		}
		CHECK(grid_of(changed_bytes).difference(before) == expected);
		CHECK(before.difference(patched) == expected);
		CHECK(patched.difference(grid_of(changed_bytes)).empty());
	}
	// The last pixel is in a block within the rectangle around the first two, so that block is not
	// searched.
	const auto corners = std::make_shared<Bytes>(*bytes);
	for (const glm::ivec2 at : {glm::ivec2(299, 0), glm::ivec2(0, 199), glm::ivec2(200, 150)}) {
		(*corners)[(static_cast<std::size_t>(at.y) * size.x + at.x) * pixel_bytes] ^= 1;
	}
	CHECK(grid_of(corners).difference(before) == PixelRect{glm::ivec2(0), size});
	PixelGrid other;
	REQUIRE(other.set({200, 300}, pixel_bytes, shared(bytes)).ok());
	CHECK(other.difference(before) == PixelRect{glm::ivec2(0), glm::ivec2(300)});
}

TEST_CASE("pixel grid: bytes that do not fit are rejected, and the grid stays unchanged") {
	const auto bytes = random_bytes(6);
	PixelGrid grid = grid_of(bytes);
	CHECK_FALSE(grid.set({0, 5}, 1, shared(bytes)).ok());
	CHECK_FALSE(grid.set({5, PixelGrid::max_side + 1}, 1, shared(bytes)).ok());
	CHECK_FALSE(grid.set({5, 5}, 0, shared(bytes)).ok());
	CHECK_FALSE(grid.set({5, 5}, PixelGrid::max_pixel_bytes + 1, shared(bytes)).ok());
	CHECK(grid.set({300, 201}, 3, shared(bytes)).code == ErrorCode::wrong_size);
	const Bytes black(bytes->size());
	CHECK_FALSE(grid.patch({{5, 5}, {5, 6}}, black).ok());
	CHECK_FALSE(grid.patch({{-1, 5}, {0, 6}}, black).ok());
	CHECK_FALSE(grid.patch({{300, 5}, {301, 6}}, black).ok());
	CHECK(grid.patch({{5, 5}, {6, 7}}, std::span(black).first(black.size() - 1)).code == ErrorCode::wrong_size);
	CHECK_FALSE(PixelGrid().patch({{0, 0}, {1, 1}}, black).ok());
	CHECK(same_pixels(grid, *bytes));
}

#if __has_include(<sys/mman.h>)
TEST_CASE("pixel grid: comparing two grids reads none of the memory that they share") {
	const std::size_t count = static_cast<std::size_t>(size.x) * size.y * pixel_bytes;
	void *const memory = mmap(nullptr, count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	REQUIRE(memory != MAP_FAILED);
	PixelGrid grid;
	REQUIRE(grid.set(size, pixel_bytes, {nullptr, {static_cast<const std::uint8_t *>(memory), count}}).ok());
	PixelGrid patched = grid;
	REQUIRE(patched.patch({{5, 5}, {9, 9}}, *random_bytes(1)).ok());
	const PixelGrid copy = patched;
	REQUIRE(mprotect(memory, count, PROT_NONE) == 0); // From here on, reading this memory crashes.
	CHECK(copy.difference(patched).empty());
	CHECK(PixelGrid(grid).difference(grid).empty());
	CHECK(munmap(memory, count) == 0);
}
#endif
