#pragma once

#include "core/terrain/heightfield.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/terrain/image_posts.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector2i.hpp>

namespace thicket {

/// Ground from a grid of heights: a raw file, an Image or a Texture2D, of 8, 16 or 32 bits. Properties may be set in
/// any order; the ground is read when it is first needed after a change. What cannot be read prints one error, and the
/// ground stays what it was.
class ScatterTerrainHeightmap : public ScatterTerrain {
	GDCLASS(ScatterTerrainHeightmap, ScatterTerrain)
	THICKET_GUARDED_METHODS

public:
	bool has_textures() const override { return weight_image_.is_valid(); }

	/// A file of little-endian posts without a header, row by row, x fastest: of 8 bits, 16 bits or floats, which its
	/// size tells. Used where there is no image.
	void set_heightmap_path(const godot::String &p_path);
	godot::String get_heightmap_path() const;

	/// Columns and rows of the file, 2 to 32768 each; 0, 0 for none given. An image knows its own.
	void set_post_count(const godot::Vector2i &p_count);
	godot::Vector2i get_post_count() const;

	/// An Image or a Texture2D, whose first channel holds the heights. Goes before the file.
	void set_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_image() const;

	/// What posts that are floats mean: meters, or 0 to 1 between the lowest and the highest height as all others do.
	/// NAN is a hole in both.
	void set_heights_in_meters(bool p_meters);
	bool is_heights_in_meters() const;

	/// An Image or a Texture2D over the same rect, whose channels say how much of the ground is texture 0 to 3.
	void set_weight_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_weight_image() const;

	/// World meters from the first post to the last: x, and z as y.
	void set_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_rect() const;

	/// World meters of the lowest and of the highest value that a post can have; +-1e6.
	void set_min_height(double p_height);
	double get_min_height() const;
	void set_max_height(double p_height);
	double get_max_height() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;

private:
	void change();
	void image_changed();
	void exchange_image(godot::Ref<godot::Resource> &r_image, const godot::Ref<godot::Resource> &p_next,
			const godot::Ref<godot::Resource> &p_other);
	void refresh();
	Status build();
	Status read_all();
	Status read_file();
	Status set_posts(Heightfield &r_field, const HeightfieldFrame &frame) const;

	godot::String heightmap_path_;
	godot::Vector2i post_count_{0, 0};
	godot::Ref<godot::Resource> image_;
	godot::Ref<godot::Resource> weight_image_;
	bool heights_in_meters_ = false;
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	double min_height_ = 0.0;
	double max_height_ = 100.0;

	Posts posts_; ///< As read; a change of rect or heights needs no second reading.
	WeightMap weights_;
	std::shared_ptr<const Heightfield> field_;
	Status status_;
	bool posts_stale_ = true;
	bool field_stale_ = true;
};

} // namespace thicket
