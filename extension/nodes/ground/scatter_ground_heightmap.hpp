#pragma once

#include "core/heightmap/height_summary.hpp"
#include "core/terrain/heightfield.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/worker_task.hpp"
#include "nodes/ground/heightmap_work.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Ground from a grid of heights in a file, an Image or a Texture2D, with 8, 16 or 32 bits per
/// height. Properties may be set in any order. After a change, a worker rereads the ground during
/// the next frames of a host, and signals report the changed areas. If the ground cannot be read,
/// prints an error and keeps the previous ground.
class ScatterGroundHeightmap : public ScatterGround {
	GDCLASS(ScatterGroundHeightmap, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundHeightmap";

	bool has_textures() const override { return weight_image_.is_valid(); }
	bool has_surfaces() const override { return true; }

	/// Sets a PNG or EXR file, or a raw file of little-endian height samples ("posts") in row-major
	/// order without a header. The size of a raw file determines whether samples are 8-bit or
	/// 16-bit integers or 32-bit floats. The file is ignored if there is an image. A `uid://` is
	/// replaced with the path of its file.
	void set_heightmap_path(const godot::String &p_path);
	godot::String get_heightmap_path() const;

	/// Sets the columns and rows of a raw file, 2 to 32768 each, or (0, 0) for a square. PNG and
	/// EXR files and images specify their own size.
	void set_post_count(const godot::Vector2i &p_count);
	godot::Vector2i get_post_count() const;

	/// Sets an Image or a Texture2D whose first channel contains the heights. It takes priority
	/// over the file.
	void set_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_image() const;

	/// Sets whether float samples are heights in meters. Otherwise they range from 0 at the minimum
	/// height to 1 at the maximum height, like all other formats. NAN is a hole in both cases.
	void set_heights_in_meters(bool p_meters);
	bool is_heights_in_meters() const;

	/// Sets an Image or a Texture2D that covers the same `rect`. Its channels are the weights of
	/// textures 0 to 3.
	void set_weight_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_weight_image() const;

	/// Replaces textures with their images, because a dedicated server export strips textures.
	/// Returns false if there are no textures with pixels.
	bool embed_stripped_data();

	/// Sets the area from the first height sample to the last in world meters; its y is the world's
	/// z.
	void set_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_rect() const;

	/// These setters set the world heights in meters of the lowest and highest possible sample
	/// value, within +-1e6.
	void set_min_height(double p_height);
	double get_min_height() const;
	void set_max_height(double p_height);
	double get_max_height() const;

	/// Rereads the height samples in a rectangle of `image`, in pixels. Ignores the part outside
	/// the image. Call it only on the main thread.
	void update_region(const godot::Rect2i &p_region);

	/// Returns the size, spacing, range and format of the current ground, a thumbnail, and the
	/// problem that keeps the ground from matching the properties. Does not wait for a worker.
	godot::Dictionary get_summary();

	bool has_unapplied_changes() const override { return field_stale_ || task_.busy() || !regions_.empty(); }
	bool is_pending(std::uint64_t /*host*/) const override { return field_stale_ || task_.busy(); }
	void finish_reading() override;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	void follow() override;
	bool start_rereading() override;
	godot::String find_export_problem() override;

private:
	void change() { field_stale_ = true; }
	void image_changed();
	void exchange_image(godot::Ref<godot::Resource> &r_image, const godot::Ref<godot::Resource> &p_image,
			const godot::Ref<godot::Resource> &p_other);
	void start(bool synchronously);
	void take_result();
	void patch_regions(std::chrono::steady_clock::time_point deadline);
	bool patch_band(const PixelRect &band);
	void publish_draft();
	void emit_changes(const std::vector<Rect> &areas, bool is_first_field);
	void set_problem(const godot::String &p_problem);
	godot::String sentence_of(const Status &status, glm::ivec2 refused_post, const godot::String &path) const;

	godot::String heightmap_path_;
	godot::Vector2i post_count_{0, 0};
	godot::Ref<godot::Resource> image_;
	godot::Ref<godot::Resource> weight_image_;
	bool heights_in_meters_ = false;
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	double min_height_ = 0.0;
	double max_height_ = 100.0;

	std::shared_ptr<const Heightfield> field_;
	const char *format_ = "";                      ///< The format of the source of `field_`; see Posts::format.
	std::shared_ptr<const HeightSummary> summary_; ///< The summary of `field_`; null if there is none.
	godot::String problem_;                        ///< Why `field_` does not match the settings; empty if it does.
	bool sources_stale_ = true;
	/// True if `field_` is outdated and no worker is rebuilding it.
	bool field_stale_ = true;
	WorkerTask<HeightmapWork> task_;

	std::vector<PixelRect> regions_; ///< Regions of the image to reread.
	/// A copy of `field_` with the regions that have been reread; null if there are none.
	std::shared_ptr<Heightfield> draft_;
	std::vector<Rect> draft_changes_;
};

} // namespace thicket
