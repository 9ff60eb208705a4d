#include "nodes/layer/scatter_mask.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

float rounded_down(double value) {
	const auto nearest = static_cast<float>(value);
	return nearest > value ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
}

float rounded_up(double value) { return -rounded_down(-value); }

/// Returns a single-precision rectangle that contains all of `rect`.
Rect2 enclosing_rect(const Rect &rect) {
	if (rect.empty()) {
		return {};
	}
	const Vector2 corner(rounded_down(rect.min.x), rounded_down(rect.min.y));
	return Rect2(corner, Vector2(rounded_up(rect.max.x - corner.x), rounded_up(rect.max.y - corner.y)));
}

PixelRect pixel_rect(const Rect2i &p_rect) {
	// Add in 64 bits, because a script may pass a rectangle that ends beyond the last pixel.
	const auto end = [](int32_t position, int32_t size) {
		using Limits = std::numeric_limits<int32_t>;
		return static_cast<int32_t>(std::clamp<int64_t>(int64_t{position} + size, Limits::min(), Limits::max()));
	};
	const glm::ivec2 min{p_rect.position.x, p_rect.position.y};
	return {min, {end(min.x, p_rect.size.x), end(min.y, p_rect.size.y)}};
}

/// Renames the properties in an error to their names in the script API.
Status with_script_names(Status status) {
	if (std::string_view(status.property) == "region") {
		status.property = "rect";
	} else if (std::string_view(status.property) == "version") {
		status.property = "version of ScatterMask.data";
	}
	return status;
}

} // namespace

bool ScatterMask::accept_while_blank(const char *p_property, double p_value) const {
	if (!blank()) {
		ERR_PRINT(vformat("ScatterMask.%s cannot change while the mask is painted, got %s. Call clear() first.",
				p_property, p_value));
	}
	return blank();
}

void ScatterMask::reset(double p_pixel_size, double p_background) {
	const Status status = mask_.reset(p_pixel_size, p_background);
	report(class_name, status);
	if (status.ok()) {
		background_ = p_background;
		snapshot_ = nullptr;
		emit_changed();
	}
}

void ScatterMask::set_pixel_size(double p_size) {
	if (p_size != get_pixel_size() &&
			accept_number(class_name, "pixel_size", p_size, PaintedMask::min_pixel_size, PaintedMask::max_pixel_size) &&
			accept_while_blank("pixel_size", p_size)) {
		reset(p_size, background_);
	}
}

double ScatterMask::get_pixel_size() const { return mask_.pixel_size(); }

void ScatterMask::set_background(double p_background) {
	if (p_background != background_ && accept_number(class_name, "background", p_background, 0.0, 1.0) &&
			accept_while_blank("background", p_background)) {
		reset(get_pixel_size(), p_background);
	}
}

double ScatterMask::get_background() const { return background_; }

void ScatterMask::set_data(const PackedByteArray &p_data) {
	if (p_data.is_empty()) {
		clear();
		return;
	}
	report(class_name, replace_content(span_of(p_data)));
}

Status ScatterMask::replace_content(std::span<const std::uint8_t> bytes) {
	const Status status = mask_.from_bytes(bytes);
	if (status.ok()) {
		// The bytes store the background in steps of 1/255; the scene stores it more precisely.
		if (std::lround(255.0 * background_) != std::lround(255.0 * mask_.background())) {
			background_ = mask_.background();
		}
		snapshot_ = nullptr;
		emit_changed();
	}
	return with_script_names(status);
}

PackedByteArray ScatterMask::get_data() const { return blank() ? PackedByteArray() : packed_bytes(mask_.to_bytes()); }

Rect2 ScatterMask::emit_area_changed(const Status &status, const Rect &changed_area) {
	report(class_name, with_script_names(status));
	if (!status.ok() || changed_area.empty()) {
		return {};
	}
	snapshot_ = nullptr;
	const Rect2 area = enclosing_rect(changed_area);
	emit_signal("area_changed", area);
	return area;
}

Rect2 ScatterMask::paint(const Vector2 &p_center, double p_radius, double p_strength, double p_hardness, Mode p_mode) {
	if (!accept_number(class_name, "mode", static_cast<double>(p_mode), MODE_PAINT, MODE_SMOOTH)) {
		return {};
	}
	Brush brush;
	brush.mode = static_cast<Brush::Mode>(p_mode);
	brush.center = {p_center.x, p_center.y};
	brush.radius = p_radius;
	brush.strength = p_strength;
	brush.hardness = p_hardness;
	Rect changed_area;
	const Status status = mask_.paint(brush, changed_area);
	return emit_area_changed(status, changed_area);
}

PackedByteArray ScatterMask::get_pixels(const Rect2i &p_rect) const {
	std::vector<std::uint8_t> pixels;
	const Status status = mask_.read(pixel_rect(p_rect), pixels);
	report(class_name, with_script_names(status));
	return status.ok() ? packed_bytes(pixels) : PackedByteArray();
}

Rect2 ScatterMask::set_pixels(const Rect2i &p_rect, const PackedByteArray &p_pixels) {
	Rect changed_area;
	const Status status = mask_.write(pixel_rect(p_rect), span_of(p_pixels), changed_area);
	return emit_area_changed(status, changed_area);
}

double ScatterMask::sample(const Vector2 &p_position) const {
	const glm::dvec2 position{p_position.x, p_position.y};
	float density = 0.0F;
	report(class_name, mask_.sample({&position, 1}, {&density, 1}));
	return density > 0.0F ? density : 0.0;
}

Rect2i ScatterMask::get_pixel_rect(const Rect2 &p_rect) const {
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const PixelRect pixels = mask_.pixels_of({corner, corner + glm::dvec2{p_rect.size.x, p_rect.size.y}});
	if (pixels.empty()) {
		return {};
	}
	const glm::ivec2 size = pixels.max - pixels.min;
	return Rect2i(Vector2i(pixels.min.x, pixels.min.y), Vector2i(size.x, size.y));
}

void ScatterMask::clear() {
	if (!blank()) {
		reset(get_pixel_size(), background_);
	}
}

std::shared_ptr<const PaintedMask> ScatterMask::snapshot() const {
	if (snapshot_ != nullptr) {
		return snapshot_;
	}
	snapshot_ = std::make_shared<PaintedMask>(mask_);
	return snapshot_;
}

void ScatterMask::_bind_methods() {
	using Self = ScatterMask;
	bind_guarded<&Self::set_pixel_size>(D_METHOD("set_pixel_size", "size"));
	bind_guarded<&Self::get_pixel_size>(D_METHOD("get_pixel_size"));
	bind_guarded<&Self::set_background>(D_METHOD("set_background", "background"));
	bind_guarded<&Self::get_background>(D_METHOD("get_background"));
	bind_guarded<&Self::set_data>(D_METHOD("set_data", "data"));
	bind_guarded<&Self::get_data>(D_METHOD("get_data"));
	bind_guarded<&Self::save_to_file>(D_METHOD("save_to_file", "path"));
	bind_guarded<&Self::load_from_file>(D_METHOD("load_from_file", "path"));
	bind_guarded<&Self::paint>(D_METHOD("paint", "center", "radius", "strength", "hardness", "mode"), DEFVAL(1.0),
			DEFVAL(0.5), DEFVAL(MODE_PAINT));
	bind_guarded<&Self::get_pixels>(D_METHOD("get_pixels", "rect"));
	bind_guarded<&Self::set_pixels>(D_METHOD("set_pixels", "rect", "pixels"));
	bind_guarded<&Self::sample>(D_METHOD("sample", "position"));
	bind_guarded<&Self::get_pixel_rect>(D_METHOD("get_pixel_rect", "rect"));
	bind_guarded<&Self::clear>(D_METHOD("clear"));
	bind_planets();
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "pixel_size", PROPERTY_HINT_RANGE,
						 "0.125,16,0.125,or_less,or_greater,suffix:m"),
			"set_pixel_size", "get_pixel_size");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "background", PROPERTY_HINT_RANGE, "0,1,0.01"), "set_background",
			"get_background");
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_BYTE_ARRAY, "data", PROPERTY_HINT_NONE, String(), PROPERTY_USAGE_STORAGE),
			"set_data", "get_data");
	ADD_SIGNAL(MethodInfo("area_changed", PropertyInfo(Variant::RECT2, "rect")));
	BIND_ENUM_CONSTANT(MODE_PAINT);
	BIND_ENUM_CONSTANT(MODE_ERASE);
	BIND_ENUM_CONSTANT(MODE_SMOOTH);
}

} // namespace thicket
