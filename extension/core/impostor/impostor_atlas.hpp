#pragma once

#include "core/impostor/frame_levels.hpp"
#include "core/impostor/impostor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Assembles both atlases of an impostor, with all mipmaps.
class ImpostorAtlas {
public:
	/// Allocates both atlases. The settings must be valid. Throws std::bad_alloc.
	explicit ImpostorAtlas(const ImpostorSettings &settings);

	/// Writes a frame at a column and a row.
	void put(int column, int row, const FrameLevels &frame);

	/// Generates the levels in which frames are smaller than a pixel, and adjusts the coverage of
	/// all levels to match the finest one. Call this function after all frames are written.
	void finish();

	std::vector<std::uint8_t> &albedo() { return albedo_; }
	std::vector<std::uint8_t> &normal() { return normal_; }

private:
	struct Level {
		int side = 1;
		std::size_t first = 0; ///< Byte offset of the level in the atlas.
	};

	std::span<std::uint8_t> albedo_of(const Level &level);
	static void shrink(std::vector<std::uint8_t> &r_bytes, const Level &finer, const Level &coarser);

	int whole_levels_ = 0; ///< Number of levels in which a frame has at least one pixel.
	std::vector<Level> levels_;
	std::vector<std::uint8_t> albedo_;
	std::vector<std::uint8_t> normal_;
};

} // namespace thicket
