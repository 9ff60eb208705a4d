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

/// Where a map of posts lies in the world: turned about the vertical, moved, and stretched on any axis.
struct MapPlace {
	glm::dmat2 to_world{1.0}; ///< World x and z, in meters, of a step along the map's columns and along its rows.
	glm::dvec3 origin{0.0};   ///< World meters of the first post, if its height were 0.
	double height_scale = 1.0;

	bool operator==(const MapPlace &) const = default;
};

/// What an HTerrain has: images with a pixel for each post.
struct MapLayers {
	PostFormat format = PostFormat::float32;
	PixelGrid heights;             ///< bytes_of(format) bytes a pixel.
	PixelGrid colors;              ///< RGBA8; where the alpha is below a half, there is a hole. Empty: there is none.
	std::vector<PixelGrid> splats; ///< RGBA8: each channel the part of a texture, four textures to a splat.
	PixelGrid indices;             ///< RGB8: three textures to a pixel, which
	PixelGrid weights; ///< RG8 says the parts of, the third being the rest. Both or none; then splats do not count.

	bool has_textures() const { return !splats.empty() || !indices.empty(); }
};

/// HTerrain's ground, as its versions 1.8 and later have it: get_interpolated_height_at in hterrain_data.gd, the maps of the
/// shaders simple4, multisplat16 and array. Between four posts heights, and where holes begin, are bilinear; normals are
/// smooth, as Heightfield's are (HTerrain's own are baked from the same differences). The border of the map has ground. A copy,
/// immutable once set, safe on any thread.
class MapField final : public Terrain {
public:
	static constexpr double min_area = 1e-6; ///< Square meters between four posts.

	/// Refuses a place that is not finite or has no area, maps of fewer than 2 * 2 posts, and layers of another size than the
	/// heights; a failure changes nothing.
	Status set(const MapPlace &place, const MapLayers &layers);

	/// The same with the place moved by `offset`, in world meters. Shares the maps.
	MapField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The channels of splats are textures 0 to 3, 4 to 7 and so on; those of indices are by their numbers. Without either all
	/// ground is of all textures; where there is no map, the weight is 0.
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
