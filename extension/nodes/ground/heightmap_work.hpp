#pragma once

#include "core/terrain/heightfield.hpp"
#include "nodes/ground/image_posts.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/string.hpp>

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The settings of a ScatterGroundHeightmap, for a worker. Its images share the user's memory until either side writes.
struct HeightmapSources {
	bool are_read = false; ///< If false, the posts and the weights of `before` are used.
	godot::Ref<godot::Image> image;
	bool has_image = false; ///< Takes priority over the path.
	godot::String path;
	glm::ivec2 post_count{0}; ///< The size of the file.
	godot::Ref<godot::Image> weight_image;
	bool has_weight_image = false;
	HeightfieldFrame frame; ///< Except for the number of posts, which is that of the posts.
	bool in_meters = false; ///< The unit of floats.
};

/// Builds a heightfield, and finds the areas in which it has changed. Any thread.
struct HeightmapWork {
	HeightmapSources sources;
	std::shared_ptr<const Heightfield> before; ///< Null if there is none.

	Status status;
	glm::ivec2 refused_post{-1};              ///< Column and row of a refused post; below 0 for any other error.
	std::shared_ptr<const Heightfield> field; ///< Null after an error.
	std::vector<Rect> changes;                ///< World meters, few of them: the field equals `before` everywhere else.

	void run(const std::atomic<bool> *cancel);

private:
	Status build();
	Status read(HeightPosts &r_posts, WeightMap &r_weights);
	Status read_file(Posts &r_posts) const;
	Status check(std::span<const float> posts, glm::ivec2 count);
};

} // namespace thicket
