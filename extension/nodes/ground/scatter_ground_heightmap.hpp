#pragma once

#include "core/terrain/heightfield.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/worker_task.hpp"
#include "nodes/ground/heightmap_work.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Ground from a grid of heights: a raw file, an Image or a Texture2D, of 8, 16 or 32 bits. Properties may be set in
/// any order. After a change, a worker reads the ground when a host needs it, and hosts are notified of the changed
/// areas. If the ground cannot be read, prints one error and keeps the previous ground.
class ScatterGroundHeightmap : public ScatterGround {
	GDCLASS(ScatterGroundHeightmap, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundHeightmap";

	bool has_textures() const override { return weight_image_.is_valid(); }

	/// A file of little-endian posts without a header, row by row, x fastest. The file's size determines whether posts
	/// are 8 bits, 16 bits or floats. Ignored if there is an image.
	void set_heightmap_path(const godot::String &p_path);
	godot::String get_heightmap_path() const;

	/// Columns and rows of the file, 2 to 32768 each; 0, 0 if not set. Images have their own size.
	void set_post_count(const godot::Vector2i &p_count);
	godot::Vector2i get_post_count() const;

	/// An Image or a Texture2D, whose first channel contains the heights. Takes priority over the file.
	void set_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_image() const;

	/// If true, posts that are floats are in meters. If false, they range from 0 to 1 between the lowest and the
	/// highest height, like all other formats. NAN is a hole in both cases.
	void set_heights_in_meters(bool p_meters);
	bool is_heights_in_meters() const;

	/// An Image or a Texture2D that covers the same rect. Its channels are the weights of textures 0 to 3.
	void set_weight_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_weight_image() const;

	/// Replaces textures with their images, because an export strips textures. Returns false if there are no textures.
	bool embed_stripped_data();

	/// World meters from the first post to the last: x, and z as y.
	void set_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_rect() const;

	/// World meters of the lowest and of the highest value that a post can have; +-1e6.
	void set_min_height(double p_height);
	double get_min_height() const;
	void set_max_height(double p_height);
	double get_max_height() const;

	/// Rereads the posts of a part of `image`, in pixels. Parts outside the image are left out. Main thread only.
	void update_region(const godot::Rect2i &p_region);

	bool is_behind() const override { return field_stale_ || task_.busy() || !regions_.empty(); }
	bool is_pending(std::uint64_t /*host*/) const override { return field_stale_ || task_.busy(); }
	void finish_reading() override;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	void follow() override;
	bool distrust() override;
	godot::String find_stripped() override;

private:
	void change() { field_stale_ = true; }
	void image_changed();
	void exchange_image(godot::Ref<godot::Resource> &r_image, const godot::Ref<godot::Resource> &p_next,
			const godot::Ref<godot::Resource> &p_other);
	void start(bool at_once);
	void take_built();
	void patch_regions(std::chrono::steady_clock::time_point deadline);
	bool patch_band(const PixelRect &band);
	void end_regions();
	void emit_changes(const std::vector<Rect> &areas, bool everywhere);
	void set_problem(const godot::String &p_problem);
	godot::String sentence_of(const Status &status, glm::ivec2 refused_post) const;

	godot::String heightmap_path_;
	godot::Vector2i post_count_{0, 0};
	godot::Ref<godot::Resource> image_;
	godot::Ref<godot::Resource> weight_image_;
	bool heights_in_meters_ = false;
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	double min_height_ = 0.0;
	double max_height_ = 100.0;

	std::shared_ptr<const Heightfield> field_;
	godot::String problem_; ///< Why `field_` differs from the settings; empty if not.
	bool sources_stale_ = true;
	bool field_stale_ = true; ///< True if `field_` does not match the settings, and no worker is building it.
	WorkerTask<HeightmapWork> task_;

	std::vector<PixelRect> regions_;     ///< Regions of the image that are still to be read.
	std::shared_ptr<Heightfield> draft_; ///< `field_` with the regions already read; null if there are none.
	std::vector<Rect> draft_changes_;
};

} // namespace thicket
