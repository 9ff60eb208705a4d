// This file creates a snapshot of a layer from its properties, resources and lists.

#include "core/model/lod_shadow.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/layer/layer_materials.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/mesh_fades.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns the distance in meters from a mesh's origin to the farthest corner of its bounding box.
float reach_of(const AABB &box) {
	const Vector3 far_corner = box.position.abs().max((box.position + box.size).abs());
	return static_cast<float>(far_corner.length());
}

AABB box_of(const Ref<Mesh> &mesh) { return mesh.is_valid() ? mesh->get_aabb() : AABB(); }

float reach_of(const MeshAppearance &appearance) {
	return std::max(reach_of(box_of(appearance.mesh)), reach_of(box_of(appearance.shadow.mesh)));
}

void add_boxes(const LodSettings &lod, LayerDrawing &r_drawing) {
	for (const MeshAppearance &appearance : r_drawing.meshes) {
		r_drawing.boxes.push_back(box_of(appearance.mesh));
		r_drawing.mesh_reach.push_back(reach_of(appearance));
	}
	for (std::size_t index = 0; index < r_drawing.lod_meshes.size(); ++index) {
		float &reach = r_drawing.mesh_reach[index % r_drawing.meshes.size()];
		reach = std::max(reach, reach_of(r_drawing.lod_meshes[index]));
	}
	for (float &reach : r_drawing.mesh_reach) {
		reach *= static_cast<float>(compensating_scale(lod, lod.thin_density));
	}
}

/// Disables shadows of LODs for which they are not worth drawing (see casts_shadow). Affects only
/// LODs without a shadow setting, in layers with the default setting. An LOD with a separate shadow
/// mesh keeps its shadow.
void omit_shadows(const LayerSettings &settings, const LodSettings &lod, LayerDrawing &r_drawing) {
	const double density = point_density(settings.set) * settings.rules.density;
	for (std::size_t index = 0; index < r_drawing.lod_meshes.size(); ++index) {
		MeshShadow &shadow = r_drawing.lod_meshes[index].shadow;
		const std::size_t entries = r_drawing.meshes.size();
		const glm::dvec3 size = to_core(r_drawing.boxes[index % entries].size) * double{settings.placement.max_scale};
		const bool can_omit = shadow.setting == MeshShadow::as_layer && shadow.mesh.is_null();
		if (can_omit && !casts_shadow({size, density, lod.lod_distances[index / entries]})) {
			shadow.setting = MeshShadow::as_layer_unless_on;
		}
	}
}

/// Adds the distance by which wind moves vertices to the cull margin. The boxes do not include this
/// distance, because viewer distances are measured to the boxes and must not depend on wind.
void add_sway(LayerDrawing &r_drawing) {
	r_drawing.extra_cull_margin =
			std::min(r_drawing.extra_cull_margin + sway_reach(materials_of(r_drawing)), max_cull_margin);
}

/// Returns how finely to divide tiles into cells near viewers. Does not depend on the rules, so
/// editing a rule does not cause a new division, which would upload the tiles again.
CellSettings cells_of(const LayerSettings &settings, double tile_size, const LayerDrawing &drawing) {
	const float reach = drawing.mesh_reach.empty() ? 0.0F : std::ranges::max(drawing.mesh_reach);
	const double density = point_density(settings.set) / std::max(static_cast<double>(drawing.meshes.size()), 1.0);
	const double custom_size = drawing.draw_cell_size;
	return {tile_size,
			cell_count_per_edge(tile_size, custom_size > 0.0 ? custom_size : default_cell_size(reach, density))};
}

} // namespace

LayerSnapshot ScatterLayer::snapshot(std::uint64_t seed, std::size_t index) {
	refresh();
	LayerSnapshot result;
	result.settings = std::make_shared<const LayerSettings>(settings(seed, index));
	result.range = range_;
	result.lod = lod_;
	result.drawing = drawing_;
	result.drawing.material_override = material_override_;
	meshes_.draw(result.drawing, result.lod);
	add_boxes(result.lod, result.drawing);
	result.lod.sight_end = result.range.view_distance;
	add_fades(result.drawing);
	omit_shadows(*result.settings, result.lod, result.drawing);
	add_sway(result.drawing);
	result.cells = cells_of(*result.settings, result.range.tile_size, result.drawing);
	result.gameplay = gameplay();
	if (rows_.is_valid()) {
		result.rows = LayerRows{String(rows_->get_path_group()).utf8().get_data(), rows_->rows()};
	}
	result.links = links();
	result.field_names = field_names();
	result.density_rule_names = density_rule_names_;
	return result;
}

LayerSettings ScatterLayer::settings(std::uint64_t seed, std::size_t index) const {
	LayerSettings result = settings_;
	result.set = point_set();
	if (rows_.is_valid() && rows_->is_aligning_to_rows()) {
		const RowYaw &yaw = rows_->yaw();
		result.placement.min_yaw_degrees = yaw.degrees - yaw.jitter;
		result.placement.max_yaw_degrees = yaw.degrees + yaw.jitter;
	}
	result.instance_data = instance_data();
	result.set.seed = seed;
	result.set.layer = static_cast<std::uint16_t>(own_id() >= 0 ? static_cast<std::size_t>(own_id()) : index);
	result.set.faces = permitted_faces(result);
	if (tables_.noise != nullptr) {
		result.rules.fields.push_back(tables_.noise);
	}
	if (tables_.image != nullptr) {
		result.rules.fields.push_back(tables_.image);
	}
	result.rules.ground_textures.assign(ground_textures_.ptr(), ground_textures_.ptr() + ground_textures_.size());
	if (mask_.is_valid()) {
		result.rules.mask = mask_->snapshot();
	}
	for (int64_t mesh = 0; mesh < static_cast<int64_t>(meshes_.size()); ++mesh) {
		result.mesh_weights.push_back(mesh < mesh_weights_.size() ? mesh_weights_[mesh] : 1.0F);
	}
	result.mesh_rules = mesh_rules();
	result.world_sources = empty_sources(result);
	for (WorldSource &source : result.world_sources) {
		if (source.input.kind == WorldInputKind::mask) {
			source.mask = tables_.channels[static_cast<std::size_t>(source.input.number)];
		}
	}
	return result;
}

std::vector<WorldInput> ScatterLayer::world_inputs() const {
	std::vector<WorldInput> inputs;
	const auto add = [&inputs](const SharedExpression &expression) {
		if (expression != nullptr) {
			inputs.insert(inputs.end(), expression->world_inputs().begin(), expression->world_inputs().end());
		}
	};
	add(settings_.rules.expression);
	std::ranges::for_each(mesh_expressions_, add);
	return inputs;
}

/// Returns the bit of each channel of the mask texture that an expression uses.
std::uint32_t ScatterLayer::used_mask_channels() const {
	std::uint32_t channels = 0;
	for (const WorldInput &input : world_inputs()) {
		channels |= input.kind == WorldInputKind::mask ? 1U << static_cast<unsigned>(input.number) : 0U;
	}
	return channels;
}

/// Returns the rules of the meshes; empty if none has any.
std::vector<std::optional<Rules>> ScatterLayer::mesh_rules() const {
	std::vector<std::optional<Rules>> rules;
	for (std::size_t mesh = 0; mesh < std::min(meshes_.size(), mesh_expressions_.size()); ++mesh) {
		if (mesh_expressions_[mesh] != nullptr) {
			rules.resize(mesh + 1);
			rules[mesh] = open_rules();
			rules[mesh]->expression = mesh_expressions_[mesh];
		}
	}
	return rules;
}

/// Returns the names in the order of the fields in `settings`.
std::vector<std::string> ScatterLayer::field_names() const {
	std::vector<std::string> names;
	if (tables_.noise != nullptr) {
		names.emplace_back("noise");
	}
	if (tables_.image != nullptr) {
		names.emplace_back("mask_texture");
	}
	return names;
}

LayerGameplay ScatterLayer::gameplay() const {
	LayerGameplay result = gameplay_;
	if (physics_material_.is_valid()) {
		const double friction = physics_material_->get_friction();
		const double bounce = physics_material_->get_bounce();
		result.collision.friction = physics_material_->is_rough() ? -friction : friction;
		result.collision.bounce = physics_material_->is_absorbent() ? -bounce : bounce;
	}
	result.scene.scene = scene_;
	if (result.collision.shape == BodyShape::model) {
		result.collision.parts = meshes_.bodies();
	} else if (needs_stored_hulls()) {
		use_stored_hulls(result.collision);
	}
	return result;
}

LayerLinks ScatterLayer::links() {
	refresh();
	LayerLinks result = links_;
	const InstanceData data = instance_data();
	if (data.color.kind == SourceKind::distance) {
		result.color_layer = core_reference(color_value_->stored_layer());
	}
	if (data.variation.kind == SourceKind::distance) {
		result.variation_layer = core_reference(variation_value_->stored_layer());
	}
	if (data.scale.kind == SourceKind::distance) {
		result.scale_layer = core_reference(scale_value_->stored_layer());
	}
	for (const WorldInput &input : world_inputs()) {
		if (input.kind == WorldInputKind::distance) {
			result.measured_layers.insert(input.name);
		}
	}
	result.name = get_name().utf8().get_data();
	result.identity = get_instance_id();
	result.on_surface = settings_.set.on_surface;
	if (result.proximity_curve == nullptr) {
		result.proximity_curve = tables_.proximity_line;
	}
	return result;
}

/// Rebuilds the data of resources that may have changed, and converts stored properties of release
/// 0.2.
void ScatterLayer::refresh() {
	convert_former_lods(true);
	range_.view_distance = former_visibility_.limit(range_.view_distance);
	for (auto &[name, resource] : resources_) {
		if (const auto remake = std::exchange(resource.remake, nullptr)) {
			(this->*remake)();
		}
	}
	tables_.refresh(mask_frame_, used_mask_channels(), links_.proximity_distance);
	if (density_rules_outdated_) {
		remake_density_rules();
	}
}

Ref<Resource> ScatterLayer::resource(std::string_view property) const {
	const auto entry = resources_.find(property);
	return entry == resources_.end() ? Ref<Resource>() : entry->second.value;
}

QueryLayer query_layer(const LayerSnapshot *layer) {
	QueryLayer result;
	result.wanted = layer != nullptr;
	if (layer != nullptr) {
		const LayerSettings &settings = *layer->settings;
		result.set = settings.set;
		result.fills = fills(settings);
		result.rows = settings.rows;
		result.tile_size = layer->range.tile_size;
		result.shape = {layer->gameplay.instance_radius, layer->gameplay.instance_height};
		result.max_scale = settings.placement.max_scale;
		result.max_offset = std::abs(settings.placement.offset_along_normal);
		if (layer->range.in_space()) {
			result.max_offset += std::abs(settings.placement.height_offset);
			result.bottom = layer->range.bottom;
			result.top = layer->range.top;
		}
	}
	return result;
}

} // namespace thicket
