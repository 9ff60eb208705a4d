#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/terrain/post_grid.hpp"
#include "core/terrain/terrain.hpp"
#include "core/terrain/weight_map.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// The position of a heightfield's posts and the meaning of 16-bit values.
struct HeightfieldFrame {
	glm::ivec2 posts{0};     ///< Columns along x and rows along z (Rect.y), 2 to max_heightfield_posts each.
	Rect area;               ///< World meters from first to last post; finite, min_post_spacing or more between posts.
	double min_height = 0.0; ///< World meters of a post of 0, at most max_heightfield_height above or below 0.
	double max_height = 1.0; ///< World meters of a post of 65535, at least min_height, same limits.

	bool operator==(const HeightfieldFrame &other) const {
		return posts == other.posts && area.min == other.area.min && area.max == other.area.max &&
				min_height == other.min_height && max_height == other.max_height;
	}
};

inline constexpr int max_heightfield_posts = 1 << 15;
inline constexpr double max_heightfield_height = 1e6;
inline constexpr double min_post_spacing = 1e-3; ///< Meters, on both axes.

/// Refuses a frame outside the ranges above.
Status validate(const HeightfieldFrame &frame);

/// The meaning of float posts.
enum class FloatPosts : std::uint8_t {
	meters, ///< World meters, at most max_heightfield_height above or below 0.
	units,  ///< 0 to 1, from the lowest to the highest height.
};

/// The posts of a heightfield, in one of the two grids. A value type, like the grids.
struct HeightPosts {
	PostGrid<std::uint16_t> steps; ///< 0 to 65535, from the lowest to the highest height.
	PostGrid<float> floats;        ///< NAN for holes.
	FloatPosts meaning = FloatPosts::meters;

	glm::ivec2 count() const { return steps.empty() ? floats.count() : steps.count(); }
};

/// The first post that a heightfield refuses, searched row by row in rows of `columns`. ErrorCode::none if there is none.
struct RefusedPost {
	Status status;
	glm::ivec2 post{0}; ///< Column and row.
};
RefusedPost find_refused_post(std::span<const float> posts, int columns, FloatPosts meaning);

/// Terrain from a grid of posts, stored as 16 bits or as meters. The height between four posts is bilinear, which is exactly the surface
/// that `sample` returns at any finer spacing. A mesh drawn from the terrain must sample it here, not only at the posts.
///
/// Normals are smooth: the gradients of the four posts, by central differences (one-sided on the border), weighted bilinearly. The
/// gradient of the bilinear patch itself jumps at each line of posts, which would show as straight edges where a slope rule ends a
/// forest. On an inclined plane both are equal.
///
/// Posts of NAN are holes: there is no ground between four posts if one of them is NAN, and a gradient beside a hole is one-sided as on
/// the border. Ground shared by two patches belongs to the one with the larger x and z.
class Heightfield final : public Terrain {
public:
	/// Copies `posts`, row by row from area.min, x fastest. Refuses a frame outside the ranges above, or a span whose length is not
	/// posts.x * posts.y. The field is then unchanged.
	Status set(const HeightfieldFrame &frame, std::span<const std::uint16_t> posts);

	/// Copies posts in world meters, at most max_heightfield_height above or below 0, or NAN. Ignores the frame's heights.
	Status set_meters(const HeightfieldFrame &frame, std::span<const float> posts);

	/// Shares posts without copying them. Only float posts are read and checked. The frame's heights apply to all posts
	/// but those in meters.
	Status set_posts(const HeightfieldFrame &frame, const HeightPosts &posts);

	/// Replaces the posts of a rectangle, row by row. Copies of the field keep theirs. Refuses posts of the kind that the field does not
	/// use, a rectangle that is empty or not inside the field, a wrong number of posts, and values out of range. A failure changes
	/// nothing. The cost does not grow with the field.
	Status patch(const PixelRect &rect, std::span<const std::uint16_t> posts);
	Status patch(const PixelRect &rect, std::span<const float> posts);

	/// Adds the world rectangles where the ground differs from `before`: around posts and weights that differ, or all of both areas if
	/// frames or kinds of posts differ. Throws std::bad_alloc.
	void add_changes(const Heightfield &before, std::vector<Rect> &r_areas) const;

	/// The area, in world meters, whose ground depends on the posts of a rectangle, including slopes.
	Rect area_of(const PixelRect &rect) const;

	/// Sets the weights of the ground's textures over the field's area, first to last post. Without weights, `weigh` permits all ground.
	/// The field keeps its weights when posts are set.
	void set_weights(WeightMap weights) { weights_ = std::move(weights); }

	/// See Terrain::sample. The border belongs to the field. Outside there is no ground, nor in a field that was never set. The same
	/// position returns the same bits from any tile. A height is computed in double precision and rounded to float once.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// See Terrain::weigh. The channels of the weights are textures 0 to 3. Other textures and positions outside weigh 0.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	const HeightfieldFrame &frame() const { return frame_; }
	const HeightPosts &posts() const { return posts_; }
	const WeightMap &weights() const { return weights_; }

private:
	Status check_patch(const PixelRect &rect, std::size_t posts, bool fits) const;
	bool in_area(glm::dvec2 position) const;

	/// The patch of a position: the first post of the patch, and the fraction of the way to its last post.
	struct Patch {
		glm::ivec2 first;
		glm::dvec2 part;
	};
	Patch patch_at(glm::dvec2 position) const;
	void sample_posts(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	template <typename Post, class HeightOf>
	Ground ground_in_area(const PostGrid<Post> &posts, const HeightOf &height_of, glm::dvec2 position) const;

	HeightfieldFrame frame_;
	HeightPosts posts_;
	glm::dvec2 posts_per_meter_{0.0};
	double base_ = 0.0;            ///< World meters of a post of 0.
	double meters_per_step_ = 0.0; ///< A step is a difference of 1 between two posts.
	WeightMap weights_;
};

} // namespace thicket
