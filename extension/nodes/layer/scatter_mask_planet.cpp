// This file contains the methods of ScatterMask for planets.

#include "core/base/check.hpp"
#include "core/rules/planet_positions.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/layer/scatter_mask.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

bool ScatterMask::paint_on_planet(double p_planet_radius, const Vector3 &p_from_center, double p_radius,
		double p_strength, double p_hardness, Mode p_mode) {
	if (!accept_number(class_name, "mode", static_cast<double>(p_mode), MODE_PAINT, MODE_SMOOTH)) {
		return false;
	}
	const glm::dvec3 from_center = to_core(p_from_center);
	bool has_changed = false;
	Status status = check_direction(p_planet_radius, from_center);
	if (status.ok()) {
		const Brush brush{static_cast<Brush::Mode>(p_mode), {}, p_radius, p_strength, p_hardness};
		status = mask_.paint_on(p_planet_radius, from_center, brush, has_changed);
	}
	report(class_name, status);
	if (has_changed) {
		snapshot_ = nullptr;
		emit_signal("area_changed", Rect2());
	}
	return has_changed;
}

double ScatterMask::sample_on_planet(double p_planet_radius, const Vector3 &p_from_center) const {
	const glm::dvec3 from_center = to_core(p_from_center);
	const Status status = check_direction(p_planet_radius, from_center);
	report(class_name, status);
	return status.ok() ? mask_.toward(p_planet_radius, from_center) : 0.0;
}

TypedArray<Rect2i> ScatterMask::get_pixel_rects_on_planet(
		double p_planet_radius, const Vector3 &p_from_center, double p_radius) const {
	const glm::dvec3 from_center = to_core(p_from_center);
	const Status status =
			first_failure(check_direction(p_planet_radius, from_center), check_positive("radius", p_radius));
	report(class_name, status);
	TypedArray<Rect2i> result;
	if (!status.ok()) {
		return result;
	}
	for (const PixelRect &rect : mask_.pixels_on(p_planet_radius, from_center, p_radius)) {
		if (!rect.empty()) {
			const glm::ivec2 size = rect.size();
			append(result, Rect2i(Vector2i(rect.min.x, rect.min.y), Vector2i(size.x, size.y)));
		}
	}
	return result;
}

void ScatterMask::bind_planets() {
	using Self = ScatterMask;
	bind_guarded<&Self::paint_on_planet>(
			D_METHOD("paint_on_planet", "planet_radius", "from_center", "radius", "strength", "hardness", "mode"),
			DEFVAL(1.0), DEFVAL(0.5), DEFVAL(MODE_PAINT));
	bind_guarded<&Self::sample_on_planet>(D_METHOD("sample_on_planet", "planet_radius", "from_center"));
	bind_guarded<&Self::get_pixel_rects_on_planet>(
			D_METHOD("get_pixel_rects_on_planet", "planet_radius", "from_center", "radius"));
}

} // namespace thicket
