#pragma once

#include "core/terrain/heightfield.hpp"
#include "nodes/scatter_terrain.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// Ground from a grid of heights: a raw file of 16-bit posts, or an Image. Properties may be set in any order; the
/// ground is read when it is first needed after a change. What cannot be read prints one error, and the ground stays
/// what it was.
class ScatterTerrainHeightmap : public ScatterTerrain {
	GDCLASS(ScatterTerrainHeightmap, ScatterTerrain)

public:
	std::shared_ptr<const Terrain> snapshot() override;
	godot::String problem() override;

	/// A file of 16-bit little-endian posts without a header, row by row, x fastest. Used where there is no image.
	void set_heightmap_path(const godot::String &p_path);
	godot::String get_heightmap_path() const;

	/// Columns and rows of the file, 2 to 32768 each. An image knows its own.
	void set_post_count(const godot::Vector2i &p_count);
	godot::Vector2i get_post_count() const;

	/// An image of one of the formats R16, RF, RH (0 to 1), R8 or L8; the first channel of others. Goes before the
	/// file.
	void set_image(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> get_image() const;

	/// World metres from the first post to the last: x, and z as y.
	void set_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_rect() const;

	/// World metres of the lowest and of the highest value that a post can have; +-1e6.
	void set_min_height(double p_height);
	double get_min_height() const;
	void set_max_height(double p_height);
	double get_max_height() const;

protected:
	static void _bind_methods();

private:
	void change(bool p_posts);
	void refresh();
	Status build();
	Status read_posts(glm::ivec2 &r_count);
	Status read_file();
	Status read_image();

	godot::String heightmap_path_;
	godot::Vector2i post_count_{0, 0};
	godot::Ref<godot::Image> image_;
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	double min_height_ = 0.0;
	double max_height_ = 100.0;

	std::vector<std::uint16_t> posts_; ///< As read; a change of rect or heights needs no second reading.
	std::shared_ptr<const Heightfield> field_;
	Status status_;
	bool posts_stale_ = true;
	bool field_stale_ = true;
};

} // namespace thicket
