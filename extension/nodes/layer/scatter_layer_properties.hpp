#pragma once

// This file contains setters, getters and ClassDB bindings for the constants that describe
// properties of a ScatterLayer. Include it only in sources that define such constants.

#include "nodes/layer/layer_property_use.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <type_traits>

namespace thicket {

inline constexpr double max_view_distance = 1e6; ///< A distance in meters beyond which nothing is visible.

/// Deduces the part that contains a member. This function is never called; only its return type is
/// used.
template <class Values, class Number>
Values owner_of(Number Values::*);

/// The type of the part that contains the member of a property.
template <const auto &property>
using PartOf = decltype(owner_of(property.member));

template <class Values, class Self>
auto &ScatterLayer::part(Self &self) {
	if constexpr (std::is_same_v<Values, PointSet>) {
		return self.settings_.set;
	} else if constexpr (std::is_same_v<Values, Rules>) {
		return self.settings_.rules;
	} else if constexpr (std::is_same_v<Values, Clumping>) {
		return self.settings_.rules.clumping;
	} else if constexpr (std::is_same_v<Values, Placement>) {
		return self.settings_.placement;
	} else if constexpr (std::is_same_v<Values, InstanceData>) {
		return self.settings_.instance_data;
	} else if constexpr (std::is_same_v<Values, StreamLayer>) {
		return self.range_;
	} else if constexpr (std::is_same_v<Values, LayerDrawing>) {
		return self.drawing_;
	} else if constexpr (std::is_same_v<Values, LodSettings>) {
		return self.lod_;
	} else if constexpr (std::is_same_v<Values, LayerGameplay>) {
		return self.gameplay_;
	} else if constexpr (std::is_same_v<Values, LayerCollision>) {
		return self.gameplay_.collision;
	} else if constexpr (std::is_same_v<Values, LayerScene>) {
		return self.gameplay_.scene;
	} else if constexpr (std::is_same_v<Values, LayerLinks>) {
		return self.links_;
	} else if constexpr (std::is_same_v<Values, MaskFrame>) {
		return self.mask_frame_;
	} else if constexpr (std::is_same_v<Values, LayerTables>) {
		return self.tables_;
	} else {
		static_assert(std::is_same_v<Values, LayerIdentity>, "a layer has no such part");
		return self.identity_;
	}
}

/// Returns the use of a property, according to the part that contains its member.
template <const auto &property>
constexpr PropertyUse use_of() {
	using Part = PartOf<property>;
	if constexpr (std::is_same_v<Part, LayerDrawing> || std::is_same_v<Part, LodSettings>) {
		return PropertyUse::drawing;
	} else if constexpr (std::is_same_v<Part, StreamLayer>) {
		// Transforms are floats relative to the center of a tile, so the tile size affects
		// placement.
		return property.member == &StreamLayer::tile_size ? PropertyUse::placement : PropertyUse::drawing;
	} else if constexpr (std::is_same_v<Part, LayerGameplay> || std::is_same_v<Part, LayerCollision> ||
			std::is_same_v<Part, LayerScene>) {
		return PropertyUse::gameplay;
	} else {
		return PropertyUse::placement;
	}
}

template <const auto &property>
void ScatterLayer::set_number(double p_value) {
	const double min = property.min_nonzero > 0.0 && p_value > 0.0 ? property.min_nonzero : property.min;
	double &value = part<PartOf<property>>(*this).*property.member;
	if (accept_number(ScatterLayer::class_name, property.name, p_value, min, property.max) && value != p_value) {
		value = p_value;
		mark_changed();
	}
}

template <const auto &property>
double ScatterLayer::get_number() const {
	return part<PartOf<property>>(*this).*property.member;
}

template <const auto &property>
void ScatterLayer::set_integer(int64_t p_value) {
	auto &value = part<PartOf<property>>(*this).*property.member;
	if (accept_number(ScatterLayer::class_name, property.name, static_cast<double>(p_value),
				static_cast<double>(property.min), static_cast<double>(property.max)) &&
			static_cast<int64_t>(value) != p_value) {
		value = static_cast<std::remove_reference_t<decltype(value)>>(p_value);
		mark_changed();
	}
}

template <const auto &property>
int64_t ScatterLayer::get_integer() const {
	return static_cast<int64_t>(part<PartOf<property>>(*this).*property.member);
}

template <const auto &property>
void ScatterLayer::set_switch(bool p_value) {
	bool &value = part<PartOf<property>>(*this).*property.member;
	if (value != p_value) {
		value = p_value;
		mark_changed();
	}
}

template <const auto &property>
bool ScatterLayer::get_switch() const {
	return part<PartOf<property>>(*this).*property.member;
}

template <const auto &property>
void ScatterLayer::set_resource(const godot::Ref<ResourceOf<property>> &p_resource) {
	godot::Ref<godot::Resource> &current = resources_[property.name].value;
	if (current.ptr() == p_resource.ptr()) {
		return;
	}
	// Use a separate handler for each property, because one resource may be the value of several
	// properties.
	const godot::StringName on_change = "_" + godot::String(property.name) + "_changed";
	watch(current.ptr(), "changed", this, on_change, false);
	current = p_resource;
	watch(current.ptr(), "changed", this, on_change, true);
	resource_changed<property>();
}

template <const auto &property>
godot::Ref<ResourceOf<property>> ScatterLayer::get_resource() const {
	return resource(property.name);
}

template <const auto &property>
void ScatterLayer::resource_changed() {
	resources_[property.name].remake = &ScatterLayer::remake<property>;
	mark_changed();
}

template <const auto &property>
void ScatterLayer::remake() {
	replace(part<PartOf<property>>(*this).*property.member, property.make(get_resource<property>()));
}

template <const auto &property>
void ScatterLayer::bind_number() {
	const godot::String name = property.name;
	const godot::String setter = "set_" + name;
	const godot::String getter = "get_" + name;
	bind_guarded<&ScatterLayer::set_number<property>>(godot::D_METHOD(godot::StringName(setter), "value"));
	bind_guarded<&ScatterLayer::get_number<property>>(godot::D_METHOD(godot::StringName(getter)));
	add_layer_property(use_of<property>(),
			godot::PropertyInfo(godot::Variant::FLOAT, name, property.hint, property.hint_string), setter, getter);
}

template <const auto &property>
void ScatterLayer::bind_integer() {
	const godot::String name = property.name;
	const godot::String setter = "set_" + name;
	const godot::String getter = "get_" + name;
	bind_guarded<&ScatterLayer::set_integer<property>>(godot::D_METHOD(godot::StringName(setter), "value"));
	bind_guarded<&ScatterLayer::get_integer<property>>(godot::D_METHOD(godot::StringName(getter)));
	add_layer_property(use_of<property>(),
			godot::PropertyInfo(godot::Variant::INT, name, property.hint, property.hint_string), setter, getter);
}

template <const auto &property>
void ScatterLayer::bind_switch() {
	const godot::String name = property.name;
	const godot::String setter = "set_" + name;
	const godot::String getter = property.getter;
	bind_guarded<&ScatterLayer::set_switch<property>>(godot::D_METHOD(godot::StringName(setter), "enabled"));
	bind_guarded<&ScatterLayer::get_switch<property>>(godot::D_METHOD(godot::StringName(getter)));
	add_layer_property(use_of<property>(), godot::PropertyInfo(godot::Variant::BOOL, name), setter, getter);
}

template <const auto &property>
void ScatterLayer::bind_resource() {
	const godot::String name = property.name;
	const godot::String setter = "set_" + name;
	const godot::String getter = "get_" + name;
	const godot::String on_change = "_" + name + godot::String("_changed");
	bind_guarded<&ScatterLayer::set_resource<property>>(godot::D_METHOD(godot::StringName(setter), "resource"));
	bind_guarded<&ScatterLayer::get_resource<property>>(godot::D_METHOD(godot::StringName(getter)));
	bind_guarded<&ScatterLayer::resource_changed<property>>(
			ThreadUse::relayed, godot::D_METHOD(godot::StringName(on_change)));
	add_layer_property(use_of<property>(),
			godot::PropertyInfo(godot::Variant::OBJECT, name, godot::PROPERTY_HINT_RESOURCE_TYPE,
					ResourceOf<property>::get_class_static()),
			setter, getter);
}

} // namespace thicket
