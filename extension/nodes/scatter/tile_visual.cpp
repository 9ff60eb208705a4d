#include "nodes/scatter/tile_visual.hpp"

#include "core/placement/tile_instances.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/variant/basis.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <algorithm>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// GeometryInstance3D.GIMode.
constexpr int64_t gi_static = 1;
constexpr int64_t gi_dynamic = 2;

/// No number of instances: what a new buffer draws, until it is told.
constexpr auto everything = std::numeric_limits<std::size_t>::max();

} // namespace

TileVisual::TileVisual(const VisualContext &context, const InstanceData &data, const Ref<Mesh> &mesh,
		const MeshUpload &upload) : data_(data), mesh_(mesh) {
	RenderingServer *server = RenderingServer::get_singleton();
	multimesh_ = server->multimesh_create();
	set_instances(upload);
	instance_ = server->instance_create2(multimesh_, context.scenario);
	server->instance_set_visible(instance_, false);
	origin_ = context.origin;
	offset_ = context.offset;
	move_instance();
	server->instance_attach_object_instance_id(instance_, context.node_id);
}

TileVisual::~TileVisual() { free(); }

TileVisual::TileVisual(TileVisual &&other) noexcept { *this = std::move(other); }

TileVisual &TileVisual::operator=(TileVisual &&other) noexcept {
	if (this != &other) {
		free();
		data_ = other.data_;
		instances_ = other.instances_;
		capacity_ = other.capacity_;
		multimesh_ = std::exchange(other.multimesh_, RID());
		instance_ = std::exchange(other.instance_, RID());
		mesh_ = std::move(other.mesh_);
		material_ = std::move(other.material_);
		drawn_ = other.drawn_;
		scale_ = other.scale_;
		origin_ = other.origin_;
		offset_ = other.offset_;
	}
	return *this;
}

void TileVisual::allocate(int64_t instances) {
	RenderingServer *server = RenderingServer::get_singleton();
	capacity_ = instances;
	server->multimesh_allocate_data(multimesh_, static_cast<int32_t>(capacity_),
			RenderingServer::MULTIMESH_TRANSFORM_3D, data_.use_colors, data_.use_custom_data);
	server->multimesh_set_mesh(multimesh_, mesh_->get_rid());
}

void TileVisual::set_instances(const MeshUpload &upload) {
	RenderingServer *server = RenderingServer::get_singleton();
	const auto stride = static_cast<int64_t>(floats_per_instance(data_));
	instances_ = upload.buffer.size() / stride;
	if (instances_ > capacity_) {
		allocate(instances_);
	}
	// Before the buffer: with a box of ours the renderer does not compute one from all the transforms.
	server->multimesh_set_custom_aabb(multimesh_, upload.aabb);
	PackedFloat32Array buffer = upload.buffer;
	if (instances_ < capacity_) {
		// The renderer wants all that it has room for. What is left over is never drawn.
		buffer.resize(capacity_ * stride);
		std::fill(buffer.ptrw() + instances_ * stride, buffer.ptrw() + capacity_ * stride, 0.0F);
	}
	server->multimesh_set_buffer(multimesh_, buffer);
	drawn_ = everything;
	set_drawn(static_cast<std::size_t>(instances_));
}

void TileVisual::free() {
	for (RID *rid : {&instance_, &multimesh_}) {
		if (rid->is_valid()) {
			RenderingServer::get_singleton()->free_rid(*rid);
			*rid = RID();
		}
	}
}

void TileVisual::apply(const LayerDrawing &drawing) {
	// Every member is named, so that nobody adds one without a look at this function.
	const auto &[meshes, lod_meshes, boxes, mesh_reach, cell_size, material, cast_shadow, gi_mode, render_layers,
			lod_bias, margin, begin, begin_margin, end, end_margin, fade_mode] = drawing;
	RenderingServer *server = RenderingServer::get_singleton();
	server->instance_set_layer_mask(instance_, static_cast<uint32_t>(render_layers));
	server->instance_geometry_set_cast_shadows_setting(
			instance_, static_cast<RenderingServer::ShadowCastingSetting>(cast_shadow));
	server->instance_geometry_set_flag(instance_, RenderingServer::INSTANCE_FLAG_USE_BAKED_LIGHT, gi_mode == gi_static);
	server->instance_geometry_set_flag(instance_, RenderingServer::INSTANCE_FLAG_USE_DYNAMIC_GI, gi_mode == gi_dynamic);
	server->instance_geometry_set_lod_bias(instance_, static_cast<float>(lod_bias));
	server->instance_set_extra_visibility_margin(instance_, static_cast<float>(margin));
	server->instance_geometry_set_material_override(instance_, material.is_valid() ? material->get_rid() : RID());
	material_ = material; // Only now: what it held before must not go while the instance names it.
	server->instance_geometry_set_visibility_range(instance_, static_cast<float>(begin), static_cast<float>(end),
			static_cast<float>(begin_margin), static_cast<float>(end_margin),
			static_cast<RenderingServer::VisibilityRangeFadeMode>(fade_mode));
}

void TileVisual::set_visible(bool visible) {
	RenderingServer::get_singleton()->instance_set_visible(instance_, visible);
}

void TileVisual::set_offset(glm::dvec3 offset) {
	if (offset_ != offset) {
		offset_ = offset;
		move_instance();
	}
}

void TileVisual::move_instance() {
	const glm::dvec3 at = origin_ - offset_;
	const Vector3 position(static_cast<real_t>(at.x), static_cast<real_t>(at.y), static_cast<real_t>(at.z));
	RenderingServer::get_singleton()->instance_set_transform(instance_, Transform3D(Basis(), position));
}

void TileVisual::set_mesh(const Ref<Mesh> &mesh) {
	if (mesh_ != mesh) {
		RenderingServer::get_singleton()->multimesh_set_mesh(multimesh_, mesh->get_rid());
		mesh_ = mesh; // Only now: see above.
	}
}

void TileVisual::set_drawn(std::size_t count) {
	if (drawn_ != count) {
		RenderingServer::get_singleton()->multimesh_set_visible_instances(multimesh_, static_cast<int32_t>(count));
		drawn_ = count;
	}
}

void TileVisual::set_scale(float scale) {
	if (scale_ != scale) {
		RenderingServer::get_singleton()->instance_geometry_set_shader_parameter(instance_, "scatter_scale", scale);
		scale_ = scale;
	}
}

PackedFloat32Array TileVisual::read_back() const {
	PackedFloat32Array buffer = RenderingServer::get_singleton()->multimesh_get_buffer(multimesh_);
	const int64_t floats = instances_ * static_cast<int64_t>(floats_per_instance(data_));
	if (buffer.size() > floats) {
		buffer.resize(floats);
	}
	return buffer;
}

} // namespace thicket
