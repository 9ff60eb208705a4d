#pragma once

#include "core/terrain/pixel_grid.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The settings of Terrain3D's auto shader, which textures ground by slope and height where a
/// control bit selects it.
struct AutoPaint {
	bool enabled = false;
	int base = 0;    ///< The texture of steep ground.
	int overlay = 0; ///< The texture of level ground.
	/// The rate at which the base texture replaces the overlay as the slope increases.
	double slope = 1.0;
	double height_reduction = 0.0; ///< Decrease of the overlay's weight per 100 m of height.

	bool operator==(const AutoPaint &) const = default;
};

/// A square region of Terrain3D: a grid of float heights, each with 32 control bits.
struct FieldRegion {
	glm::ivec2 location{0}; ///< In units of regions: the index of the first height sample is location * side.
	PixelGrid heights;      ///< Heights, 4 bytes per height sample.
	PixelGrid controls;     ///< Control bits, 4 bytes per sample. If empty: no holes, and texture 0 everywhere.
};

/// The ground of Terrain3D: square regions of height samples at any locations, without seams
/// between them. It implements the behavior of Terrain3D 1.0 and 1.1 (Terrain3DData::get_height,
/// get_normal and get_texture_id in src/terrain_3d_data.cpp, and the control bits in
/// src/terrain_3d_util.h):
/// - Between four height samples, heights are interpolated bilinearly. If a sample belongs to no
///   region or is not finite, the patches around it have no ground.
/// - A hole at a height sample also removes the patches around it, as in the drawn mesh and the
///   collider. (`get_height` itself omits only the patch after the sample.)
/// - Normals use the height differences to the next height sample. If that sample does not exist,
///   they use the difference within the patch.
///
/// A field is a snapshot that does not change after `set`, and any thread may read it.
class RegionField final : public Terrain {
public:
	static constexpr int max_location = 1 << 12; ///< Locations are in [-max_location, max_location).
	static constexpr int default_side = 256;     ///< Terrain3D's default, for terrain without regions.
	static constexpr double min_spacing = 1e-3;  ///< Minimum distance between height samples in meters.
	static constexpr double max_spacing = 1e4;   ///< Maximum distance between height samples in meters.
	/// Maximum number of locations in the rectangle around all regions.
	static constexpr std::size_t max_table = 1u << 20u;

	/// Sets the regions. `side` is in height samples, 2 to PixelGrid::max_side, and `spacing` in
	/// meters, min_spacing to max_spacing. All maps must have `side` x `side` pixels; control maps
	/// may be empty. Locations must be distinct, in range, and within a rectangle of max_table
	/// locations. Otherwise, the function returns an error and leaves the field unchanged. Without
	/// regions, there is no ground.
	Status set(int side, double spacing, std::vector<FieldRegion> regions, const AutoPaint &paint);

	/// Returns a copy of the field with its origin at `offset`, in world meters. The copy shares
	/// the regions.
	RegionField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// See Terrain::weigh(). The texture numbers are the Terrain3D IDs at the height sample before
	/// the position.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Returns two triangles per patch, as in Heightfield. Returns null if there are no regions or
	/// if the indices of triangles would exceed Surface::max_triangles.
	const Surface *surface() const override { return surface_.get(); }

	int side() const { return side_; }
	double spacing() const { return spacing_; }
	const AutoPaint &paint() const { return paint_; }
	std::span<const FieldRegion> regions() const {
		return layout_ ? std::span<const FieldRegion>(layout_->regions) : std::span<const FieldRegion>{};
	}
	/// Returns null if there is no region at this location.
	const FieldRegion *region_at(glm::ivec2 location) const;

private:
	struct Grid;
	struct Layout {
		std::vector<FieldRegion> regions;
		glm::ivec2 first{0}; ///< Minimum location of all regions.
		glm::ivec2 size{0};
		std::vector<std::int32_t> table; ///< Index of the region at each location, row by row; -1 if none.
	};

	/// A position, in units of height samples.
	struct PostPosition {
		glm::ivec2 post; ///< The height sample before the position on both axes.
		glm::dvec2 part; ///< Fraction of the way to the next height sample, in [0, 1).
	};

	struct Post {
		double height;
		bool hole;
	};

	void make_surface();
	bool heights_of(glm::ivec2 first, std::array<double, 4> &r_heights) const;
	bool find_post_position(glm::dvec2 position, PostPosition &r_post_position) const;
	Post post_at(glm::ivec2 post) const;
	std::uint32_t control_at(glm::ivec2 post) const;
	Ground ground_at(glm::dvec2 position) const;
	float weight_at(
			const PostPosition &post_position, glm::dvec2 position, std::span<const std::int32_t> textures) const;

	int side_ = 1;
	double spacing_ = 1.0;
	AutoPaint paint_;
	std::shared_ptr<const Layout> layout_;
	glm::dvec3 offset_{0.0};
	std::shared_ptr<const Surface> surface_;
};

} // namespace thicket
