#pragma once

#include "core/terrain/pixel_grid.hpp"
#include "core/terrain/post_format.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The transform of a map of posts in the world: rotated about the vertical, translated, and scaled on any axis.
struct MapPlace {
	glm::dmat2 to_world{1.0}; ///< World x and z, in meters, of one step along the map's columns and rows.
	glm::dvec3 origin{0.0};   ///< World meters of the first post at height 0.
	double height_scale = 1.0;

	bool operator==(const MapPlace &) const = default;
};

/// The maps of an HTerrain: images with one pixel per post.
struct MapLayers {
	PostFormat format = PostFormat::float32;
	PixelGrid heights;             ///< bytes_of(format) bytes per pixel.
	PixelGrid colors;              ///< RGBA8. An alpha below one half is a hole. Empty: no holes.
	std::vector<PixelGrid> splats; ///< RGBA8: each channel is the share of a texture, four textures per splat.
	PixelGrid indices;             ///< RGB8: the numbers of three textures per pixel.
	PixelGrid weights; ///< RG8: shares of the first two; the third has the rest. Set both or none; replaces splats.

	bool has_textures() const { return !splats.empty() || !indices.empty(); }
};

/// HTerrain's ground, as in its versions 1.8 and later: get_interpolated_height_at in hterrain_data.gd, and the maps of the shaders
/// simple4, multisplat16 and array. Between four posts, heights and the edges of holes are bilinear. Normals are smooth, like
/// Heightfield's (HTerrain's own are baked from the same differences). The border of the map has ground. A copy, immutable once set, safe
/// on any thread.
class MapField final : public Terrain {
public:
	static constexpr double min_area = 1e-6; ///< Minimum area between four posts in square meters.

	/// Refuses a transform that is not finite or has no area, maps of fewer than 2 * 2 posts, and layers that differ in size from the
	/// heights. A failure changes nothing.
	Status set(const MapPlace &place, const MapLayers &layers);

	/// A copy of the field, moved by `offset` in world meters. It shares the maps.
	MapField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The channels of splats are textures 0 to 3, 4 to 7 and so on. Indices contain texture numbers. Without both, all ground counts as
	/// all textures. Where there is no map, the weight is 0.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	const MapPlace &place() const { return place_; }
	const MapLayers &layers() const { return layers_; }

private:
	glm::ivec2 posts() const { return layers_.heights.size(); }
	bool find_patch(glm::dvec2 position, glm::ivec2 &r_patch, glm::dvec2 &r_part) const;
	Ground ground_at(glm::dvec2 position) const;
	double splat_at(int column, int row, std::span<const unsigned> channels) const;
	double indexed_at(int column, int row, std::span<const std::int32_t> textures) const;

	MapPlace place_;
	glm::dmat2 to_map_{1.0};
	MapLayers layers_;
};

} // namespace thicket
