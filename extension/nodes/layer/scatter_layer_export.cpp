// This file stores the data that a layer needs after a dedicated server export has replaced meshes
// and textures with placeholders.

#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"
#include "nodes/model/convex_corners.hpp"

#include <span>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

PackedVector3Array packed_corners(std::span<const glm::vec3> corners) {
	return packed<PackedVector3Array>(corners, [](glm::vec3 corner) { return to_engine(corner); });
}

} // namespace

void ScatterLayer::set_convex_hulls(const Array &p_hulls) {
	convex_hulls_.clear();
	for (int64_t entry = 0; entry < p_hulls.size(); ++entry) {
		const PackedVector3Array corners = p_hulls[entry];
		BodyPart hull;
		hull.kind = BodyPart::Kind::convex;
		for (int64_t corner = 0; corner < corners.size(); ++corner) {
			const Vector3 &position = corners.ptr()[corner];
			hull.corners.emplace_back(position.x, position.y, position.z);
		}
		convex_hulls_.push_back(std::move(hull));
	}
	mark_changed();
}

Array ScatterLayer::get_convex_hulls() const {
	Array result;
	for (const BodyPart &hull : convex_hulls_) {
		append(result, packed_corners(hull.corners));
	}
	return result;
}

void ScatterLayer::set_mask_texture_image(const Ref<Image> &p_image) {
	tables_.mask_texture_image = p_image;
	tables_.mask_texture.must_read = true;
	mark_changed();
}

Ref<Image> ScatterLayer::get_mask_texture_image() const { return tables_.mask_texture_image; }

bool ScatterLayer::embed_stripped_data() {
	read_models();
	bool any_stored = false;
	if (gameplay_.collision.shape == BodyShape::convex) {
		Array hulls;
		for (std::size_t entry = 0; entry < meshes_.size(); ++entry) {
			const std::vector<glm::vec3> corners = convex_corners(meshes_.mesh(entry));
			any_stored = any_stored || !corners.empty();
			append(hulls, packed_corners(corners));
		}
		if (any_stored) {
			set_convex_hulls(hulls);
		}
	}
	const Ref<Texture2D> texture = resource("mask_texture");
	const Ref<Image> image = texture.is_valid() ? texture->get_image() : Ref<Image>();
	if (image.is_valid() && image->get_width() > 0) {
		set_mask_texture_image(image);
		any_stored = true;
	}
	return any_stored;
}

/// Returns true if bodies need convex hulls, but the vertices of any mesh were stripped. In that
/// case, all bodies use the stored hulls.
bool ScatterLayer::needs_stored_hulls() const {
	bool any_stripped = false;
	for (std::size_t entry = 0; entry < meshes_.size(); ++entry) {
		any_stripped = any_stripped || is_stripped(meshes_.mesh(entry));
	}
	return any_stripped && gameplay_.collision.shape == BodyShape::convex;
}

void ScatterLayer::use_stored_hulls(LayerCollision &r_collision) const {
	r_collision.shape = BodyShape::model;
	for (std::size_t entry = 0; entry < meshes_.size(); ++entry) {
		r_collision.parts.emplace_back();
		if (entry < convex_hulls_.size()) {
			r_collision.parts.back().push_back(convex_hulls_[entry]);
		}
	}
}

void ScatterLayer::add_stripped_problems(PackedStringArray &r_problems) const {
	for (std::size_t entry = 0; needs_stored_hulls() && entry < meshes_.size(); ++entry) {
		const bool has_hull = entry < convex_hulls_.size() && !convex_hulls_[entry].corners.empty();
		if (is_stripped(meshes_.mesh(entry)) && !has_hull) {
			r_problems.push_back(stripped_problem(vformat("ScatterLayer.meshes[%d]", static_cast<int64_t>(entry)),
					"collision_shape is Convex, and its instances have no bodies"));
		}
	}
	if (tables_.image_missing && is_stripped(tables_.mask_texture.texture)) {
		r_problems.push_back(stripped_problem("ScatterLayer.mask_texture", "nothing is placed"));
	}
}

void ScatterLayer::bind_export() {
	bind_guarded<&ScatterLayer::embed_stripped_data>(D_METHOD("embed_stripped_data"));
	bind_guarded<&ScatterLayer::set_convex_hulls>(D_METHOD("set_convex_hulls", "hulls"));
	bind_guarded<&ScatterLayer::get_convex_hulls>(D_METHOD("get_convex_hulls"));
	add_layer_property(PropertyUse::gameplay,
			PropertyInfo(Variant::ARRAY, "convex_hulls", PROPERTY_HINT_NONE, String(), PROPERTY_USAGE_STORAGE),
			"set_convex_hulls", "get_convex_hulls");
	bind_guarded<&ScatterLayer::set_mask_texture_image>(D_METHOD("set_mask_texture_image", "image"));
	bind_guarded<&ScatterLayer::get_mask_texture_image>(D_METHOD("get_mask_texture_image"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::OBJECT, "mask_texture_image", PROPERTY_HINT_RESOURCE_TYPE, "Image",
					PROPERTY_USAGE_STORAGE),
			"set_mask_texture_image", "get_mask_texture_image");
}

} // namespace thicket
