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

Status HeightmapWork::build() {
	HeightPosts posts;
	WeightMap weights;
	if (sources.are_read || before == nullptr) {
		if (const Status refused = read(posts, weights); !refused.ok()) {
			return refused;
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
	Status refused = heightfield->set_posts(frame, posts);
	const bool reinterpreted = before != nullptr && !sources.are_read && before->posts().meaning != posts.meaning;
	if (refused.ok() && reinterpreted && !posts.floats.empty()) {
		refused = check(posts.floats.flattened(), posts.count());
	}
	if (!refused.ok()) {
		return refused;
	}
	heightfield->set_weights(std::move(weights));
	std::vector<Rect> areas;
	if (before != nullptr) {
		heightfield->add_changes(*before, areas);
	}
	for (const Rect &area : areas) {
		add_changed_area(changes, area);
	}
	if (summarizes) {
		auto own = std::make_shared<HeightSummary>();
		refused = summarize(*heightfield, *own);
		summary = std::move(own);
	}
	field = std::move(heightfield);
	return refused;
}

Status HeightmapWork::read(HeightPosts &r_posts, WeightMap &r_weights) {
	Posts read;
	Status refused = sources.has_image ? read_posts(sources.image, "image", read)
									   : read_file_posts(sources.path, sources.post_count, read);
	refused = refused.ok() ? check(read.floats, read.count) : refused;
	if (refused.ok() && sources.has_weight_image) {
		refused = read_weights(sources.weight_image, "weight_image", r_weights);
	}
	if (!refused.ok()) {
		return refused;
	}
	format = read.format;
	if (read.floats.empty()) {
		r_posts.steps = {read.count, std::make_shared<const std::vector<std::uint16_t>>(std::move(read.steps))};
	} else {
		r_posts.floats = {read.count, std::make_shared<const std::vector<float>>(std::move(read.floats))};
	}
	return {};
}

Status HeightmapWork::check(std::span<const float> posts, glm::ivec2 count) {
	const FloatPosts meaning = sources.in_meters ? FloatPosts::meters : FloatPosts::units;
	const RefusedPost refused = find_refused_post(posts, count.x, meaning);
	if (!refused.status.ok()) {
		refused_post = refused.post;
	}
	return refused.status;
}

} // namespace thicket
