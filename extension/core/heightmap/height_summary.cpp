#include "core/heightmap/height_summary.hpp"

#include "core/base/guard.hpp"
#include "core/terrain/heightfield.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

void find_range(const Heightfield &field, HeightSummary &r_summary) {
	constexpr double inf = std::numeric_limits<double>::infinity();
	double lowest = inf;
	double highest = -inf;
	const glm::ivec2 count = field.frame().posts;
	for (glm::ivec2 post{0}; post.y < count.y; ++post.y) {
		for (post.x = 0; post.x < count.x; ++post.x) {
			const double height = field.post_height(post);
			lowest = height < lowest ? height : lowest; // Skips NAN.
			highest = height > highest ? height : highest;
		}
	}
	const bool any = lowest <= highest;
	r_summary.lowest = any ? lowest : std::numeric_limits<double>::quiet_NaN();
	r_summary.highest = any ? highest : std::numeric_limits<double>::quiet_NaN();
}

void draw_thumbnail(const Heightfield &field, HeightSummary &r_summary) {
	const glm::ivec2 count = field.frame().posts;
	const double scale = std::min(1.0, max_thumbnail_side / static_cast<double>(std::max(count.x, count.y)));
	const glm::ivec2 size = glm::max(glm::ivec2(glm::dvec2(count) * scale), glm::ivec2(1));
	r_summary.thumbnail_size = size;
	r_summary.thumbnail.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * 2);
	const double range = r_summary.highest - r_summary.lowest;
	for (glm::ivec2 pixel{0}; pixel.y < size.y; ++pixel.y) {
		for (pixel.x = 0; pixel.x < size.x; ++pixel.x) {
			const glm::ivec2 post((glm::dvec2(pixel) + 0.5) * glm::dvec2(count) / glm::dvec2(size));
			const double height = field.post_height(glm::min(post, count - 1));
			const bool hole = std::isnan(height);
			const double gray = hole || range <= 0.0 ? 0.0 : (height - r_summary.lowest) / range * 255.0;
			r_summary.thumbnail.push_back(static_cast<std::uint8_t>(gray + 0.5));
			r_summary.thumbnail.push_back(hole ? 0 : 255);
		}
	}
}

} // namespace

Status summarize(const Heightfield &field, HeightSummary &r_summary) {
	return guarded("summary", static_cast<double>(field.frame().posts.x), [&] {
		HeightSummary summary{};
		find_range(field, summary);
		draw_thumbnail(field, summary);
		r_summary = std::move(summary);
	});
}

} // namespace thicket
