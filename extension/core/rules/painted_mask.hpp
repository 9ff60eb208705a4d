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

/// A density brush.
struct Brush {
	enum class Mode : std::uint8_t {
		paint,  ///< Towards 1.
		erase,  ///< Towards 0.
		smooth, ///< Towards the mean of the surroundings.
	};

	Mode mode = Mode::paint;
	glm::dvec2 center{0.0}; ///< World meters, finite.
	double radius =
			4.0; ///< Meters, above 0, at most max_brush_pixels pixels of the mask. Pixels count by their centers.
	double strength = 1.0; ///< How far towards the aim a single dab goes in its middle, 0 to 1.
	double hardness =
			0.5; ///< The part of the radius, 0 to 1, within which the strength is full; smooth to 0 at the rim.
};

inline constexpr double max_brush_pixels = 1024.0;

/// Densities that are painted, without an edge: the plane in square pixels of 8 bits, of which only those blocks are kept
/// that a brush has touched. Pixel (x, y) covers [x, x + 1) times [y, y + 1) pixel sizes of the world; bilinear between centers.
///
/// A copy is cheap and shares the blocks, so a worker reads the state that was handed to it while the brush goes on.
class PaintedMask final : public DensityField {
public:
	/// `pixel_size` in meters, min_pixel_size to max_pixel_size; `background` is the density where nothing was painted, 0
	/// to 1. What is out of range is refused and changes nothing. Forgets what was painted.
	Status reset(double pixel_size, double background);

	double pixel_size() const { return pixel_size_; }
	double background() const; ///< As rounded to 8 bits.

	/// One dab. Returns in `r_changed` the world rectangle outside which no density has changed; empty if none has. A pixel
	/// whose weight in the dab is at least half of an 8-bit step gets nearer to the aim by one step or more, so that weak dabs
	/// reach it in the end. Refuses a dab that reaches a pixel beyond pixel_limit.
	Status paint(const Brush &brush, Rect &r_changed);

	/// 0 for a position that is not finite; the background beyond pixel_limit.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// The pixels of a rectangle of at most max_region_pixels within pixel_limit, row by row; what undo keeps. A rectangle
	/// without pixels has none; one that ends before it starts is refused.
	Status read(const PixelRect &region, std::vector<std::uint8_t> &r_pixels) const;

	/// Writes such pixels back. `r_changed` as for `paint`.
	Status write(const PixelRect &region, std::span<const std::uint8_t> pixels, Rect &r_changed);

	/// The pixels whose value may affect, or be affected by, what lies in a world rectangle, within pixel_limit. A dab reaches
	/// none but those of the square about its circle.
	PixelRect pixels_of(const Rect &area) const;

	/// The whole mask as bytes: versioned, checksummed, equal for equal masks. Blocks of one value take few bytes.
	std::vector<std::uint8_t> to_bytes() const;

	/// Takes bytes of `to_bytes`, and nothing else: what is truncated, corrupt or foreign, or of a later version, is refused
	/// and changes nothing. Takes no more memory than some 20 bytes for each of the bytes.
	Status from_bytes(std::span<const std::uint8_t> bytes);

	/// Whether any density of two masks differs, and the world rectangle outside which none does; infinite if the masks have
	/// not the same raster or background, empty if they are equal.
	bool differs(const PaintedMask &other, Rect &r_area) const;

	std::size_t block_count() const { return blocks_.size(); }

	/// How many blocks two masks do not share in memory, as a copy shares all until either is painted: only in these does `differs` look for
	/// differences.
	std::size_t blocks_apart(const PaintedMask &other) const;

	/// Equal in pixel size and in every density.
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

	/// Null where all is background.
	const Block *find(Key key) const;

	/// Calls `visit(key, mine, theirs)` for all blocks that the masks do not share; null for one that is not there.
	template <typename Visit>
	void for_blocks_apart(const PaintedMask &other, const Visit &visit) const;

	/// Replaces the blocks that are there; null removes one. Takes no memory.
	void replace(Blocks &&blocks) noexcept;

	double pixel_size_ = 1.0;
	std::uint8_t background_ = 255;
	Blocks blocks_; ///< None of them is all background.
};

} // namespace thicket
