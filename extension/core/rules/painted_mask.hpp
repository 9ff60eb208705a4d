#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/rect.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

struct Brush {
	enum class Mode : std::uint8_t {
		paint,  ///< Towards 1.
		erase,  ///< Towards 0.
		smooth, ///< Towards the mean of the surroundings.
	};

	Mode mode = Mode::paint;
	glm::dvec2 center{0.0}; ///< World meters, finite.
	double radius =
			4.0; ///< Meters, above 0, at most max_brush_pixels pixels of the mask. A pixel counts if its center does.
	double strength = 1.0; ///< How far one dab moves its center towards the target, 0 to 1.
	double hardness = 0.5; ///< Fraction of the radius with full strength, 0 to 1. Falls smoothly to 0 at the rim.
};

inline constexpr double max_brush_pixels = 1024.0;

/// Painted densities on an unbounded plane of square 8-bit pixels. Only the blocks that a brush has touched are stored. Pixel (x, y)
/// covers [x, x + 1) times [y, y + 1) pixel sizes of the world. Bilinear between pixel centers.
///
/// A copy is cheap and shares the blocks, so a worker can read its copy while the brush goes on painting.
class PaintedMask final : public DensityField {
public:
	/// Clears the mask. `pixel_size` is in meters, min_pixel_size to max_pixel_size. `background` is the density of unpainted areas, 0 to
	/// 1. Values out of range are refused and change nothing.
	Status reset(double pixel_size, double background);

	double pixel_size() const { return pixel_size_; }
	double background() const; ///< Rounded to 8 bits.

	/// Paints one dab. Sets `r_changed` to the world rectangle outside which no density has changed; empty if none has.
	/// A pixel whose weight in the dab is at least half an 8-bit step moves at least one step towards the target, so
	/// that weak dabs reach it eventually. Refuses a dab that reaches a pixel beyond pixel_limit.
	Status paint(const Brush &brush, Rect &r_changed);

	/// Returns 0 for a position that is not finite, and the background beyond pixel_limit.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// Reads the pixels of a rectangle of at most max_region_pixels within pixel_limit, row by row, for undo. An empty rectangle returns
	/// none. An inverted one is refused.
	Status read(const PixelRect &region, std::vector<std::uint8_t> &r_pixels) const;

	/// Writes such pixels back. `r_changed` is as in `paint`.
	Status write(const PixelRect &region, std::span<const std::uint8_t> pixels, Rect &r_changed);

	/// The pixels, within pixel_limit, whose value may affect a world rectangle or be affected by it. A dab reaches only the pixels of
	/// the square around its circle.
	PixelRect pixels_of(const Rect &area) const;

	/// The whole mask as bytes: versioned, checksummed, equal for equal masks. Uniform blocks take few bytes.
	std::vector<std::uint8_t> to_bytes() const;

	/// Loads bytes of `to_bytes`. Truncated, corrupt or foreign data, or data of a later version, is refused and changes nothing. Takes
	/// at most about 20 bytes of memory per input byte.
	Status from_bytes(std::span<const std::uint8_t> bytes);

	/// Whether any density of two masks differs. `r_area` is the world rectangle outside which none does: infinite if the masks differ in
	/// raster or background, empty if they are equal.
	bool differs(const PaintedMask &other, Rect &r_area) const;

	std::size_t block_count() const { return blocks_.size(); }

	/// The number of blocks that two masks do not share in memory. A copy shares all blocks until either mask is painted. `differs`
	/// searches only the blocks that are not shared.
	std::size_t blocks_apart(const PaintedMask &other) const;

	/// Equal in pixel size and in all densities.
	friend bool operator==(const PaintedMask &, const PaintedMask &);

	static constexpr int block_side = 64;
	static constexpr double min_pixel_size = 1.0 / 64.0;
	static constexpr double max_pixel_size = 1024.0;
	static constexpr int pixel_limit = 1 << 30; ///< Pixels lie in [-pixel_limit, pixel_limit) on both axes.
	static constexpr std::size_t max_region_pixels = std::size_t{1} << 24;

private:
	using Block = std::array<std::uint8_t, std::size_t{block_side} * block_side>;
	using Key = std::pair<std::int32_t, std::int32_t>; ///< Block row, block column.

	using Blocks = std::map<Key, std::shared_ptr<const Block>>;

	class Reader;
	class Edit;
	class BlockParser;

	/// Null if all of the block is background.
	const Block *find(Key key) const;

	/// Calls `visit(key, mine, theirs)` for all blocks that the masks do not share. A missing block is null.
	template <typename Visit>
	void for_blocks_apart(const PaintedMask &other, const Visit &visit) const;

	/// Replaces the given blocks. Null removes a block. Allocates no memory.
	void replace(Blocks &&blocks) noexcept;

	double pixel_size_ = 1.0;
	std::uint8_t background_ = 255;
	Blocks blocks_; ///< None of them is entirely background.
};

} // namespace thicket
