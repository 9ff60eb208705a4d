#pragma once

#include "core/rules/painted_mask.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/vector2.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

/// A density painted over the whole plane: PaintedMask as a resource of the engine. Several layers may share one.
///
/// `paint` and `set_pixels` emit `area_changed` with the rectangle that they changed. All other changes emit `changed`.
class ScatterMask : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterMask, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterMask";

	/// Brush::Mode.
	enum Mode : std::int64_t {
		MODE_PAINT,
		MODE_ERASE,
		MODE_SMOOTH,
	};

	/// Meters, PaintedMask::min_pixel_size to max_pixel_size. Refused while anything is painted, because the mask would
	/// have to be resampled, and that could not be undone. The background is refused in the same case.
	void set_pixel_size(double p_size);
	double get_pixel_size() const;

	/// The density where nothing is painted: 0 to 1, stored in steps of 1/255.
	void set_background(double p_background);
	double get_background() const;

	/// All painted pixels, the pixel size and the background, in the format of PaintedMask::to_bytes. Empty for a blank
	/// mask. Corrupt bytes print one error and change nothing.
	void set_data(const godot::PackedByteArray &p_data);
	godot::PackedByteArray get_data() const;

	/// Saves the whole mask to a file: see replace_file. On failure, prints an error and leaves the old file unchanged.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// Replaces the whole mask with a file written by save_to_file. On failure, prints an error and changes nothing.
	godot::Error load_from_file(const godot::String &p_path);

	/// Paints one dab of a Brush. Returns the rectangle of the world (x, z) that contains all changes. Empty if nothing
	/// has changed, or if a value was refused.
	godot::Rect2 paint(
			const godot::Vector2 &p_center, double p_radius, double p_strength, double p_hardness, Mode p_mode);

	/// Pixels row by row, one byte each, 0 to 255. Empty if the rectangle is empty or is refused.
	godot::PackedByteArray get_pixels(const godot::Rect2i &p_rect) const;

	/// Writes such pixels back. Returns the same as `paint`.
	godot::Rect2 set_pixels(const godot::Rect2i &p_rect, const godot::PackedByteArray &p_pixels);

	/// The density at a world position (x, z), 0 to 1; 0 if the position is not finite.
	double sample(const godot::Vector2 &p_position) const;

	/// The pixels that a change within a world rectangle may affect.
	godot::Rect2i get_pixel_rect(const godot::Rect2 &p_rect) const;

	/// Erases everything that is painted.
	void clear();

	/// The current pixels, for workers. Returns the same object until the mask changes.
	std::shared_ptr<const PaintedMask> snapshot() const;

	/// True if nothing is painted.
	bool blank() const { return mask_.block_count() == 0; }

	void _reset_state() override { clear(); }

protected:
	static void _bind_methods();

private:
	bool accept_while_blank(const char *p_property, double p_value) const;
	void reset(double p_pixel_size, double p_background);

	/// Replaces the whole mask with the content of the bytes. If they are refused, changes nothing.
	Status take(std::span<const std::uint8_t> bytes);
	godot::Rect2 announce(const Status &status, const Rect &changed);

	PaintedMask mask_;
	double background_ = 1.0;                             ///< As set by the user; the mask's own value is rounded.
	mutable std::shared_ptr<const PaintedMask> snapshot_; ///< Null if it must be recreated.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterMask::Mode)
