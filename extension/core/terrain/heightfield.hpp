#pragma once

#include "core/base/rect.hpp"
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
};

inline constexpr int max_heightfield_posts = 1 << 15;
inline constexpr double max_heightfield_height = 1e6;
inline constexpr double min_post_spacing = 1e-3; ///< Meters, on both axes.

/// Refuses a frame outside the ranges above.
Status validate(const HeightfieldFrame &frame);

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

private:
	void take(const HeightfieldFrame &frame, double base, double meters_per_step);
	bool in_area(glm::dvec2 position) const;

	/// Where a position of the area lies: in the patch with this first post, and so much of the way to its last one.
	struct Patch {
		glm::ivec2 first;
		glm::dvec2 part;
	};
	Patch patch_at(glm::dvec2 position) const;
	void sample_posts(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	template <typename Post>
	Ground ground_in_area(const std::vector<Post> &posts, glm::dvec2 position) const;

	HeightfieldFrame frame_;
	std::vector<std::uint16_t> posts_; ///< Or:
	std::vector<float> meters_;
	glm::dvec2 posts_per_meter_{0.0};
	double base_ = 0.0;            ///< World meters of a post of 0.
	double meters_per_step_ = 0.0; ///< A step is the difference of 1 between two posts.
	WeightMap weights_;
};

} // namespace thicket
