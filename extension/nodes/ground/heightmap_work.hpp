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

/// What a ScatterGroundHeightmap was given, for a worker: its images are the worker's own, and share the memory of the user's until
/// either writes.
struct HeightmapSources {
	bool are_read = false; ///< Else the posts and the weights of `before` count.
	godot::Ref<godot::Image> image;
	bool has_image = false; ///< It goes before the path.
	godot::String path;
	glm::ivec2 post_count{0}; ///< Of the file.
	godot::Ref<godot::Image> weight_image;
	bool has_weight_image = false;
	HeightfieldFrame frame; ///< But for the number of posts, which is that of the posts.
	bool in_meters = false; ///< What floats mean.
};

/// Makes a heightfield, and finds where it is not as it was. On any thread.
struct HeightmapWork {
	HeightmapSources sources;
	std::shared_ptr<const Heightfield> before; ///< Null for none.

	Status status;
	glm::ivec2 refused_post{-1}; ///< Column and row of a post that was refused; below 0 for any other error.
	std::shared_ptr<const Heightfield> field; ///< Null after an error.
	std::vector<Rect> changes;                ///< World meters, few of them: `before` is the same everywhere else.

	void run(const std::atomic<bool> *cancel);

private:
	Status build();
	Status read(HeightPosts &r_posts, WeightMap &r_weights);
	Status read_file(Posts &r_posts) const;
	Status check(std::span<const float> posts, glm::ivec2 count);
};

} // namespace thicket
