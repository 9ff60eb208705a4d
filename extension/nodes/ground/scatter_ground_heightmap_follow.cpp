// How a heightmap follows its settings: a worker reads them and finds the changes, small regions are read in between, and hosts are
// notified of changed ground.

#include "nodes/ground/scatter_ground_heightmap.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Clock = std::chrono::steady_clock;

/// Posts of a region that are read in one step: a fifth of a millisecond.
constexpr int posts_per_step = 1 << 15;

} // namespace

void ScatterGroundHeightmap::follow() {
	if (task_.finish(false)) {
		take_built();
	} else if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(deadline()); // First, because a worker begins with the current ground.
	} else if (!task_.busy() && field_stale_) {
		start(false);
	}
}

void ScatterGroundHeightmap::finish_reading() {
	if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(Clock::time_point::max());
	}
	// Twice, because a worker may be reading the previous settings. If a script changes further settings when it is
	// notified, they are read later.
	for (int round = 0; round < 2 && (field_stale_ || task_.busy()); ++round) {
		if (!task_.busy()) {
			start(true);
		}
		if (task_.finish(true)) {
			take_built();
		}
	}
	if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(Clock::time_point::max()); // Regions of the ground that a worker was building.
	}
}

void ScatterGroundHeightmap::start(bool at_once) {
	field_stale_ = false;
	HeightmapWork work;
	work.before = field_;
	HeightmapSources &sources = work.sources;
	sources.are_read = std::exchange(sources_stale_, false);
	sources.in_meters = heights_in_meters_;
	sources.frame = {glm::ivec2(0), to_core(rect_), min_height_, max_height_};
	if (sources.are_read) {
		regions_.clear();
		draft_ = nullptr;
		draft_changes_.clear();
		const auto own = [](const Ref<Resource> &p_resource) {
			const Ref<Image> image = image_of(p_resource);
			return image.is_valid() ? Ref<Image>(image->duplicate()) : image;
		};
		sources.has_image = image_.is_valid();
		sources.image = own(image_);
		sources.path = heightmap_path_;
		sources.post_count = {post_count_.x, post_count_.y};
		sources.has_weight_image = weight_image_.is_valid();
		sources.weight_image = own(weight_image_);
	}
	task_.start(std::move(work), at_once);
}

void ScatterGroundHeightmap::take_built() {
	const HeightmapWork work = task_.take();
	if (work.field == nullptr) {
		sources_stale_ = sources_stale_ || work.sources.are_read;
		set_problem(sentence_of(work.status, work.refused_post));
		return;
	}
	const bool first = field_ == nullptr;
	field_ = work.field;
	set_problem({});
	emit_changes(work.changes, first);
}

void ScatterGroundHeightmap::update_region(const Rect2i &p_region) {
	const glm::ivec2 min{p_region.position.x, p_region.position.y};
	const glm::ivec2 size{p_region.size.x, p_region.size.y};
	if (size.x <= 0 || size.y <= 0) {
		ERR_PRINT(vformat("%s.update_region: the size of region must be positive on both axes, got (%d, %d) pixels.",
				class_name, p_region.size.x, p_region.size.y));
		return;
	}
	const Ref<Image> image = image_;
	const bool readable = image.is_valid() && field_ != nullptr && !sources_stale_;
	if (!readable) {
		// A texture, a file and posts that were not read yet are read as a whole, and compared.
		image_changed();
		return;
	}
	const glm::ivec2 count = field_->frame().posts;
	const PixelRect region{glm::clamp(min, glm::ivec2(0), count), glm::clamp(min + size, glm::ivec2(0), count)};
	if (!region.empty()) {
		regions_.push_back(region);
	}
}

bool ScatterGroundHeightmap::distrust() {
	image_changed();
	return true;
}

/// Reads regions in bands of some rows, until the deadline; at least one in each call.
void ScatterGroundHeightmap::patch_regions(Clock::time_point deadline) {
	do {
		PixelRect &region = regions_.back();
		PixelRect band = region;
		band.max.y = std::min(region.max.y, region.min.y + std::max(posts_per_step / region.size().x, 1));
		region.min.y = band.max.y;
		if (region.empty()) {
			regions_.pop_back();
		}
		if (!patch_band(band)) {
			regions_.clear();
			draft_ = nullptr;
			draft_changes_.clear();
			return;
		}
	} while (!regions_.empty() && Clock::now() < deadline);
	if (regions_.empty()) {
		end_regions();
	}
}

/// False if the posts cannot be used. If the image has changed its size or format, it is read as a whole.
bool ScatterGroundHeightmap::patch_band(const PixelRect &band) {
	const Ref<Image> image = image_;
	Posts posts;
	const bool fits =
			has_content(image) && glm::ivec2(image->get_width(), image->get_height()) == field_->frame().posts;
	if (!fits || !read_region(image, band, posts) || posts.floats.empty() != field_->posts().floats.empty()) {
		image_changed();
		return false;
	}
	if (draft_ == nullptr) {
		draft_ = std::make_shared<Heightfield>(*field_);
	}
	const Status status = posts.floats.empty() ? draft_->patch(band, std::span<const std::uint16_t>(posts.steps))
											   : draft_->patch(band, std::span<const float>(posts.floats));
	if (!status.ok()) {
		const RefusedPost refused = find_refused_post(posts.floats, band.size().x, field_->posts().meaning);
		set_problem(sentence_of(status, refused.status.ok() ? glm::ivec2(-1) : band.min + refused.post));
		return false;
	}
	add_changed_area(draft_changes_, draft_->area_of(band));
	return true;
}

void ScatterGroundHeightmap::end_regions() {
	field_ = std::exchange(draft_, nullptr);
	set_problem({});
	emit_changes(std::exchange(draft_changes_, {}), false);
}

/// `everywhere` is true if there was no ground before.
void ScatterGroundHeightmap::emit_changes(const std::vector<Rect> &areas, bool everywhere) {
	const Ref<ScatterGround> held(this); // A script that is notified may release it.
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
	if (everywhere) {
		emit_changed();
	}
}

void ScatterGroundHeightmap::set_problem(const String &p_problem) {
	if (!p_problem.is_empty() && !is_stripped(image_)) { // A stripped image is reported by a node's warning.
		ERR_PRINT(p_problem);
	}
	if (!(problem_ == p_problem)) {
		problem_ = p_problem;
		update_warnings();
	}
}

String ScatterGroundHeightmap::sentence_of(const Status &status, glm::ivec2 refused_post) const {
	const char *property = image_.is_valid() ? "image" : "heightmap_path";
	if (refused_post.x >= 0) {
		const String limits = heights_in_meters_
				? vformat("must be from %d to %d m", static_cast<std::int64_t>(-max_heightfield_height),
						  static_cast<std::int64_t>(max_heightfield_height))
				: String("must be from 0 to 1, or heights_in_meters be set");
		return vformat("%s.%s: the post in column %d of row %d %s (NAN for a hole), got %s. The ground is unchanged.",
				class_name, property, refused_post.x, refused_post.y, limits, status.value);
	}
	Status named = status;
	named.property = std::string_view(status.property) == "posts" ? property : status.property;
	return sentence(class_name, named);
}

} // namespace thicket
