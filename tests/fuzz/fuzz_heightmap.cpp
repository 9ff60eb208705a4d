// Reads random bytes, and damaged PNG files with valid checksums, as a height map. Each must either
// be rejected or have as many posts as it specifies.

#include "tests/core/png_writer.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/heightmap/height_file.hpp"

#include <array>
#include <string>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;
using png::Stored;

void check(const Status &status, const Posts &posts) {
	if (!status.ok()) {
		require(posts.count.x == 0 && posts.steps.empty() && posts.floats.empty(), "a rejected file has no effect");
		require(describe(status).starts_with(status.property), "an error names the property");
		return;
	}
	const std::size_t count = static_cast<std::size_t>(posts.count.x) * static_cast<std::size_t>(posts.count.y);
	require(count >= 4 && posts.steps.size() + posts.floats.size() == count, "a file has all its posts");
}

void read(const Stored &file, const RawLayout &layout) {
	Posts posts;
	const Status status = kind_of_height_file(file) == HeightFileKind::png ? read_png(file, "path", posts)
																		   : read_raw(file, layout, "path", posts);
	check(status, posts);
}

png::Layout read_layout(Bytes &r_bytes) {
	constexpr std::array<std::array<int, 2>, 12> types{
			{{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {3, 8}, {4, 8}, {4, 16}, {6, 8}, {6, 16}}};
	const auto &[color_type, bits] = types[r_bytes.below(types.size())];
	png::Layout layout{{1, 1}, color_type, bits, r_bytes.chance(2)};
	layout.size += glm::ivec2(r_bytes.below(20), r_bytes.below(20));
	return layout;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	Bytes bytes(data, size);
	const RawLayout raw{{bytes.below(40), bytes.below(40)}, static_cast<int>(bytes.below(5))};
	read(Stored(data, data + size), bytes.chance(2) ? RawLayout{{0, 0}, raw.bytes_per_post} : raw);

	png::Layout layout = read_layout(bytes);
	Stored rows = png::rows_of(
			layout, [&](glm::ivec2, int) { return bytes.raw<std::uint16_t>() & ((1u << layout.bits) - 1); });
	switch (bytes.below(4)) { // Damage that the checksums do not reveal.
		case 0: rows.resize(bytes.below(static_cast<std::uint32_t>(2 * rows.size() + 1))); break;
		case 1: rows[bytes.below(static_cast<std::uint32_t>(rows.size()))] = bytes.raw<std::uint8_t>(); break;
		case 2: layout.size = {bytes.raw<std::int32_t>(), bytes.below(70000)}; break;
		default: break;
	}
	Stored file = png::file_of(layout, rows);
	if (bytes.chance(2)) {
		const std::uint32_t offset = bytes.below(static_cast<std::uint32_t>(file.size()));
		if (bytes.chance(2)) {
			file.resize(offset);
		} else {
			file[offset] = bytes.raw<std::uint8_t>();
		}
	}
	read(file, raw);
	return 0;
}
