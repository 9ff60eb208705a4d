#include "nodes/ground/heightmap_work.hpp"

#include "core/base/guard.hpp"
#include "nodes/ground/changed_areas.hpp"
#include "nodes/ground/file_posts.hpp"

#include <utility>

using namespace godot;

namespace thicket {

void HeightmapWork::run(const std::atomic<bool> *) {
	status = guarded("posts", 0.0, [this] { return build(); });
	if (!status.ok()) {
		field = nullptr;
	}
	sources.image = Ref<Image>(); // Frees the image here unless it has other owners.
	sources.weight_image = Ref<Image>();
}

/// Builds the heightfield, its changes and, if requested, its summary.
Status HeightmapWork::build() {
	HeightPosts posts;
	WeightMap weights;
	if (sources.are_read || before == nullptr) {
		if (const Status error = read(posts, weights); !error.ok()) {
			return error;
		}
	} else {
		posts = before->posts();
		weights = before->weights();
	}
	posts.meaning = sources.in_meters ? FloatPosts::meters : FloatPosts::units;
	HeightfieldFrame frame = sources.frame;
	frame.posts = posts.count();
	if (posts.steps.empty() && sources.in_meters) {
		frame.min_height = 0.0;
		frame.max_height = 0.0;
	}
	auto heightfield = std::make_shared<Heightfield>();
	Status error = heightfield->set_posts(frame, posts);
	const bool is_reinterpreted = before != nullptr && !sources.are_read && before->posts().meaning != posts.meaning;
	if (error.ok() && is_reinterpreted && !posts.floats.empty()) {
		error = check(posts.floats.flattened(), posts.count());
	}
	if (!error.ok()) {
		return error;
	}
	heightfield->set_weights(std::move(weights));
	std::vector<Rect> areas;
	if (before != nullptr) {
		heightfield->add_changes(*before, areas);
	}
	for (const Rect &area : areas) {
		add_changed_area(changes, area);
	}
	if (needs_summary) {
		auto built_summary = std::make_shared<HeightSummary>();
		error = summarize(*heightfield, *built_summary);
		summary = std::move(built_summary);
	}
	field = std::move(heightfield);
	return error;
}

/// Reads the height samples and the weights from their sources, and checks the samples.
Status HeightmapWork::read(HeightPosts &r_posts, WeightMap &r_weights) {
	Posts source_posts;
	Status error = sources.has_image ? read_posts(sources.image, "image", source_posts)
									 : read_file_posts(sources.path, sources.post_count, source_posts);
	error = error.ok() ? check(source_posts.floats, source_posts.count) : error;
	if (error.ok() && sources.has_weight_image) {
		error = read_weights(sources.weight_image, "weight_image", r_weights);
	}
	if (!error.ok()) {
		return error;
	}
	format = source_posts.format;
	if (source_posts.floats.empty()) {
		r_posts.steps = {
				source_posts.count, std::make_shared<const std::vector<std::uint16_t>>(std::move(source_posts.steps))};
	} else {
		r_posts.floats = {
				source_posts.count, std::make_shared<const std::vector<float>>(std::move(source_posts.floats))};
	}
	return {};
}

Status HeightmapWork::check(std::span<const float> posts, glm::ivec2 count) {
	const FloatPosts meaning = sources.in_meters ? FloatPosts::meters : FloatPosts::units;
	const RefusedPost result = find_refused_post(posts, count.x, meaning);
	if (!result.status.ok()) {
		refused_post = result.post;
	}
	return result.status;
}

} // namespace thicket
