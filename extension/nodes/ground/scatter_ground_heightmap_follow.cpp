// This file applies changes to a ScatterGroundHeightmap. A worker rereads the ground and finds the
// changed areas. Between these jobs, the main thread rereads small regions. Signals report changed
// ground.

#include "nodes/ground/scatter_ground_heightmap.hpp"

#include "core/base/guard.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Clock = std::chrono::steady_clock;

/// The number of height samples of a region to read per step, which takes about 0.2 ms.
constexpr int posts_per_step = 1 << 15;

/// The time that a summary without a host may spend on rereading regions.
constexpr std::chrono::milliseconds summary_time{2};

} // namespace

void ScatterGroundHeightmap::follow() {
	if (task_.finish(false)) {
		take_result();
	} else if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(deadline()); // Do this first, because workers start from the current ground.
	} else if (!task_.busy() && field_stale_) {
		start(false);
	}
}

void ScatterGroundHeightmap::finish_reading() {
	if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(Clock::time_point::max());
	}
	// Run at most two rounds, because a worker may still be reading the previous settings. Settings
	// that signal handlers change during this loop are read later.
	for (int round = 0; round < 2 && (field_stale_ || task_.busy()); ++round) {
		if (!task_.busy()) {
			start(true);
		}
		if (task_.finish(true)) {
			take_result();
		}
	}
	if (!task_.busy() && !regions_.empty() && !sources_stale_) {
		patch_regions(Clock::time_point::max()); // Patches the regions that waited for the worker.
	}
}

/// Starts a worker that reads changed sources and rebuilds the ground.
void ScatterGroundHeightmap::start(bool synchronously) {
	field_stale_ = false;
	HeightmapWork work;
	work.before = field_;
	work.needs_summary = Engine::get_singleton()->is_editor_hint();
	HeightmapSources &sources = work.sources;
	sources.are_read = std::exchange(sources_stale_, false);
	sources.in_meters = heights_in_meters_;
	sources.frame = {glm::ivec2(0), to_core(rect_), min_height_, max_height_};
	if (sources.are_read) {
		regions_.clear();
		draft_ = nullptr;
		draft_changes_.clear();
		const auto copy_image = [](const Ref<Resource> &p_resource) {
			const Ref<Image> image = image_of(p_resource);
			return image.is_valid() ? Ref<Image>(image->duplicate()) : image;
		};
		sources.has_image = image_.is_valid();
		sources.image = copy_image(image_);
		sources.path = heightmap_path_;
		sources.post_count = {post_count_.x, post_count_.y};
		sources.has_weight_image = weight_image_.is_valid();
		sources.weight_image = copy_image(weight_image_);
	}
	task_.start(std::move(work), synchronously);
}

/// Replaces the ground with the result of the worker. After an error, keeps the previous ground.
void ScatterGroundHeightmap::take_result() {
	const HeightmapWork work = task_.take();
	if (work.field == nullptr) {
		sources_stale_ = sources_stale_ || work.sources.are_read;
		set_problem(sentence_of(work.status, work.refused_post, work.sources.path));
		return;
	}
	const bool is_first_field = field_ == nullptr;
	field_ = work.field;
	summary_ = work.summary;
	format_ = work.sources.are_read ? work.format : format_;
	set_problem({});
	emit_changes(work.changes, is_first_field);
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
	const bool can_patch = image.is_valid() && field_ != nullptr && !sources_stale_;
	if (!can_patch) {
		// Textures, files and unread images are reread completely and compared.
		image_changed();
		return;
	}
	const glm::ivec2 count = field_->frame().posts;
	const PixelRect region{glm::clamp(min, glm::ivec2(0), count), glm::clamp(min + size, glm::ivec2(0), count)};
	if (!region.empty()) {
		regions_.push_back(region);
	}
}

bool ScatterGroundHeightmap::start_rereading() {
	image_changed();
	return true;
}

/// Rereads regions in bands of rows until the deadline, but at least one band.
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
		publish_draft();
	}
}

/// Rereads a band of rows. Returns false if its height samples cannot be used. If the size or
/// format of the image has changed, schedules a complete reread.
bool ScatterGroundHeightmap::patch_band(const PixelRect &band) {
	const Ref<Image> image = image_;
	Posts posts;
	const bool same_size =
			has_content(image) && glm::ivec2(image->get_width(), image->get_height()) == field_->frame().posts;
	if (!same_size || !read_region(image, band, posts) || posts.floats.empty() != field_->posts().floats.empty()) {
		image_changed();
		return false;
	}
	if (draft_ == nullptr) {
		draft_ = std::make_shared<Heightfield>(*field_);
	}
	const Status status = posts.floats.empty() ? draft_->patch(band, std::span<const std::uint16_t>(posts.steps))
											   : draft_->patch(band, std::span<const float>(posts.floats));
	if (!status.ok()) {
		const RefusedPost rejection = find_refused_post(posts.floats, band.size().x, field_->posts().meaning);
		set_problem(sentence_of(status, rejection.status.ok() ? glm::ivec2(-1) : band.min + rejection.post, {}));
		return false;
	}
	add_changed_area(draft_changes_, draft_->area_of(band));
	return true;
}

/// Replaces the ground with the patched draft and emits signals.
void ScatterGroundHeightmap::publish_draft() {
	field_ = std::exchange(draft_, nullptr);
	summary_ = nullptr;
	set_problem({});
	emit_changes(std::exchange(draft_changes_, {}), false);
}

/// Emits signals for changed areas. `is_first_field` is true if there was no ground before.
void ScatterGroundHeightmap::emit_changes(const std::vector<Rect> &areas, bool is_first_field) {
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
	if (is_first_field) {
		emit_changed();
	}
}

Dictionary ScatterGroundHeightmap::get_summary() {
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	if (image_.is_valid() || !heightmap_path_.is_empty()) {
		follow_scene(Clock::now() + summary_time); // Without a host, nothing else starts a worker.
	}
	Dictionary result;
	result["problem"] = find_problem();
	if (field_ == nullptr) {
		return result;
	}
	if (summary_ == nullptr) {
		auto new_summary = std::make_shared<HeightSummary>();
		throw_if_out_of_memory(summarize(*field_, *new_summary));
		summary_ = std::move(new_summary);
	}
	const HeightSummary &summary = *summary_;
	const glm::ivec2 size = summary.thumbnail_size;
	const glm::ivec2 posts = field_->frame().posts;
	const glm::dvec2 spacing = field_->frame().area.size() / glm::dvec2(posts - 1);
	PackedByteArray pixels;
	std::ranges::copy(summary.thumbnail, resize(pixels, static_cast<std::int64_t>(summary.thumbnail.size())).begin());
	result["size"] = Vector2i(posts.x, posts.y);
	result["spacing"] = Vector2(static_cast<real_t>(spacing.x), static_cast<real_t>(spacing.y));
	result["lowest"] = summary.lowest;
	result["highest"] = summary.highest;
	result["format"] = format_;
	result["thumbnail"] = Image::create_from_data(size.x, size.y, false, Image::FORMAT_LA8, pixels);
	return result;
}

void ScatterGroundHeightmap::set_problem(const String &p_problem) {
	// A stripped image needs no error, because a node's warning reports it.
	if (!p_problem.is_empty() && !is_stripped(image_)) {
		ERR_PRINT(p_problem);
	}
	if (!(problem_ == p_problem)) {
		problem_ = p_problem;
		update_warnings();
	}
}

/// Returns a message about an error. `path` is the file that was read, if any.
String ScatterGroundHeightmap::sentence_of(const Status &status, glm::ivec2 refused_post, const String &path) const {
	const char *property = image_.is_valid() ? "image" : "heightmap_path";
	const String file = image_.is_valid() || path.is_empty() ? String() : " (" + path + ")";
	if (refused_post.x >= 0) {
		const String limits = heights_in_meters_
				? vformat("must be from %d to %d m", static_cast<std::int64_t>(-max_heightfield_height),
						  static_cast<std::int64_t>(max_heightfield_height))
				: String("must be from 0 to 1 unless heights_in_meters is set");
		return vformat("%s.%s: the height sample in column %d of row %d %s (NAN for a hole), got %s. The "
					   "ground is unchanged.",
					   class_name, property, refused_post.x, refused_post.y, limits, status.value) +
				file;
	}
	Status named_status = status;
	named_status.property = std::string_view(status.property) == "posts" ? property : status.property;
	return sentence(class_name, named_status) + file;
}

} // namespace thicket
