// This file contains the properties of ScatterLayer for its masks: a painted mask and a texture.

#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

namespace {

TextureSource unread_texture(const Ref<Texture2D> &p_texture) { return {p_texture, true}; }

constexpr ResourceProperty mask_texture{"mask_texture", &LayerTables::mask_texture, unread_texture};
constexpr NumberProperty mask_texture_channel{
		"mask_texture_channel", &MaskFrame::channel, ScatterLayer::MASK_CHANNEL_RED, ScatterLayer::MASK_CHANNEL_NONE};
constexpr NumberProperty mask_texture_edge{
		"mask_texture_edge", &MaskFrame::edge, ScatterLayer::MASK_EDGE_NOTHING, ScatterLayer::MASK_EDGE_REPEAT};

} // namespace

// Watches the mask. Painting emits `area_changed`; changes to the whole mask emit `changed`.
void ScatterLayer::watch_mask(bool p_watch) {
	watch(mask_.ptr(), "changed", this, "emit_changed", p_watch);
	watch(mask_.ptr(), "area_changed", this, "_mask_area_changed", p_watch);
}

void ScatterLayer::set_mask(const Ref<ScatterMask> &p_mask) {
	if (mask_ == p_mask) {
		return;
	}
	watch_mask(false);
	mask_ = p_mask;
	watch_mask(true);
	mark_changed();
}

Ref<ScatterMask> ScatterLayer::get_mask() const { return mask_; }

void ScatterLayer::mask_area_changed(const Rect2 &p_rect) { emit_signal("area_changed", p_rect); }

void ScatterLayer::set_mask_texture_rect(const Rect2 &p_rect) {
	constexpr double limit = 1e9;
	constexpr double min_side = 1e-3;
	for (const real_t coordinate : {p_rect.position.x, p_rect.position.y}) {
		if (!accept_number(ScatterLayer::class_name, "mask_texture_rect", coordinate, -limit, limit)) {
			return;
		}
	}
	for (const real_t side : {p_rect.size.x, p_rect.size.y}) {
		if (!accept_number(ScatterLayer::class_name, "mask_texture_rect", side, min_side, limit)) {
			return;
		}
	}
	if (mask_texture_rect_ != p_rect) {
		mask_texture_rect_ = p_rect;
		mask_frame_.area.min = {p_rect.position.x, p_rect.position.y};
		mask_frame_.area.max = mask_frame_.area.min + glm::dvec2{p_rect.size.x, p_rect.size.y};
		mark_changed();
	}
}

Rect2 ScatterLayer::get_mask_texture_rect() const { return mask_texture_rect_; }

void ScatterLayer::set_mask_texture_channel(MaskChannel p_channel) { set_integer<mask_texture_channel>(p_channel); }

ScatterLayer::MaskChannel ScatterLayer::get_mask_texture_channel() const {
	return static_cast<MaskChannel>(mask_frame_.channel);
}

void ScatterLayer::set_mask_texture_edge(MaskEdge p_edge) { set_integer<mask_texture_edge>(p_edge); }

ScatterLayer::MaskEdge ScatterLayer::get_mask_texture_edge() const { return static_cast<MaskEdge>(mask_frame_.edge); }

void ScatterLayer::bind_masks() {
	ADD_SUBGROUP("Mask", "mask_");
	bind_guarded<&ScatterLayer::set_mask>(D_METHOD("set_mask", "mask"));
	bind_guarded<&ScatterLayer::get_mask>(D_METHOD("get_mask"));
	bind_guarded<&ScatterLayer::mask_area_changed>(ThreadUse::relayed, D_METHOD("_mask_area_changed", "rect"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::OBJECT, "mask", PROPERTY_HINT_RESOURCE_TYPE, "ScatterMask"), "set_mask", "get_mask");
	bind_resource<mask_texture>();
	bind_guarded<&ScatterLayer::set_mask_texture_rect>(D_METHOD("set_mask_texture_rect", "rect"));
	bind_guarded<&ScatterLayer::get_mask_texture_rect>(D_METHOD("get_mask_texture_rect"));
	bind_guarded<&ScatterLayer::set_mask_texture_channel>(D_METHOD("set_mask_texture_channel", "channel"));
	bind_guarded<&ScatterLayer::get_mask_texture_channel>(D_METHOD("get_mask_texture_channel"));
	bind_guarded<&ScatterLayer::set_mask_texture_edge>(D_METHOD("set_mask_texture_edge", "edge"));
	bind_guarded<&ScatterLayer::get_mask_texture_edge>(D_METHOD("get_mask_texture_edge"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::RECT2, "mask_texture_rect", PROPERTY_HINT_NONE, "suffix:m"), "set_mask_texture_rect",
			"get_mask_texture_rect");
	add_layer_property(PropertyUse::placement,
			PropertyInfo(
					Variant::INT, "mask_texture_channel", PROPERTY_HINT_ENUM, "Red,Green,Blue,Alpha,Luminance,None"),
			"set_mask_texture_channel", "get_mask_texture_channel");
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::INT, "mask_texture_edge", PROPERTY_HINT_ENUM, "Nothing,Everything,Clamp,Repeat"),
			"set_mask_texture_edge", "get_mask_texture_edge");
	BIND_ENUM_CONSTANT(MASK_CHANNEL_RED);
	BIND_ENUM_CONSTANT(MASK_CHANNEL_GREEN);
	BIND_ENUM_CONSTANT(MASK_CHANNEL_BLUE);
	BIND_ENUM_CONSTANT(MASK_CHANNEL_ALPHA);
	BIND_ENUM_CONSTANT(MASK_CHANNEL_LUMINANCE);
	BIND_ENUM_CONSTANT(MASK_CHANNEL_NONE);
	BIND_ENUM_CONSTANT(MASK_EDGE_NOTHING);
	BIND_ENUM_CONSTANT(MASK_EDGE_EVERYTHING);
	BIND_ENUM_CONSTANT(MASK_EDGE_CLAMP);
	BIND_ENUM_CONSTANT(MASK_EDGE_REPEAT);
}

} // namespace thicket
