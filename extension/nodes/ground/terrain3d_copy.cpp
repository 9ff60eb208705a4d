// This file copies the ground of Terrain3D (github.com/TokisanGames/Terrain3D), versions 1.0 and
// later. Terrain3D defines it in src/terrain_3d_data.h and src/terrain_3d_region.h.

#include "nodes/ground/ground_copy.hpp"

#include "core/terrain/region_field.hpp"
#include "nodes/ground/region_copy.hpp"
#include "nodes/ground/shared_pixels.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr int post_bytes = 4;

class Terrain3DCopy final : public RegionCopy {
public:
	Terrain3DCopy(RegionField field, std::vector<glm::ivec2> unloaded, String directory) :
			RegionCopy(std::move(field), glm::dvec3(0.0), std::move(unloaded)), directory_(std::move(directory)) {}

	GroundPlugin plugin() const override { return GroundPlugin::terrain3d; }

	bool has_textures() const override { return true; }

	String description() const override {
		return vformat("Terrain3D, copied: %d regions of %d x %d vertices, %s m apart",
				static_cast<int64_t>(field().regions().size()), field().side(), field().side(), field().spacing());
	}

	String remark() const override {
		return field().regions().empty() && unloaded().empty() ? String("has no regions: there is no ground yet.")
															   : String();
	}

	const String &directory() const { return directory_; }

private:
	String directory_; ///< The directory from which the regions are loaded.
};

/// Reads one region. Returns false with a reason if the region is not as in known versions of
/// Terrain3D.
bool read_region(const Variant &p_region, FieldRegion &r_region, String &r_refusal) {
	const Variant location = result_of(p_region, "get_location");
	if (location.get_type() != Variant::VECTOR2I) {
		r_refusal = "has regions without a get_location() that returns a Vector2i";
		return false;
	}
	const Vector2i coordinates = location;
	r_region.location = {coordinates.x, coordinates.y};
	const auto read = [&](const StringName &p_method, const char *map_name, PixelGrid &r_pixels) {
		const Ref<Image> image = image_in(result_of(p_region, p_method));
		if (image.is_null()) {
			r_refusal = vformat("has no %s for its region at %s", String(map_name), location);
		} else if (image->get_format() != Image::FORMAT_RF || !share_pixels(image, post_bytes, r_pixels)) {
			r_refusal = vformat("has a %s in a format other than RF for its region at %s (Image.Format %d)",
					String(map_name), location, static_cast<int64_t>(image->get_format()));
		}
		return r_refusal.is_empty();
	};
	return read("get_height_map", "height map", r_region.heights) &&
			read("get_control_map", "control map", r_region.controls);
}

/// Reads the parameters of the auto shader as `Terrain3DData.get_texture_id` does. If the material
/// lacks them, the auto shader is treated as disabled.
AutoPaint read_paint(const Variant &p_node) {
	AutoPaint paint;
	const Variant material = result_of(p_node, "get_material");
	Variant enabled;
	// The name since version 1.1, then the older name.
	for (const char *const method : {"get_auto_shader_enabled", "get_auto_shader"}) {
		if (enabled.get_type() != Variant::BOOL && has_method(material, method)) {
			enabled = result_of(material, method);
		}
	}
	if (enabled.get_type() != Variant::BOOL || !static_cast<bool>(enabled) ||
			!has_method(material, "get_shader_param")) {
		return paint;
	}
	// Without a renderer, as on a server, the material only has the saved parameters of its shader.
	const Object *object = material.get_validated_object();
	const Variant saved_value = object != nullptr ? object->get("_shader_parameters") : Variant();
	const Dictionary saved_parameters =
			saved_value.get_type() == Variant::DICTIONARY ? static_cast<Dictionary>(saved_value) : Dictionary();
	const auto parameter = [&](const char *name, double default_value) {
		Variant value = result_of(material, "get_shader_param", {StringName(name)});
		if (!is_number(value)) {
			value = saved_parameters.get(StringName(name), Variant());
		}
		const double number = is_number(value) ? static_cast<double>(value) : default_value;
		return std::isfinite(number) ? number : default_value;
	};
	// The defaults match the shader: src/shaders/auto_shader.glsl.
	paint.enabled = true;
	paint.slope = parameter("auto_slope", paint.slope);
	paint.height_reduction = parameter("auto_height_reduction", 0.1);
	paint.base = static_cast<int>(std::clamp(parameter("auto_base_texture", 0.0), 0.0, 31.0));
	paint.overlay = static_cast<int>(std::clamp(parameter("auto_overlay_texture", 1.0), 0.0, 31.0));
	return paint;
}

/// Reads all active regions. Returns false with a reason if one of them cannot be read.
bool read_regions(const Variant &p_data, std::vector<FieldRegion> &r_regions, String &r_refusal) {
	const Variant result = result_of(p_data, "get_regions_active");
	if (result.get_type() != Variant::ARRAY) {
		r_refusal = "has data whose get_regions_active() does not return an Array";
		return false;
	}
	const Array active_regions = result;
	for (int64_t i = 0; i < active_regions.size(); ++i) {
		FieldRegion region;
		if (!read_region(active_regions[i], region, r_refusal)) {
			return false;
		}
		r_regions.push_back(std::move(region));
	}
	return true;
}

/// Returns true if the node may load and unload regions while the game runs. No released version of
/// Terrain3D does this. The method names come from proposals 675, 1004, 1006 and 1020 at
/// github.com/TokisanGames/Terrain3D.
bool streams_regions(const Variant &p_data) {
	for (const char *const method : {"is_streaming", "get_enable_streaming"}) {
		const Variant streams = has_method(p_data, method) ? result_of(p_data, method) : Variant();
		if (streams.get_type() == Variant::BOOL && static_cast<bool>(streams)) {
			return true;
		}
	}
	return has_method(p_data, "unload_region");
}

/// Returns true if a region that is no longer active was unloaded, not removed. A removed region
/// stays in the data, marked as deleted, until the terrain is saved. Proposal 675 also marks
/// unloaded regions as deleted, so there every inactive region is treated as unloaded.
bool is_unloaded(const Variant &p_data, glm::ivec2 location) {
	constexpr std::int64_t state_unloaded = 1;
	const Variant argument = Vector2i(location.x, location.y);
	if (has_method(p_data, "get_region_load_state")) {
		const Variant state = result_of(p_data, "get_region_load_state", {argument});
		return is_number(state) && static_cast<std::int64_t>(state) == state_unloaded;
	}
	if (has_method(p_data, "get_enable_streaming")) {
		return true;
	}
	const Variant region = result_of(p_data, "get_region", {argument});
	return region.get_validated_object() == nullptr;
}

/// Returns the locations of the regions of the previous copy that the node has unloaded since. Adds
/// those next to loaded regions to `r_regions`, because instances may be visible there. The new
/// copy does not contain the others, which frees their memory.
std::vector<glm::ivec2> keep_unloaded(
		const Variant &p_data, const Terrain3DCopy &before, std::vector<FieldRegion> &r_regions) {
	std::set<std::pair<int, int>> loaded_locations;
	for (const FieldRegion &region : r_regions) {
		loaded_locations.insert({region.location.x, region.location.y});
	}
	std::vector<glm::ivec2> unloaded;
	for (const FieldRegion &region : before.field().regions()) {
		const glm::ivec2 location = region.location;
		if (loaded_locations.contains({location.x, location.y}) || !is_unloaded(p_data, location)) {
			continue;
		}
		unloaded.push_back(location);
		bool is_near_loaded = false;
		for (int side = 0; side < 9; ++side) {
			is_near_loaded =
					is_near_loaded || loaded_locations.contains({location.x + side % 3 - 1, location.y + side / 3 - 1});
		}
		if (is_near_loaded) {
			r_regions.push_back(region);
		}
	}
	return unloaded;
}

} // namespace

CopyAttempt copy_terrain3d(const Variant &p_node, const GroundCopy *before) {
	CopyAttempt attempt;
	const Object *node = p_node.get_validated_object();
	attempt.data = node != nullptr ? node->get("data") : Variant();
	if (!has_method(attempt.data, "get_regions_active") || !has_method(attempt.data, "get_height")) {
		return attempt;
	}
	attempt.plugin = GroundPlugin::terrain3d;
	node = p_node.get_validated_object(); // A script may have freed the node.
	const Variant spacing = node != nullptr ? node->get("vertex_spacing") : Variant();
	if (!is_number(spacing)) {
		attempt.refusal = "has a vertex_spacing that is not a number";
		return attempt;
	}
	std::vector<FieldRegion> regions;
	if (!read_regions(attempt.data, regions, attempt.refusal)) {
		return attempt;
	}
	node = p_node.get_validated_object();
	const Variant directory_value = node != nullptr ? node->get("data_directory") : Variant();
	const String directory =
			directory_value.get_type() == Variant::STRING ? static_cast<String>(directory_value) : String();
	const auto *const previous = before != nullptr && before->plugin() == GroundPlugin::terrain3d
			? static_cast<const Terrain3DCopy *>(before)
			: nullptr;
	std::vector<glm::ivec2> unloaded;
	if (previous != nullptr && previous->directory() == directory &&
			previous->field().spacing() == static_cast<double>(spacing) && streams_regions(attempt.data)) {
		unloaded = keep_unloaded(attempt.data, *previous, regions);
	}
	const int side = regions.empty() ? RegionField::default_side : regions.front().heights.size().x;
	RegionField field;
	const Status status = field.set(side, static_cast<double>(spacing), std::move(regions), read_paint(p_node));
	if (status.ok()) {
		attempt.copy = std::make_shared<Terrain3DCopy>(std::move(field), std::move(unloaded), directory);
	} else {
		attempt.refusal = String(("cannot be copied (" + describe(status) + ")").c_str());
	}
	return attempt;
}

} // namespace thicket
