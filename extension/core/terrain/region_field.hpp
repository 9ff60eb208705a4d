#pragma once

#include "core/terrain/pixel_grid.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// What paints the ground where a region says that it is painted by slope and height. Terrain3D's auto shader.
struct AutoPaint {
	bool enabled = false;
	int base = 0;                  ///< The texture of steep ground.
	int overlay = 0;               ///< That of level ground.
	double slope = 1.0;            ///< How fast the overlay gives way to the base with the slope.
	double height_reduction = 0.0; ///< Part of the overlay that is lost in a hundred meters of height.

	bool operator==(const AutoPaint &) const = default;
};

/// A square of posts of Terrain3D: heights as floats, and 32 bits of control for each.
struct FieldRegion {
	glm::ivec2 location{0}; ///< Counts regions: the first post is at location * side.
	PixelGrid heights;      ///< 4 bytes a post.
	PixelGrid controls;     ///< As many posts. Empty: no holes, and texture 0 everywhere.
};

/// Terrain3D's ground: square regions of posts, which may be anywhere and meet without a seam. As Terrain3D 1.0 and 1.1 have it
/// (Terrain3DData::get_height, get_normal and get_texture_id in src/terrain_3d_data.cpp, the bits of a control in
/// src/terrain_3d_util.h):
/// - between four posts heights are bilinear; a post that no region has, or that is not finite, leaves the patches around it
///   without ground;
/// - so does a hole at a post, as in the drawn mesh and in the collider (`get_height` itself leaves out a quarter of that, the
///   patch behind the post);
/// - normals are from the differences of heights one post further on. Where that post has no ground, the patch's own is taken.
/// A copy, immutable, safe on any thread.
class RegionField final : public Terrain {
public:
	static constexpr int max_location = 1 << 12;        ///< Either side of 0.
	static constexpr int default_side = 256;            ///< Of Terrain3D; where there is no region to tell.
	static constexpr double min_spacing = 1e-3;         ///< Meters between posts.
	static constexpr double max_spacing = 1e4;          ///< The same.
	static constexpr std::size_t max_table = 1u << 20u; ///< Locations in the rectangle around all regions.

	/// Refuses a side that is not 2 to PixelGrid::max_side, a spacing outside the limits, two regions at one location, locations
	/// too far apart, and maps of another size; a failure changes nothing. No region at all is no ground anywhere.
	Status set(int side, double spacing, std::vector<FieldRegion> regions, const AutoPaint &paint);

	/// The same with the origin of the field at `offset`, in world meters. Shares the regions.
	RegionField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// Textures by the number that they have in Terrain3D: those of the post before the position.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	int side() const { return side_; }
	double spacing() const { return spacing_; }
	const AutoPaint &paint() const { return paint_; }
	std::span<const FieldRegion> regions() const {
		return layout_ ? std::span<const FieldRegion>(layout_->regions) : std::span<const FieldRegion>{};
	}
	/// Null for none.
	const FieldRegion *region_at(glm::ivec2 location) const;

private:
	struct Layout {
		std::vector<FieldRegion> regions;
		glm::ivec2 first{0}; ///< The table's first location.
		glm::ivec2 size{0};
		std::vector<std::int32_t> table; ///< Index of the region at a location, row by row; below 0 for none.
	};

	/// A position in posts.
	struct Place {
		glm::ivec2 post; ///< Before the position on both axes.
		glm::dvec2 part; ///< From there to the next, 0 to below 1.
	};

	struct Post {
		double height;
		bool hole;
	};

	bool find_place(glm::dvec2 position, Place &r_place) const;
	Post post_at(glm::ivec2 post) const;
	std::uint32_t control_at(glm::ivec2 post) const;
	Ground ground_at(glm::dvec2 position) const;
	float weight_at(const Place &place, glm::dvec2 position, std::span<const std::int32_t> textures) const;

	int side_ = 1;
	double spacing_ = 1.0;
	AutoPaint paint_;
	std::shared_ptr<const Layout> layout_;
	glm::dvec3 offset_{0.0};
};

} // namespace thicket
