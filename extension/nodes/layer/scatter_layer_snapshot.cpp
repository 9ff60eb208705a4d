// What a layer is at this moment: everything that its properties say is copied here, and nowhere else. A new property is of no
// effect until it is copied; tests/engine/test_layer_snapshot.gd changes each of them alone.

#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Meters from a mesh's origin to the farthest corner of its box.
float reach_of(const AABB &box) {
	const Vector3 far_corner = box.position.abs().max((box.position + box.size).abs());
	return static_cast<float>(far_corner.length());
}

AABB box_of(const Ref<Mesh> &mesh) { return mesh.is_valid() ? mesh->get_aabb() : AABB(); }

std::vector<Ref<Mesh>> mesh_list(const TypedArray<Mesh> &p_meshes, int64_t count) {
	std::vector<Ref<Mesh>> result;
	for (int64_t mesh = 0; mesh < count; ++mesh) {
		result.emplace_back(p_meshes[mesh]);
	}
	return result;
}

void add_boxes(const Detail &lod, LayerDrawing &r_drawing) {
	for (const Ref<Mesh> &mesh : r_drawing.meshes) {
		r_drawing.boxes.push_back(box_of(mesh));
		r_drawing.mesh_reach.push_back(reach_of(r_drawing.boxes.back()));
	}
	for (std::size_t index = 0; index < r_drawing.lod_meshes.size(); ++index) {
		float &reach = r_drawing.mesh_reach[index % r_drawing.meshes.size()];
		reach = std::max(reach, reach_of(box_of(r_drawing.lod_meshes[index])));
	}
	for (float &reach : r_drawing.mesh_reach) {
		reach *= static_cast<float>(compensating_scale(lod, lod.thin_density));
	}
}

} // namespace

LayerSnapshot ScatterLayer::snapshot(std::uint64_t seed, std::size_t index) const {
	LayerSnapshot result;
	result.settings = std::make_shared<const LayerSettings>(settings(seed, index));
	result.range = {numbers_.tile_size, numbers_.view_distance};
	result.lod = lod();
	result.drawing = drawing();
	add_boxes(result.lod, result.drawing);
	result.gameplay = gameplay();
	result.links = links();
	return result;
}

LayerSettings ScatterLayer::settings(std::uint64_t seed, std::size_t index) const {
	LayerSettings result;
	const bool own_id = integers_.layer_id >= 0;
	result.set.seed = seed;
	result.set.radius = numbers_.radius;
	result.set.levels = static_cast<std::uint32_t>(integers_.progressive_levels);
	result.set.layer = static_cast<std::uint16_t>(own_id ? static_cast<std::size_t>(integers_.layer_id) : index);
	result.rules = rules();
	result.placement = placement();
	result.look = {switches_.use_colors, tables().colors, switches_.use_custom_data};
	for (int64_t mesh = 0; mesh < meshes_.size(); ++mesh) {
		result.mesh_weights.push_back(mesh < mesh_weights_.size() ? mesh_weights_[mesh] : 1.0F);
	}
	return result;
}

Rules ScatterLayer::rules() const {
	const LayerTables &made = tables();
	Rules rules;
	rules.density = numbers_.density;
	rules.min_slope_degrees = numbers_.min_slope_degrees;
	rules.max_slope_degrees = numbers_.max_slope_degrees;
	rules.slope_falloff = numbers_.slope_falloff;
	rules.min_height = numbers_.min_height;
	rules.max_height = numbers_.max_height;
	rules.height_falloff = numbers_.height_falloff;
	rules.height_curve = made.height_curve;
	rules.slope_curve = made.slope_curve;
	if (made.noise != nullptr) {
		rules.fields.push_back(made.noise);
	}
	if (made.image != nullptr) {
		rules.fields.push_back(made.image);
	}
	rules.clumping = {numbers_.clump_size, numbers_.clump_coverage, numbers_.clump_softness};
	rules.ground_textures.assign(ground_textures_.ptr(), ground_textures_.ptr() + ground_textures_.size());
	rules.edge_feather = numbers_.edge_feather;
	if (mask_.is_valid()) {
		rules.mask = mask_->snapshot();
	}
	return rules;
}

Placement ScatterLayer::placement() const {
	Placement placement;
	placement.min_yaw_degrees = numbers_.min_yaw_degrees;
	placement.max_yaw_degrees = numbers_.max_yaw_degrees;
	placement.min_tilt_degrees = numbers_.min_tilt_degrees;
	placement.max_tilt_degrees = numbers_.max_tilt_degrees;
	placement.min_scale = numbers_.min_scale;
	placement.max_scale = numbers_.max_scale;
	placement.scale_curve = tables().scale_curve;
	placement.align_to_normal = numbers_.align_to_normal;
	placement.height_offset = numbers_.height_offset;
	placement.offset_along_normal = numbers_.offset_along_normal;
	return placement;
}

LayerDrawing ScatterLayer::drawing() const {
	LayerDrawing result;
	// Whole rows of LOD meshes only.
	const int64_t rows = meshes_.is_empty() ? 0 : lod_meshes_.size() / meshes_.size();
	result.meshes = mesh_list(meshes_, meshes_.size());
	result.lod_meshes = mesh_list(lod_meshes_, rows * meshes_.size());
	result.material_override = material_override_;
	result.cast_shadow = integers_.cast_shadow;
	result.gi_mode = integers_.gi_mode;
	result.render_layers = integers_.render_layers;
	result.lod_bias = numbers_.lod_bias;
	result.extra_cull_margin = numbers_.extra_cull_margin;
	result.visibility_range_begin = numbers_.visibility_range_begin;
	result.visibility_range_begin_margin = numbers_.visibility_range_begin_margin;
	result.visibility_range_end = numbers_.visibility_range_end;
	result.visibility_range_end_margin = numbers_.visibility_range_end_margin;
	result.visibility_range_fade_mode = integers_.visibility_range_fade_mode;
	return result;
}

Detail ScatterLayer::lod() const {
	Detail lod;
	lod.lod_distances.assign(lod_distances_.ptr(), lod_distances_.ptr() + lod_distances_.size());
	lod.thin_begin = numbers_.thin_begin;
	lod.thin_end = numbers_.thin_end;
	lod.thin_density = numbers_.thin_density;
	lod.scale_compensation = switches_.thin_scale_compensation;
	return lod;
}

LayerGameplay ScatterLayer::gameplay() const {
	LayerGameplay result;
	result.instance_radius = numbers_.instance_radius;
	result.instance_height = numbers_.instance_height;
	result.regrowth_time = numbers_.regrowth_time;
	result.collision.shape = static_cast<BodyShape>(integers_.collision_shape);
	result.collision.distance = numbers_.collision_distance;
	result.collision.layer = integers_.collision_layer;
	result.collision.mask = integers_.collision_mask;
	if (physics_material_.is_valid()) {
		const double friction = physics_material_->get_friction();
		const double bounce = physics_material_->get_bounce();
		result.collision.friction = physics_material_->is_rough() ? -friction : friction;
		result.collision.bounce = physics_material_->is_absorbent() ? -bounce : bounce;
	}
	result.scene = {scene_, numbers_.scene_distance};
	return result;
}

LayerLinks ScatterLayer::links() const {
	LayerLinks result;
	result.name = get_name().utf8().get_data();
	result.identity = get_instance_id();
	result.spacing = spacing_;
	result.proximity_layer = core_reference(proximity_layer_);
	result.proximity_distance = numbers_.proximity_distance;
	result.proximity_curve = tables().proximity_curve;
	return result;
}

const LayerTables &ScatterLayer::tables() const {
	MaskFrame frame;
	frame.area.min = {mask_texture_rect_.position.x, mask_texture_rect_.position.y};
	frame.area.max = frame.area.min + glm::dvec2{mask_texture_rect_.size.x, mask_texture_rect_.size.y};
	frame.channel = static_cast<ImageChannel>(integers_.mask_texture_channel);
	frame.edge = static_cast<thicket::MaskEdge>(integers_.mask_texture_edge);
	tables_.refresh(resources_, frame, numbers_.proximity_distance);
	return tables_;
}

QueryLayer query_layer(const LayerSnapshot *layer) {
	QueryLayer result;
	result.wanted = layer != nullptr;
	if (layer != nullptr) {
		const LayerSettings &settings = *layer->settings;
		result.set = settings.set;
		result.tile_size = layer->range.tile_size;
		result.shape = {layer->gameplay.instance_radius, layer->gameplay.instance_height};
		result.max_scale = settings.placement.max_scale;
		result.max_offset = std::abs(settings.placement.offset_along_normal);
	}
	return result;
}

} // namespace thicket
