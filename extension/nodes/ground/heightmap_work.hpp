#pragma once

#include "core/heightmap/height_summary.hpp"
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

/// The settings of a ScatterGroundHeightmap for a worker. The images share the memory of the
/// originals until either is written to.
struct HeightmapSources {
	bool are_read = false; ///< If false, reuses the height samples and weights of `before`.
	godot::Ref<godot::Image> image;
	bool has_image = false; ///< If true, `image` takes priority over `path`.
	godot::String path;
	glm::ivec2 post_count{0}; ///< The columns and rows of a raw file, or (0, 0).
	godot::Ref<godot::Image> weight_image;
	bool has_weight_image = false;
	HeightfieldFrame frame; ///< Everything except the number of height samples.
	bool in_meters = false; ///< True if float samples are heights in meters.
};

/// Builds a heightfield and finds the areas in which it has changed. Any thread may use it.
struct HeightmapWork {
	HeightmapSources sources;
	std::shared_ptr<const Heightfield> before; ///< Null if there is none.
	bool needs_summary = false;                ///< If true, also builds `summary`.

	Status status;
	glm::ivec2 refused_post{-1};              ///< Column and row; negative if no height sample was rejected.
	std::shared_ptr<const Heightfield> field; ///< Null after an error.
	std::shared_ptr<const HeightSummary> summary;
	const char *format = ""; ///< See Posts::format; empty if the sources were not read.
	/// The areas, in world meters, outside which the field equals `before`. See add_changed_area
	/// for how they are merged.
	std::vector<Rect> changes;

	void run(const std::atomic<bool> *cancel);

private:
	Status build();
	Status read(HeightPosts &r_posts, WeightMap &r_weights);
	Status check(std::span<const float> posts, glm::ivec2 count);
};

} // namespace thicket
