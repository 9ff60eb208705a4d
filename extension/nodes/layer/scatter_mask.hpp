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

/// A density that is painted, over the whole plane: PaintedMask as a resource of the engine. Several layers may share one.
///
/// A dab, and pixels put back, emit `area_changed` with the rectangle that they changed; everything else emits `changed`.
class ScatterMask : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterMask, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Brush::Mode.
	enum Mode : std::int64_t {
		MODE_PAINT,
		MODE_ERASE,
		MODE_SMOOTH,
	};

	/// Meters, PaintedMask::min_pixel_size to max_pixel_size. Refused, as the background is, while something is painted: it
	/// would have to be made anew from other pixels, and could not be put back.
	void set_pixel_size(double p_size);
	double get_pixel_size() const;

	/// The density where nothing is painted, 0 to 1, kept to 1/255.
	void set_background(double p_background);
	double get_background() const;

	/// All that is painted, with pixel size and background, as PaintedMask::to_bytes; none for a mask without paint. Bytes
	/// that are corrupt print one error and change nothing.
	void set_data(const godot::PackedByteArray &p_data);
	godot::PackedByteArray get_data() const;

	/// All of it as a file: see replace_file. An error is printed, and leaves the old file as it was.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// What save_to_file wrote, in place of all that is here. After an error, which is printed, nothing has changed.
	godot::Error load_from_file(const godot::String &p_path);

	/// One dab of a Brush. Returns the rectangle of the world (x, z) outside which nothing has changed; empty if nothing has,
	/// or where a value was refused.
	godot::Rect2 paint(
			const godot::Vector2 &p_center, double p_radius, double p_strength, double p_hardness, Mode p_mode);

	/// Pixels row by row, one byte each, 0 to 255; none where the rectangle is empty or refused.
	godot::PackedByteArray get_pixels(const godot::Rect2i &p_rect) const;

	/// Writes such pixels back; returns as `paint` does.
	godot::Rect2 set_pixels(const godot::Rect2i &p_rect, const godot::PackedByteArray &p_pixels);

	/// The density at a position of the world (x, z), 0 to 1; 0 where that is not finite.
	double sample(const godot::Vector2 &p_position) const;

	/// The pixels that a change within a world rectangle may touch.
	godot::Rect2i get_pixel_rect(const godot::Rect2 &p_rect) const;

	/// Forgets what is painted.
	void clear();

	/// What is painted now, for workers: the same object until it changes.
	std::shared_ptr<const PaintedMask> snapshot() const;

	/// True where nothing is painted.
	bool blank() const { return mask_.block_count() == 0; }

	void _reset_state() override { clear(); }

protected:
	static void _bind_methods();

private:
	bool accept_while_blank(const char *p_property, double p_value) const;
	void reset(double p_pixel_size, double p_background);

	/// What bytes say, in place of all that is here; nothing where they are refused.
	Status take(std::span<const std::uint8_t> bytes);
	godot::Rect2 announce(const Status &status, const Rect &changed);

	PaintedMask mask_;
	double background_ = 1.0;                             ///< As it was set; the mask's own is rounded.
	mutable std::shared_ptr<const PaintedMask> snapshot_; ///< Null where it has to be made.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterMask::Mode)
