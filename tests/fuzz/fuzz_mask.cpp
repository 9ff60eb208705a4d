// Loads random bytes as a painted mask, and paints random dabs. Each must either be rejected or
// leave a consistent mask.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/base/word_hash.hpp"
#include "core/rules/painted_mask.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

using Pixels = std::vector<std::uint8_t>;

void check_refusal(const Status &status, const PaintedMask &mask, const PaintedMask &before) {
	require(mask == before, "a rejected call has no effect");
	require(describe(status).find(status.property) == 0, "an error names the property");
}

/// Checks that saved bytes load as an equal mask, which saves as the same bytes.
void check_bytes(const PaintedMask &mask) {
	const Pixels bytes = mask.to_bytes();
	PaintedMask loaded_mask;
	require(loaded_mask.from_bytes(bytes).ok() && loaded_mask == mask, "a loaded mask equals the saved one");
	require(loaded_mask.to_bytes() == bytes, "equal masks have equal bytes");
}

/// Loads a mask's bytes after damaging them at a few positions, with or without a valid checksum.
void load_damaged(const PaintedMask &mask, Bytes &r_bytes) {
	Pixels bytes = mask.to_bytes();
	const std::uint32_t changes = r_bytes.below(4);
	for (std::uint32_t i = 0; i < changes && !bytes.empty(); ++i) {
		// Half of the changes are in the header and the beginning of the first block.
		const auto size = static_cast<std::uint32_t>(bytes.size());
		const std::uint32_t offset = r_bytes.below(r_bytes.chance(2) ? size : std::min(size, 40u));
		switch (r_bytes.below(4)) {
			case 0: bytes.resize(offset); break;
			case 1: bytes.insert(bytes.begin() + offset, 1 + r_bytes.below(20), r_bytes.raw<std::uint8_t>()); break;
			case 2: bytes.erase(bytes.begin() + offset, bytes.begin() + std::min(size, offset + 10)); break;
			default: bytes[offset] = r_bytes.raw<std::uint8_t>(); break;
		}
	}
	if (bytes.size() >= 8 && r_bytes.chance(2)) {
		WordHash hash;
		std::for_each(bytes.begin(), bytes.end() - 8, [&](std::uint8_t byte) { hash.add(std::uint32_t{byte}); });
		for (int byte = 0; byte < 8; ++byte) {
			bytes[bytes.size() - 8 + static_cast<std::size_t>(byte)] =
					static_cast<std::uint8_t>(hash.value() >> 8 * byte);
		}
	}
	PaintedMask loaded_mask = mask;
	const Status status = loaded_mask.from_bytes(bytes);
	if (status.ok()) {
		require(loaded_mask.to_bytes() == bytes, "loaded bytes are written back identically");
	} else {
		check_refusal(status, loaded_mask, mask);
	}
}

Brush read_brush(Bytes &r_bytes, double pixel_size) {
	Brush brush;
	brush.mode = static_cast<Brush::Mode>(r_bytes.below(r_bytes.chance(16) ? 256 : 3));
	brush.center = pixel_size * glm::dvec2(r_bytes.number(-150.0, 150.0), r_bytes.number(-150.0, 150.0));
	brush.radius = pixel_size * r_bytes.number(0.1, r_bytes.chance(4) ? 80.0 : 10.0);
	brush.strength = r_bytes.number(0.0, 1.0);
	brush.hardness = r_bytes.number(0.0, 1.0);
	return brush;
}

std::vector<float> densities(const PaintedMask &mask, const std::vector<glm::dvec2> &positions) {
	std::vector<float> result(positions.size());
	require(mask.sample(positions, result).ok(), "any position can be sampled");
	require(std::ranges::all_of(result, [](float density) { return density >= 0.0f && density <= 1.0f; }),
			"a density lies between 0 and 1");
	return result;
}

/// Paints a dab. Checks that the rest of the plane is unchanged, and that the dab can be undone.
void dab(PaintedMask &r_mask, Bytes &r_bytes) {
	const PaintedMask before = r_mask;
	const Brush brush = read_brush(r_bytes, r_mask.pixel_size());
	Rect changed_rect;
	const Status status = r_mask.paint(brush, changed_rect);
	if (!status.ok()) {
		check_refusal(status, r_mask, before);
		return;
	}
	std::vector<glm::dvec2> positions;
	for (int i = 0; i < 8; ++i) {
		const glm::dvec2 near(r_bytes.number(-2.0, 2.0), r_bytes.number(-2.0, 2.0));
		positions.push_back(brush.center + brush.radius * near);
		positions.emplace_back(changed_rect.max.x, changed_rect.min.y + near.x * changed_rect.size().y);
		positions.emplace_back(changed_rect.min.x + near.x * changed_rect.size().x, changed_rect.max.y);
	}
	const std::vector<float> previous = densities(before, positions);
	const std::vector<float> current = densities(r_mask, positions);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		require(changed_rect.contains(positions[i]) || previous[i] == current[i],
				"nothing changes outside of a dab's rectangle");
	}
	const PixelRect region = before.pixels_of({brush.center - brush.radius, brush.center + brush.radius});
	Pixels pixels;
	Rect undone;
	PaintedMask restored = r_mask;
	if (before.read(region, pixels).ok()) {
		require(restored.write(region, pixels, undone).ok() && restored == before,
				"writing back its pixels undoes a dab");
	}
}

/// Reads and writes a random region, which may be invalid.
void copy_region(PaintedMask &r_mask, Bytes &r_bytes) {
	const auto near_coordinate = [&] {
		return r_bytes.chance(24) ? r_bytes.raw<std::int32_t>() : static_cast<int>(r_bytes.below(300)) - 150;
	};
	PixelRect region;
	region.min = {near_coordinate(), 0};
	region.min.y = near_coordinate();
	region.max = region.min;
	if (!r_bytes.chance(24)) { // These sums do not overflow.
		region.max = glm::ivec2(std::min(region.min.x, 1 << 30), std::min(region.min.y, 1 << 30)) +
				static_cast<int>(r_bytes.below(90)) - 2;
	} else {
		region.max.x = near_coordinate();
		region.max.y = near_coordinate();
	}
	Pixels pixels;
	const PaintedMask before = r_mask;
	if (const Status status = r_mask.read(region, pixels); !status.ok()) {
		check_refusal(status, r_mask, before);
		return;
	}
	if (pixels.size() > 1 << 16) {
		return; // Valid, but too slow.
	}
	Rect changed_rect;
	require(r_mask.write(region, pixels, changed_rect).ok() && changed_rect.empty() && r_mask == before,
			"writing back the same pixels has no effect");
	if (r_bytes.chance(2)) {
		std::ranges::fill(pixels, r_bytes.raw<std::uint8_t>());
		require(r_mask.write(region, pixels, changed_rect).ok(), "a region that can be read can be written");
	} else {
		pixels.push_back(0);
		require(r_mask.write(region, pixels, changed_rect).code == ErrorCode::wrong_size, "an extra byte is rejected");
	}
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	PaintedMask raw;
	if (raw.from_bytes({data, size}).ok()) {
		require(raw.to_bytes() == Pixels(data, data + size), "loaded bytes are written back identically");
	}
	Bytes bytes(data, size);
	PaintedMask mask;
	const double pixel_size = bytes.chance(2) ? 1.0 : bytes.number(PaintedMask::min_pixel_size, 8.0);
	if (const Status status = mask.reset(pixel_size, bytes.number(0.0, 1.0)); !status.ok()) {
		check_refusal(status, mask, PaintedMask());
	}
	const std::uint32_t steps = bytes.below(6);
	for (std::uint32_t step = 0; step < steps; ++step) {
		bytes.chance(4) ? copy_region(mask, bytes) : dab(mask, bytes);
	}
	check_bytes(mask);
	load_damaged(mask, bytes);
	return 0;
}
