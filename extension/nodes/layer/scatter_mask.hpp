#pragma once

#include "core/rules/painted_mask.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/vector2.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

/// A density painted over the whole plane: the core's PaintedMask as a Resource. Several layers may
/// share a mask.
///
/// `paint` and `set_pixels` emit `area_changed` with the changed rectangle. All other changes emit
/// `changed`.
class ScatterMask : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterMask, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterMask";

	/// The values of Brush::Mode, for scripts.
	enum Mode : std::int64_t {
		MODE_PAINT,
		MODE_ERASE,
		MODE_SMOOTH,
	};

	/// Sets the size of a pixel in meters, PaintedMask::min_pixel_size to max_pixel_size. While
	/// anything is painted, prints an error and leaves the size unchanged, because the mask would
	/// have to be resampled, which cannot be undone. The same applies to `set_background`.
	void set_pixel_size(double p_size);
	double get_pixel_size() const;

	/// Sets the density where nothing is painted, 0 to 1. The mask rounds it to steps of 1/255.
	void set_background(double p_background);
	double get_background() const;

	/// Sets the whole content: the painted pixels, the pixel size and the background, in the format
	/// of PaintedMask::to_bytes. An empty array means a blank mask. Setting corrupt bytes prints
	/// one error and leaves the mask unchanged.
	void set_data(const godot::PackedByteArray &p_data);
	godot::PackedByteArray get_data() const;

	/// Saves the whole mask to a file (see replace_file). On failure, prints an error and leaves
	/// the old file unchanged.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// Replaces the whole mask with a file from save_to_file. On failure, prints an error and
	/// leaves the mask unchanged.
	godot::Error load_from_file(const godot::String &p_path);

	/// Paints one dab of a Brush. Returns a world rectangle (x, z) in meters that contains all
	/// changes. The rectangle is empty if nothing has changed or a value is invalid.
	godot::Rect2 paint(
			const godot::Vector2 &p_center, double p_radius, double p_strength, double p_hardness, Mode p_mode);

	/// Returns pixels row by row, one byte each, 0 to 255. Returns none if the rectangle is empty
	/// or invalid.
	godot::PackedByteArray get_pixels(const godot::Rect2i &p_rect) const;

	/// Writes pixels in the format of `get_pixels`. Like `paint`, returns a world rectangle that
	/// contains all changes.
	godot::Rect2 set_pixels(const godot::Rect2i &p_rect, const godot::PackedByteArray &p_pixels);

	/// Returns the density at a world position (x, z), 0 to 1; 0 if the position is not finite.
	double sample(const godot::Vector2 &p_position) const;

	/// Returns the pixels that a change within a world rectangle may affect.
	godot::Rect2i get_pixel_rect(const godot::Rect2 &p_rect) const;

	// On a planet, the mask's pixels are on the faces of a cube around it (see CubeGrid). Positions are
	// relative to the planet's center in meters, and only their direction matters.

	/// Like `paint`, on a planet. Returns true if anything has changed, and then emits `area_changed` with
	/// an empty rectangle.
	bool paint_on_planet(double p_planet_radius, const godot::Vector3 &p_from_center, double p_radius,
			double p_strength, double p_hardness, Mode p_mode);

	/// Like `sample`, on a planet.
	double sample_on_planet(double p_planet_radius, const godot::Vector3 &p_from_center) const;

	/// Returns the pixels that a dab on a planet may change, as one to six rectangles.
	godot::TypedArray<godot::Rect2i> get_pixel_rects_on_planet(
			double p_planet_radius, const godot::Vector3 &p_from_center, double p_radius) const;

	/// Erases everything that is painted.
	void clear();

	/// Returns the current pixels, for workers. Returns the same object until the mask changes.
	std::shared_ptr<const PaintedMask> snapshot() const;

	/// Returns true if nothing is painted.
	bool blank() const { return mask_.block_count() == 0; }

	void _reset_state() override { clear(); }

protected:
	static void _bind_methods();

private:
	bool accept_while_blank(const char *p_property, double p_value) const;
	void reset(double p_pixel_size, double p_background);

	/// Replaces the whole mask with the content of the bytes. If they are invalid, leaves the mask
	/// unchanged.
	Status replace_content(std::span<const std::uint8_t> bytes);
	godot::Rect2 emit_area_changed(const Status &status, const Rect &changed_area);

	static void bind_planets();

	PaintedMask mask_;
	/// The background as set by the user; the value in `mask_` is rounded.
	double background_ = 1.0;
	mutable std::shared_ptr<const PaintedMask> snapshot_; ///< The result of `snapshot`. Null if it is outdated.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterMask::Mode)
