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

/// The textures of ground whose control bits select painting by slope and height: Terrain3D's auto shader.
struct AutoPaint {
	bool enabled = false;
	int base = 0;                  ///< The texture of steep ground.
	int overlay = 0;               ///< The texture of level ground.
	double slope = 1.0;            ///< How fast the base replaces the overlay as the slope grows.
	double height_reduction = 0.0; ///< Fraction of the overlay lost per hundred meters of height.

	bool operator==(const AutoPaint &) const = default;
};

/// A square of posts of Terrain3D: float heights, and 32 control bits for each.
struct FieldRegion {
	glm::ivec2 location{0}; ///< In regions: the first post is at location * side.
	PixelGrid heights;      ///< 4 bytes per post.
	PixelGrid controls;     ///< As many posts. Empty: no holes, and texture 0 everywhere.
};

/// Terrain3D's ground: square regions of posts at any locations, which meet without a seam. Follows Terrain3D 1.0 and 1.1
/// (Terrain3DData::get_height, get_normal and get_texture_id in src/terrain_3d_data.cpp, the bits of a control in src/terrain_3d_util.h):
/// - Between four posts, heights are bilinear. A post that belongs to no region, or that is not finite, leaves the patches around it
/// without ground.
/// - So does a hole at a post, as in the drawn mesh and in the collider (`get_height` itself omits a quarter of that, the patch behind
/// the post).
/// - Normals use the height differences to the next post. Where that post has no ground, the patch's own difference is used.
/// A copy, immutable, safe on any thread.
class RegionField final : public Terrain {
public:
	static constexpr int max_location = 1 << 12;        ///< In both directions from 0.
	static constexpr int default_side = 256;            ///< Terrain3D's default, used if there is no region.
	static constexpr double min_spacing = 1e-3;         ///< Meters between posts.
	static constexpr double max_spacing = 1e4;          ///< Meters between posts.
	static constexpr std::size_t max_table = 1u << 20u; ///< Locations in the rectangle around all regions.

	/// Refuses a side outside 2 to PixelGrid::max_side, a spacing outside the limits, two regions at one location, locations too far
	/// apart, and maps of the wrong size. A failure changes nothing. Without regions there is no ground.
	Status set(int side, double spacing, std::vector<FieldRegion> regions, const AutoPaint &paint);

	/// A copy of the field with its origin at `offset`, in world meters. It shares the regions.
	RegionField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// Uses Terrain3D's texture numbers, those of the post before the position.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	int side() const { return side_; }
	double spacing() const { return spacing_; }
	const AutoPaint &paint() const { return paint_; }
	std::span<const FieldRegion> regions() const {
		return layout_ ? std::span<const FieldRegion>(layout_->regions) : std::span<const FieldRegion>{};
	}
	/// Null if there is none.
	const FieldRegion *region_at(glm::ivec2 location) const;

private:
	struct Layout {
		std::vector<FieldRegion> regions;
		glm::ivec2 first{0}; ///< The table's first location.
		glm::ivec2 size{0};
		std::vector<std::int32_t> table; ///< Index of the region at a location, row by row; below 0 if none.
	};

	/// A position in posts.
	struct Place {
		glm::ivec2 post; ///< The post before the position on both axes.
		glm::dvec2 part; ///< Fraction of the way to the next post, 0 to below 1.
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
