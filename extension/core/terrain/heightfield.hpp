#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/terrain/post_grid.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"
#include "core/terrain/weight_map.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// The layout of a heightfield's height samples (called "posts" in the code) and the heights that
/// 16-bit values represent.
struct HeightfieldFrame {
	glm::ivec2 posts{0}; ///< Columns along x and rows along z (Rect.y), min_ to max_heightfield_posts each.
	/// World meters from the first to the last height sample; finite, with samples at least
	/// min_post_spacing apart.
	Rect area;
	double min_height = 0.0; ///< World height in meters of the value 0, within +-max_heightfield_height.
	double max_height = 1.0; ///< World height in meters of the value 65535, at least min_height, same limits.

	bool operator==(const HeightfieldFrame &other) const {
		return posts == other.posts && area.min == other.area.min && area.max == other.area.max &&
				min_height == other.min_height && max_height == other.max_height;
	}
};

inline constexpr int min_heightfield_posts = 2;
inline constexpr int max_heightfield_posts = 1 << 15;
inline constexpr double max_heightfield_height = 1e6;
inline constexpr double min_post_spacing = 1e-3; ///< The minimum distance between samples in meters, on both axes.

/// Returns an error if a value of the frame is out of range.
Status validate(const HeightfieldFrame &frame);

/// The meaning of float height samples.
enum class FloatPosts : std::uint8_t {
	meters, ///< World heights in meters, within +-max_heightfield_height.
	units,  ///< 0 to 1, from the frame's min_height to its max_height.
};

/// The height samples of a heightfield, in one of two grids. The other grid is empty. Copies share
/// memory, like copies of a grid.
struct HeightPosts {
	PostGrid<std::uint16_t> steps; ///< 0 to 65535, from the frame's min_height to its max_height.
	PostGrid<float> floats;        ///< Heights in meters, or fractions of the height range; NAN for holes.
	FloatPosts meaning = FloatPosts::meters;

	glm::ivec2 count() const { return steps.empty() ? floats.count() : steps.count(); }
};

/// The first invalid height sample of a heightfield. The status is ok if all samples are valid.
struct RefusedPost {
	Status status;
	glm::ivec2 post{0}; ///< Column and row of the height sample.
};

/// Finds the first invalid height sample, row by row. `columns` is the length of a row.
RefusedPost find_refused_post(std::span<const float> posts, int columns, FloatPosts meaning);

/// Terrain from a grid of height samples, stored as 16-bit integers or as floats. Heights between
/// four samples are interpolated bilinearly. A mesh that draws this surface must get its heights
/// from `sample`, not only from the stored samples.
///
/// Normals are smooth: the gradients at the four height samples, from central differences
/// (one-sided at the border), are interpolated bilinearly. The gradient of the bilinear patch
/// itself would jump at each line of samples. A forest that is limited by a slope rule would then
/// have straight edges. On an inclined plane, both gradients are equal.
///
/// A height sample of NAN is a hole: there is no ground between four samples if one of them is NAN.
/// Gradients next to a hole are one-sided, as at the border. Ground on the edge between two patches
/// belongs to the patch with the larger x or z.
class Heightfield final : public Terrain {
public:
	/// Copies `posts`, row by row from area.min. Returns an error, with the field unchanged, if the
	/// frame is invalid or the number of height samples is not frame.posts.x * frame.posts.y.
	Status set(const HeightfieldFrame &frame, std::span<const std::uint16_t> posts);

	/// Copies `posts` as `set` does, but in world meters, within +-max_heightfield_height, or NAN.
	/// The frame's heights must be valid but have no effect.
	Status set_meters(const HeightfieldFrame &frame, std::span<const float> posts);

	/// Shares `posts` without copying or checking their values. The frame's heights apply to all
	/// height samples except those in meters.
	Status set_posts(const HeightfieldFrame &frame, const HeightPosts &posts);

	/// Replaces the height samples of a rectangle; `posts` lists them row by row. Copies of the
	/// field are not affected. The samples must be of the kind that the field stores, with valid
	/// values, and the rectangle must be inside the field and not empty. Otherwise, the function
	/// returns an error and leaves the field unchanged. The cost does not depend on the size of the
	/// field.
	Status patch(const PixelRect &rect, std::span<const std::uint16_t> posts);
	Status patch(const PixelRect &rect, std::span<const float> posts);

	/// Appends the world rectangles in which the ground differs from `before`: the surroundings of
	/// height samples and weights that differ. If the frames or the kinds of samples differ, the
	/// areas of both fields are appended. Throws std::bad_alloc.
	void add_changes(const Heightfield &before, std::vector<Rect> &r_areas) const;

	/// Returns the area, in world meters, whose heights or slopes depend on the height samples of a
	/// rectangle.
	Rect area_of(const PixelRect &rect) const;

	/// Sets the weights of the ground textures, which cover the area from the first to the last
	/// height sample. Without weights, `weigh` leaves all weights at 1. Setting samples keeps the
	/// weights.
	void set_weights(WeightMap weights) { weights_ = std::move(weights); }

	/// See Terrain::sample(). The border belongs to the field. There is no ground outside, or in a
	/// field that was never set. Equal positions produce bit-identical results, regardless of the
	/// tile. Heights are computed in double precision and rounded to float once.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// See Terrain::weigh(). Textures 0 to 3 are the channels of the weights. For other textures,
	/// and outside the area, the weight is 0.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Returns a surface of two triangles per patch, like a mesh with a vertex for each height
	/// sample. In a twisted patch, they differ a little from the heights of `sample`. Returns null
	/// for a field that was never set.
	const Surface *surface() const override { return surface_.get(); }

	/// Returns the height of a sample in world meters; NAN for a hole. `post` must be in the field.
	double post_height(glm::ivec2 post) const;

	const HeightfieldFrame &frame() const { return frame_; }
	const HeightPosts &posts() const { return posts_; }
	const WeightMap &weights() const { return weights_; }

private:
	struct Grid;
	void take(HeightPosts posts);
	Status check_patch(const PixelRect &rect, std::size_t posts, bool type_matches) const;
	bool in_area(glm::dvec2 position) const;

	/// A patch and a position in it: the first height sample, and the fraction of the way to the
	/// last sample on each axis.
	struct Patch {
		glm::ivec2 first;
		glm::dvec2 fraction;
	};
	Patch patch_at(glm::dvec2 position) const;
	void sample_posts(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	template <typename Post, class HeightOf>
	Ground ground_in_area(const PostGrid<Post> &posts, const HeightOf &height_of, glm::dvec2 position) const;

	HeightfieldFrame frame_;
	HeightPosts posts_;
	glm::dvec2 posts_per_meter_{0.0};
	double base_ = 0.0;            ///< World height in meters of a stored value of 0.
	double meters_per_step_ = 0.0; ///< Meters per unit of a stored value.
	WeightMap weights_;
	std::shared_ptr<const Surface> surface_;
};

} // namespace thicket
