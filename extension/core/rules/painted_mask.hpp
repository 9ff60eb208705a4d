#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/rules/cube_grid.hpp"
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
		paint,  ///< Raises the density toward 1.
		erase,  ///< Lowers the density toward 0.
		smooth, ///< Moves the density toward the mean of its surroundings.
	};

	Mode mode = Mode::paint;
	glm::dvec2 center{0.0}; ///< Center of the dab in world meters, finite.
	/// Meters, above 0, at most max_brush_pixels pixels of the mask. A pixel is inside the brush if
	/// its center is.
	double radius = 4.0;
	/// Fraction of the way to the target density by which one dab changes the pixels at its center,
	/// 0 to 1.
	double strength = 1.0;
	/// Fraction of the radius that has full strength, 0 to 1. The strength falls smoothly to 0 at
	/// the rim.
	double hardness = 0.5;
};

inline constexpr double max_brush_pixels = 1024.0;

/// Painted densities on a plane of square 8-bit pixels, interpolated bilinearly between pixel
/// centers. Only painted blocks are stored. Pixel (x, y) covers [x, x + 1) x [y, y + 1), in units
/// of the pixel size.
///
/// A copy is cheap because it shares the blocks. A worker thread can read its copy while the user
/// keeps painting.
class PaintedMask final : public DensityField {
public:
	/// Clears the mask. `pixel_size` is in meters, min_pixel_size to max_pixel_size. `background`
	/// is the density of unpainted areas, 0 to 1. Values out of range are errors and leave the mask
	/// unchanged.
	Status reset(double pixel_size, double background);

	double pixel_size() const { return pixel_size_; }
	double background() const; ///< Returns the density of unpainted areas, rounded to 8 bits.

	/// Paints one dab. Sets `r_changed` to a world rectangle that contains all changed densities,
	/// or to an empty one if there are none. A pixel whose weight is at least half an 8-bit step
	/// changes by at least one step, so that repeated weak dabs reach the target. A dab that
	/// touches a pixel beyond pixel_limit is an error.
	Status paint(const Brush &brush, Rect &r_changed);

	/// For a position that is not finite, the density is 0. Beyond pixel_limit, it is the
	/// background.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	// On a planet, the pixels are the nodes of a CubeGrid for the planet's radius and the pixel size.

	/// Like `sample`, on a planet: for directions from its center instead of positions on the plane.
	Status sample_on(const Planet &planet, const PositionBatch &batch, std::span<float> r_density) const;

	/// Returns the density in a direction from the center of a planet, which need not be normalized; 0 if
	/// it is not finite.
	double toward(double planet_radius, const glm::dvec3 &from_center) const;

	/// Paints one dab on the sphere with a planet's radius, in a direction from the planet's center,
	/// which need not be normalized. The brush's radius is a straight distance on that sphere, and its
	/// center has no effect. Sets `r_changed` to true if any density has changed. A radius of the
	/// planet that is not positive, and a center without a direction, are errors.
	Status paint_on(double planet_radius, const glm::dvec3 &from_center, const Brush &brush, bool &r_changed);

	/// Returns a rectangle of pixels for each face of the CubeGrid. They contain all pixels that a dab
	/// with this radius in meters may change. Rectangles of distant faces are empty.
	std::array<PixelRect, CubeGrid::faces> pixels_on(
			double planet_radius, const glm::dvec3 &from_center, double radius) const;

	/// Like `differs`, on a planet. Appends world rectangles (see shadow_of) that contain all
	/// differences, at most one for each face. Returns false if any density may differ.
	bool find_edits_on(const Planet &planet, const PaintedMask &other, std::vector<Rect> &r_areas) const;

	/// Reads the pixels of `region` row by row, for undo. The region has at most max_region_pixels
	/// pixels, all within pixel_limit. An empty region returns no pixels, and an inverted one is an
	/// error.
	Status read(const PixelRect &region, std::vector<std::uint8_t> &r_pixels) const;

	/// Writes pixels in the order in which `read` returns them. `r_changed` is as in `paint`.
	Status write(const PixelRect &region, std::span<const std::uint8_t> pixels, Rect &r_changed);

	/// Returns the pixels within pixel_limit that may affect densities in `area`. For the square
	/// around a dab's circle, the result contains all pixels that the dab changes.
	PixelRect pixels_of(const Rect &area) const;

	/// Serializes the mask, with a version and a checksum. Equal masks produce equal bytes. A block
	/// of a single value takes few bytes.
	std::vector<std::uint8_t> to_bytes() const;

	/// Loads the output of `to_bytes`. Truncated, corrupt or foreign data and data of a later
	/// version are errors that leave the mask unchanged. Loading takes at most about 20 bytes of
	/// memory per input byte.
	Status from_bytes(std::span<const std::uint8_t> bytes);

	/// Returns true if any density of the two masks differs. `r_area` becomes a world rectangle
	/// that contains all differences: infinite if the pixel size or background differs, and empty
	/// if the masks are equal.
	bool differs(const PaintedMask &other, Rect &r_area) const;

	std::size_t block_count() const { return blocks_.size(); }

	/// Returns the number of blocks that the two masks do not share in memory. A copy shares all
	/// blocks until either mask is painted. The cost of `differs` depends on this number.
	std::size_t count_unshared_blocks(const PaintedMask &other) const;

	/// Returns true if the pixel size and all densities are equal.
	friend bool operator==(const PaintedMask &, const PaintedMask &);

	static constexpr int block_side = 64;
	static constexpr double min_pixel_size = 1.0 / 64.0;
	static constexpr double max_pixel_size = 1024.0;
	static constexpr int pixel_limit = 1 << 30; ///< Pixels lie in [-pixel_limit, pixel_limit) on both axes.
	static constexpr std::size_t max_region_pixels = std::size_t{1} << 24;

private:
	using Block = std::array<std::uint8_t, std::size_t{block_side} * block_side>;
	using Key = std::pair<std::int32_t, std::int32_t>; ///< The row and the column of a block.

	using Blocks = std::map<Key, std::shared_ptr<const Block>>;

	class Reader;
	class Edit;
	class BlockParser;
	class FaceReader;
	struct FaceDab;

	Status check_brush(const Brush &brush) const;
	bool paint_face(const FaceDab &dab, const PaintedMask &before);

	/// Returns null if the whole block is background.
	const Block *find(Key key) const;

	/// Calls `visit(key, mine, theirs)` for each block that the masks do not share. A missing block
	/// is passed as null.
	template <typename Visit>
	void for_each_unshared_block(const PaintedMask &other, const Visit &visit) const;

	PixelRect differing_pixels(const Key &key, const Block *mine, const Block *theirs) const;

	/// Replaces the given blocks. A null entry removes its block. The function allocates no memory.
	void replace(Blocks &&blocks) noexcept;

	double pixel_size_ = 1.0;
	std::uint8_t background_ = 255;
	Blocks blocks_; ///< The blocks with at least one pixel that is not background.
};

} // namespace thicket
