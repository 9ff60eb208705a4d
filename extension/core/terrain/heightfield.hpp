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

/// Where the posts of a heightfield stand and what 16 bits mean.
struct HeightfieldFrame {
	glm::ivec2 posts{0};     ///< Columns along x and rows along z (Rect.y), 2 to max_heightfield_posts each.
	Rect area;               ///< World meters from the first post to the last; finite, min_post_spacing between posts.
	double min_height = 0.0; ///< World meters of a post of 0; at most max_heightfield_height either side of 0.
	double max_height = 1.0; ///< World meters of a post of 65535; at least min_height, same limits.

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

/// What posts that are floats mean.
enum class FloatPosts : std::uint8_t {
	meters, ///< World meters, at most max_heightfield_height either side of 0.
	units,  ///< 0 to 1: from the lowest to the highest height.
};

/// The posts of a heightfield: one of both grids. A value, as they are.
struct HeightPosts {
	PostGrid<std::uint16_t> steps; ///< 0 to 65535: from the lowest to the highest height.
	PostGrid<float> floats;        ///< NAN for holes.
	FloatPosts meaning = FloatPosts::meters;

	glm::ivec2 count() const { return steps.empty() ? floats.count() : steps.count(); }
};

/// The first post of some that a heightfield refuses, row by row in rows of `columns`; where there is none, ErrorCode::none.
struct RefusedPost {
	Status status;
	glm::ivec2 post{0}; ///< Column and row.
};
RefusedPost find_refused_post(std::span<const float> posts, int columns, FloatPosts meaning);

/// Terrain from a grid of posts, of 16 bits or of meters. Between four posts the height is bilinear, the very surface
/// that `sample` gives at any finer spacing; a mesh that is drawn from it has to ask here, not at the posts alone.
///
/// Normals are smooth: the gradients of the four posts, by central differences (one-sided on the border), weighted
/// bilinearly. The gradient of the bilinear patch itself jumps at each line of posts, which would show as straight
/// edges wherever a slope rule cuts a forest off. On an inclined plane both are the same.
///
/// Posts of NAN are holes: there is no ground between four posts if one of them is NAN, and a gradient beside a hole is
/// one-sided as on the border. Ground that two patches share belongs to the one with the larger x and z.
class Heightfield final : public Terrain {
public:
	/// Copies `posts`, row by row from area.min, x fastest. Refuses a frame outside the ranges above or a span whose
	/// length is not posts.x * posts.y, and then keeps the field as it was.
	Status set(const HeightfieldFrame &frame, std::span<const std::uint16_t> posts);

	/// As above, of posts in world meters, at most max_heightfield_height either side of 0, or NAN. The frame's heights say
	/// nothing then.
	Status set_meters(const HeightfieldFrame &frame, std::span<const float> posts);

	/// The same of posts that are shared and not copied, so that only those are read that are floats. Heights of the frame count
	/// for all but meters.
	Status set_posts(const HeightfieldFrame &frame, const HeightPosts &posts);

	/// Replaces the posts of a rectangle, row by row; copies of the field keep theirs. Refuses posts of the kind that the field has not,
	/// a rectangle that is empty or not within, another number of posts and values out of their range; a failure changes nothing.
	/// The cost does not grow with the field.
	Status patch(const PixelRect &rect, std::span<const std::uint16_t> posts);
	Status patch(const PixelRect &rect, std::span<const float> posts);

	/// Adds where this is other ground than `before`, as rectangles of the world: around posts and weights that differ, or all of
	/// both areas where frames or kinds of posts differ. Throws std::bad_alloc.
	void add_changes(const Heightfield &before, std::vector<Rect> &r_areas) const;

	/// Where ground depends on the posts of a rectangle, slopes included, in world meters.
	Rect area_of(const PixelRect &rect) const;

	/// Weights of the ground's textures over the field's area, first to last post; without any, `weigh` allows all ground. They
	/// stay when posts are set.
	void set_weights(WeightMap weights) { weights_ = std::move(weights); }

	/// As Terrain::sample. The border belongs to the field; what lies outside has no ground, as has a field that was
	/// never set. The same position gives the same bits from any tile. A height is computed in double and rounded to
	/// float once.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// As Terrain::weigh: the channels of the weights are textures 0 to 3, others weigh 0. What lies outside weighs 0.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	const HeightfieldFrame &frame() const { return frame_; }
	const HeightPosts &posts() const { return posts_; }
	const WeightMap &weights() const { return weights_; }

private:
	Status check_patch(const PixelRect &rect, std::size_t posts, bool fits) const;
	bool in_area(glm::dvec2 position) const;

	/// Where a position of the area lies: in the patch with this first post, and so much of the way to its last one.
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
	double meters_per_step_ = 0.0; ///< A step is the difference of 1 between two posts.
	WeightMap weights_;
};

} // namespace thicket
