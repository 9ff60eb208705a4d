#pragma once

#include "core/terrain/pixel_grid.hpp"
#include "core/terrain/post_format.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The transform of a map of height samples to the world: a rotation about the vertical axis, a
/// translation, and a scale on each axis.
struct MapTransform {
	glm::dmat2 to_world{1.0}; ///< World x and z, in meters, of one grid step along columns and rows.
	glm::dvec3 origin{0.0};   ///< World position, in meters, of the first height sample at height 0.
	double height_scale = 1.0;

	bool operator==(const MapTransform &) const = default;
};

/// The maps of an HTerrain node: images with one pixel per height sample.
struct MapLayers {
	PostFormat format = PostFormat::float32;
	PixelGrid heights; ///< Heights, with bytes_of(format) bytes per pixel.
	/// RGBA8. A pixel with an alpha below one half is a hole. If empty, there are no holes.
	PixelGrid colors;
	std::vector<PixelGrid> splats; ///< RGBA8. Each channel is the weight of a texture.
	PixelGrid indices;             ///< RGB8: the indices of three textures per pixel. Requires `weights`.
	/// RG8: the weights of the first two textures; the third texture has the remaining weight. Used
	/// instead of `splats`. Requires `indices`.
	PixelGrid weights;

	bool has_textures() const { return !splats.empty() || !indices.empty(); }
};

/// The ground of HTerrain 1.8 and later. It implements get_interpolated_height_at of
/// hterrain_data.gd and the maps of the shaders simple4, multisplat16 and array. Between four
/// height samples, heights and the edges of holes are interpolated bilinearly. Normals are smooth,
/// as in Heightfield; HTerrain bakes normals from the same differences. The border of the map has
/// ground. A field is a snapshot that does not change after `set`, and any thread may read it.
class MapField final : public Terrain {
public:
	static constexpr double min_area = 1e-6; ///< Minimum area between four height samples in square meters.

	/// Shares the maps without copying them. The transform must be finite and not degenerate. The
	/// maps must have at least 2 x 2 height samples, and all layers must have the size of the
	/// heights. Otherwise, the function returns an error and leaves the field unchanged.
	Status set(const MapTransform &transform, const MapLayers &layers);

	/// Returns a copy of the field that is moved by `offset`, in world meters, and shares the maps.
	MapField at_offset(glm::dvec3 offset) const;

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// See Terrain::weigh(). The channels of the splat maps are textures 0 to 3, 4 to 7 and so on;
	/// `indices` contains texture numbers directly. If there are neither splat maps nor indices,
	/// all weights stay at 1. Outside the map, the weight is 0.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Returns two triangles per patch, as in Heightfield. A patch with a hole at one of its height
	/// samples has none.
	const Surface *surface() const override { return surface_.get(); }

	const MapTransform &transform() const { return transform_; }
	const MapLayers &layers() const { return layers_; }

private:
	struct Grid;
	void make_surface();
	glm::ivec2 posts() const { return layers_.heights.size(); }
	bool find_patch(glm::dvec2 position, glm::ivec2 &r_patch, glm::dvec2 &r_part) const;
	Ground ground_at(glm::dvec2 position) const;
	double splat_at(int column, int row, std::span<const unsigned> channels) const;
	double indexed_at(int column, int row, std::span<const std::int32_t> textures) const;

	MapTransform transform_;
	glm::dmat2 to_map_{1.0};
	MapLayers layers_;
	std::shared_ptr<const Surface> surface_;
};

} // namespace thicket
