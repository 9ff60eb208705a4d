// Terrain3D (github.com/TokisanGames/Terrain3D), versions 1.0 and later: src/terrain_3d_data.h, src/terrain_3d_region.h.

#include "nodes/ground/ground_copy.hpp"

#include "core/terrain/region_field.hpp"
#include "nodes/ground/shared_pixels.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr int post_bytes = 4;

class Terrain3DCopy final : public GroundCopy {
public:
	explicit Terrain3DCopy(RegionField field) : field_(std::move(field)) {}

	GroundPlugin plugin() const override { return GroundPlugin::terrain3d; }

	std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const override {
		return std::make_shared<RegionField>(field_.at_offset(offset));
	}

	bool has_textures() const override { return true; }

	String description() const override {
		return vformat("Terrain3D, copied: %d regions of %d x %d vertices, %s m apart",
				static_cast<int64_t>(field_.regions().size()), field_.side(), field_.side(), field_.spacing());
	}

	String remark() const override {
		return field_.regions().empty() ? String("has no regions: there is no ground yet.") : String();
	}

	GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const override;

private:
	/// The area of the ground that depends on the posts of a rect: heights between it and the previous posts, and slopes up to the next
	/// ones.
	Rect2 area_of(glm::ivec2 location, const PixelRect &rect) const;
	void add_changes(const FieldRegion &mine, const FieldRegion *theirs, GroundChanges &r_changes) const;

	RegionField field_;
};

Rect2 Terrain3DCopy::area_of(glm::ivec2 location, const PixelRect &rect) const {
	const glm::dvec2 first = (glm::dvec2(location * field_.side() + rect.min) - 2.0) * field_.spacing();
	const glm::dvec2 size = (glm::dvec2(rect.size()) + 3.0) * field_.spacing();
	return Rect2(static_cast<real_t>(first.x), static_cast<real_t>(first.y), static_cast<real_t>(size.x),
			static_cast<real_t>(size.y));
}

void Terrain3DCopy::add_changes(const FieldRegion &mine, const FieldRegion *theirs, GroundChanges &r_changes) const {
	const PixelRect all{glm::ivec2(0), glm::ivec2(field_.side())};
	const auto add = [&](const PixelRect &rect) {
		if (!rect.empty()) {
			r_changes.areas.push_back(area_of(mine.location, rect));
		}
	};
	if (theirs == nullptr || mine.controls.empty() != theirs->controls.empty()) {
		add(all);
		return;
	}
	add(mine.heights.difference(theirs->heights));
	if (!mine.controls.empty()) {
		add(mine.controls.difference(theirs->controls));
	}
}

GroundChanges Terrain3DCopy::changes_since(const GroundCopy &before, glm::dvec3 shift) const {
	GroundChanges changes;
	const auto *const other = before.plugin() == plugin() ? static_cast<const Terrain3DCopy *>(&before) : nullptr;
	changes.everywhere = other == nullptr || shift != glm::dvec3(0.0) || other->field_.side() != field_.side() ||
			other->field_.spacing() != field_.spacing() || !(other->field_.paint() == field_.paint());
	if (changes.everywhere) {
		return changes;
	}
	for (const FieldRegion &region : field_.regions()) {
		add_changes(region, other->field_.region_at(region.location), changes);
	}
	for (const FieldRegion &region : other->field_.regions()) {
		if (field_.region_at(region.location) == nullptr) {
			changes.areas.push_back(area_of(region.location, {glm::ivec2(0), glm::ivec2(field_.side())}));
		}
	}
	return changes;
}

/// Reads one region. False, with a reason, for a region that differs from those of the known versions.
bool read_region(const Variant &p_region, FieldRegion &r_region, String &r_refusal) {
	const Variant location = result_of(p_region, "get_location");
	if (location.get_type() != Variant::VECTOR2I) {
		r_refusal = "has regions without a get_location() that gives a Vector2i";
		return false;
	}
	const Vector2i at = location;
	r_region.location = {at.x, at.y};
	const auto read = [&](const StringName &p_method, const char *what, PixelGrid &r_pixels) {
		const Ref<Image> image = image_in(result_of(p_region, p_method));
		if (image.is_null()) {
			r_refusal = vformat("has no %s for its region at %s", String(what), location);
		} else if (image->get_format() != Image::FORMAT_RF || !share_pixels(image, post_bytes, r_pixels)) {
			r_refusal = vformat("has a %s of another format than RF for its region at %s (Image.Format %d)",
					String(what), location, static_cast<int64_t>(image->get_format()));
		}
		return r_refusal.is_empty();
	};
	return read("get_height_map", "height map", r_region.heights) &&
			read("get_control_map", "control map", r_region.controls);
}

/// Reads the parameters of the auto shader, as `Terrain3DData.get_texture_id` does. It is off without a material that has them.
AutoPaint read_paint(const Variant &p_node) {
	AutoPaint paint;
	const Variant material = result_of(p_node, "get_material");
	Variant enabled;
	for (const char *const method : {"get_auto_shader_enabled", "get_auto_shader"}) { // Since 1.1, and before.
		if (enabled.get_type() != Variant::BOOL && has_method(material, method)) {
			enabled = result_of(material, method);
		}
	}
	if (enabled.get_type() != Variant::BOOL || !static_cast<bool>(enabled) ||
			!has_method(material, "get_shader_param")) {
		return paint;
	}
	// Without a renderer, as on a server, the material only knows the saved parameters of its shader.
	const Object *object = material.get_validated_object();
	const Variant stored = object != nullptr ? object->get("_shader_parameters") : Variant();
	const Dictionary saved = stored.get_type() == Variant::DICTIONARY ? static_cast<Dictionary>(stored) : Dictionary();
	const auto number = [&](const char *name, double otherwise) {
		Variant value = result_of(material, "get_shader_param", {StringName(name)});
		if (!is_number(value)) {
			value = saved.get(StringName(name), Variant());
		}
		const double given = is_number(value) ? static_cast<double>(value) : otherwise;
		return std::isfinite(given) ? given : otherwise;
	};
	// The shader's own defaults: src/shaders/auto_shader.glsl.
	paint.enabled = true;
	paint.slope = number("auto_slope", paint.slope);
	paint.height_reduction = number("auto_height_reduction", 0.1);
	paint.base = static_cast<int>(std::clamp(number("auto_base_texture", 0.0), 0.0, 31.0));
	paint.overlay = static_cast<int>(std::clamp(number("auto_overlay_texture", 1.0), 0.0, 31.0));
	return paint;
}

bool read_regions(const Variant &p_data, std::vector<FieldRegion> &r_regions, String &r_refusal) {
	const Variant result = result_of(p_data, "get_regions_active");
	if (result.get_type() != Variant::ARRAY) {
		r_refusal = "has data whose get_regions_active() gives no Array";
		return false;
	}
	const Array active = result;
	for (int64_t i = 0; i < active.size(); ++i) {
		FieldRegion region;
		if (!read_region(active[i], region, r_refusal)) {
			return false;
		}
		r_regions.push_back(std::move(region));
	}
	return true;
}

} // namespace

CopyAttempt copy_terrain3d(const Variant &p_node) {
	CopyAttempt attempt;
	const Object *node = p_node.get_validated_object();
	attempt.data = node != nullptr ? node->get("data") : Variant();
	if (!has_method(attempt.data, "get_regions_active") || !has_method(attempt.data, "get_height")) {
		return attempt;
	}
	attempt.plugin = GroundPlugin::terrain3d;
	node = p_node.get_validated_object(); // A script was called.
	const Variant spacing = node != nullptr ? node->get("vertex_spacing") : Variant();
	if (!is_number(spacing)) {
		attempt.refusal = "has no number as its vertex_spacing";
		return attempt;
	}
	std::vector<FieldRegion> regions;
	if (!read_regions(attempt.data, regions, attempt.refusal)) {
		return attempt;
	}
	const int side = regions.empty() ? RegionField::default_side : regions.front().heights.size().x;
	RegionField field;
	const Status status = field.set(side, static_cast<double>(spacing), std::move(regions), read_paint(p_node));
	if (status.ok()) {
		attempt.copy = std::make_shared<Terrain3DCopy>(std::move(field));
	} else {
		attempt.refusal = String(("cannot be copied (" + describe(status) + ")").c_str());
	}
	return attempt;
}

} // namespace thicket
