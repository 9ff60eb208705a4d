#include "nodes/ground/scatter_ground_heightmap.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/classes/resource_uid.hpp>
#include <godot_cpp/classes/texture2d.hpp>
#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

namespace {

/// Returns true for null, any Texture2D, and an Image with pixels. A Texture2D may receive its
/// image later.
bool accept_image(const char *property, const Ref<Resource> &p_image) {
	const Ref<Image> image = p_image;
	const Ref<Texture2D> texture = p_image;
	if (p_image.is_null() || texture.is_valid() || has_content(image)) {
		return true;
	}
	report(ScatterGroundHeightmap::class_name,
			{image.is_valid() ? ErrorCode::wrong_size : ErrorCode::missing, property, 0.0, {}, {},
					"Use an image that has pixels"});
	return false;
}

} // namespace

std::shared_ptr<const Terrain> ScatterGroundHeightmap::make_snapshot(const GroundHost &) { return field_; }

String ScatterGroundHeightmap::find_problem() {
	if (image_.is_null() && heightmap_path_.is_empty()) {
		return sentence(class_name, Status::missing("heightmap_path", "Set heightmap_path or image"));
	}
	return problem_;
}

String ScatterGroundHeightmap::find_export_problem() {
	if (is_stripped(image_)) {
		return stripped_problem("ScatterGroundHeightmap.image", "there is no ground");
	}
	return is_stripped(weight_image_)
			? stripped_problem("ScatterGroundHeightmap.weight_image", "the ground has no textures")
			: String();
}

bool ScatterGroundHeightmap::embed_stripped_data() {
	bool any_embedded = false;
	for (Ref<Resource> *property : {&image_, &weight_image_}) {
		const Ref<Texture2D> texture = *property;
		const Ref<Image> image = texture.is_valid() ? texture->get_image() : Ref<Image>();
		if (has_content(image)) {
			exchange_image(*property, image, property == &image_ ? weight_image_ : image_);
			any_embedded = true;
		}
	}
	return any_embedded;
}

void ScatterGroundHeightmap::image_changed() {
	sources_stale_ = true;
	change();
}

void ScatterGroundHeightmap::set_heightmap_path(const String &p_path) {
	// The inspector sets the UID of an imported file, which is lost if its import is disabled.
	ResourceUID *ids = ResourceUID::get_singleton();
	const std::int64_t id = p_path.begins_with("uid://") ? ids->text_to_id(p_path) : 0;
	heightmap_path_ = id > 0 && ids->has_id(id) ? ids->get_id_path(id) : p_path;
	image_changed();
}

String ScatterGroundHeightmap::get_heightmap_path() const { return heightmap_path_; }

void ScatterGroundHeightmap::set_post_count(const Vector2i &p_count) {
	const auto is_valid_count = [](int count) {
		return accept_number(class_name, "post_count", count, 2.0, max_heightfield_posts);
	};
	const bool is_unset = p_count.x == 0 && p_count.y == 0;
	if (is_unset || (is_valid_count(p_count.x) && is_valid_count(p_count.y))) {
		post_count_ = p_count;
		image_changed();
	}
}

Vector2i ScatterGroundHeightmap::get_post_count() const { return post_count_; }

// Replaces an image and watches the new one. If both properties have the same image, it is watched
// until neither uses it.
void ScatterGroundHeightmap::exchange_image(
		Ref<Resource> &r_image, const Ref<Resource> &p_image, const Ref<Resource> &p_other) {
	if (r_image != p_other) {
		watch(r_image.ptr(), "changed", this, "_image_changed", false);
	}
	r_image = p_image;
	watch(r_image.ptr(), "changed", this, "_image_changed", true);
	image_changed();
}

void ScatterGroundHeightmap::set_image(const Ref<Resource> &p_image) {
	if (accept_image("image", p_image)) {
		exchange_image(image_, p_image, weight_image_);
	}
}

Ref<Resource> ScatterGroundHeightmap::get_image() const { return image_; }

void ScatterGroundHeightmap::set_weight_image(const Ref<Resource> &p_image) {
	if (accept_image("weight_image", p_image)) {
		exchange_image(weight_image_, p_image, image_);
	}
}

Ref<Resource> ScatterGroundHeightmap::get_weight_image() const { return weight_image_; }

void ScatterGroundHeightmap::set_heights_in_meters(bool p_meters) {
	heights_in_meters_ = p_meters;
	change();
}

bool ScatterGroundHeightmap::is_heights_in_meters() const { return heights_in_meters_; }

void ScatterGroundHeightmap::set_rect(const Rect2 &p_rect) {
	for (const real_t value : {p_rect.position.x, p_rect.position.y}) {
		if (!accept_number(class_name, "rect", value, -1e9, 1e9)) {
			return;
		}
	}
	for (const real_t value : {p_rect.size.x, p_rect.size.y}) {
		if (!accept_number(class_name, "rect", value, 1e-3, 1e9)) {
			return;
		}
	}
	rect_ = p_rect;
	change();
}

Rect2 ScatterGroundHeightmap::get_rect() const { return rect_; }

void ScatterGroundHeightmap::set_min_height(double p_height) {
	if (accept_number(class_name, "min_height", p_height, -height_limit, height_limit)) {
		min_height_ = p_height;
		change();
	}
}

double ScatterGroundHeightmap::get_min_height() const { return min_height_; }

void ScatterGroundHeightmap::set_max_height(double p_height) {
	if (accept_number(class_name, "max_height", p_height, -height_limit, height_limit)) {
		max_height_ = p_height;
		change();
	}
}

double ScatterGroundHeightmap::get_max_height() const { return max_height_; }

void ScatterGroundHeightmap::_bind_methods() {
	using Self = ScatterGroundHeightmap;
	bind_guarded<&Self::set_heightmap_path>(D_METHOD("set_heightmap_path", "path"));
	bind_guarded<&Self::get_heightmap_path>(D_METHOD("get_heightmap_path"));
	bind_guarded<&Self::set_post_count>(D_METHOD("set_post_count", "count"));
	bind_guarded<&Self::get_post_count>(D_METHOD("get_post_count"));
	bind_guarded<&Self::set_image>(D_METHOD("set_image", "image"));
	bind_guarded<&Self::get_image>(D_METHOD("get_image"));
	bind_guarded<&Self::set_heights_in_meters>(D_METHOD("set_heights_in_meters", "meters"));
	bind_guarded<&Self::is_heights_in_meters>(D_METHOD("is_heights_in_meters"));
	bind_guarded<&Self::set_weight_image>(D_METHOD("set_weight_image", "image"));
	bind_guarded<&Self::get_weight_image>(D_METHOD("get_weight_image"));
	bind_guarded<&Self::embed_stripped_data>(D_METHOD("embed_stripped_data"));
	bind_guarded<&Self::update_region>(D_METHOD("update_region", "region"));
	bind_guarded<&Self::get_summary>(D_METHOD("get_summary"));
	bind_guarded<&Self::image_changed>(ThreadUse::relayed, D_METHOD("_image_changed"));
	bind_guarded<&Self::set_rect>(D_METHOD("set_rect", "rect"));
	bind_guarded<&Self::get_rect>(D_METHOD("get_rect"));
	bind_guarded<&Self::set_min_height>(D_METHOD("set_min_height", "height"));
	bind_guarded<&Self::get_min_height>(D_METHOD("get_min_height"));
	bind_guarded<&Self::set_max_height>(D_METHOD("set_max_height", "height"));
	bind_guarded<&Self::get_max_height>(D_METHOD("get_max_height"));
	ADD_PROPERTY(PropertyInfo(Variant::STRING, "heightmap_path", PROPERTY_HINT_FILE,
						 "*.png,*.exr,*.r8,*.r16,*.r32,*.f32,*.raw"),
			"set_heightmap_path", "get_heightmap_path");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR2I, "post_count"), "set_post_count", "get_post_count");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "image", PROPERTY_HINT_RESOURCE_TYPE, "Image,Texture2D"), "set_image",
			"get_image");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "heights_in_meters"), "set_heights_in_meters", "is_heights_in_meters");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "weight_image", PROPERTY_HINT_RESOURCE_TYPE, "Image,Texture2D"),
			"set_weight_image", "get_weight_image");
	ADD_PROPERTY(PropertyInfo(Variant::RECT2, "rect", PROPERTY_HINT_NONE, "suffix:m"), "set_rect", "get_rect");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "min_height", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_min_height", "get_min_height");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "max_height", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_max_height", "get_max_height");
}

} // namespace thicket
