#pragma once

#include "core/impostor/frame_levels.hpp"
#include "core/impostor/impostor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Both atlases of an impostor while they are assembled, with all mip maps.
class ImpostorAtlas {
public:
	/// The settings must be valid. Throws std::bad_alloc if memory runs out.
	explicit ImpostorAtlas(const ImpostorSettings &settings);

	/// Writes a frame into a column and a row.
	void put(int column, int row, const FrameLevels &frame);

	/// Call this once all frames are written. Generates the levels in which frames are smaller than a pixel, and gives
	/// all levels the coverage of the finest level.
	void finish();

	std::vector<std::uint8_t> &albedo() { return albedo_; }
	std::vector<std::uint8_t> &normal() { return normal_; }

private:
	struct Level {
		int side = 1;
		std::size_t first = 0; ///< Byte.
	};

	std::span<std::uint8_t> albedo_of(const Level &level);
	static void shrink(std::vector<std::uint8_t> &r_bytes, const Level &from, const Level &to);

	int whole_levels_ = 0; ///< The levels in which a frame has at least one pixel.
	std::vector<Level> levels_;
	std::vector<std::uint8_t> albedo_;
	std::vector<std::uint8_t> normal_;
};

} // namespace thicket
