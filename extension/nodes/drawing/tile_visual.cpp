#include "nodes/drawing/tile_visual.hpp"

#include "core/placement/tile_instances.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/variant/basis.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <algorithm>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Values of GeometryInstance3D.GIMode.
constexpr int64_t gi_static = 1;
constexpr int64_t gi_dynamic = 2;

/// A placeholder for the number of drawn instances: after an upload, the renderer draws all
/// instances until a count is set.
constexpr auto all_instances = std::numeric_limits<std::size_t>::max();

} // namespace

bool have_shadow_meshes(std::span<const MeshAppearance> appearances) {
	return std::ranges::any_of(
			appearances, [](const MeshAppearance &appearance) { return appearance.shadow.mesh.is_valid(); });
}

TileVisual::TileVisual(const VisualContext &context, const InstanceData &data,
		std::span<const MeshAppearance> appearances, const MeshUpload &upload) : data_(data) {
	RenderingServer *server = RenderingServer::get_singleton();
	const MeshAppearance &appearance = appearances.front();
	draw_handle_ = {server->multimesh_create(), RID(), appearance.mesh};
	if (have_shadow_meshes(appearances)) {
		shadow_handle_ = {server->multimesh_create(), RID(),
				appearance.shadow.mesh.is_valid() ? appearance.shadow.mesh : appearance.mesh};
	}
	set_instances(upload);
	for_each_handle([&](Handle &handle) {
		handle.instance = server->instance_create2(handle.multimesh, context.scenario);
		server->instance_set_visible(handle.instance, false);
		server->instance_attach_object_instance_id(handle.instance, context.node_id);
	});
	origin_ = context.origin;
	frame_ = context.frame;
	move_instances();
	set_appearance(appearance);
}

TileVisual::~TileVisual() { free(); }

TileVisual::TileVisual(TileVisual &&other) noexcept { *this = std::move(other); }

TileVisual &TileVisual::operator=(TileVisual &&other) noexcept {
	if (this != &other) {
		free();
		data_ = other.data_;
		instance_count_ = other.instance_count_;
		capacity_ = other.capacity_;
		draw_handle_ = std::exchange(other.draw_handle_, Handle());
		shadow_handle_ = std::exchange(other.shadow_handle_, Handle());
		layer_shadow_ = other.layer_shadow_;
		shadow_setting_ = other.shadow_setting_;
		has_shadow_mesh_ = other.has_shadow_mesh_;
		lod_appearance_ = other.lod_appearance_;
		visible_ = other.visible_;
		material_ = other.material_;
		drawn_count_ = other.drawn_count_;
		scale_ = other.scale_;
		origin_ = other.origin_;
		frame_ = other.frame_;
	}
	return *this;
}

void TileVisual::allocate(int64_t instances) {
	RenderingServer *server = RenderingServer::get_singleton();
	capacity_ = instances;
	for_each_handle([&](Handle &handle) {
		server->multimesh_allocate_data(handle.multimesh, static_cast<int32_t>(capacity_),
				RenderingServer::MULTIMESH_TRANSFORM_3D, data_.use_colors, data_.use_custom_data);
		server->multimesh_set_mesh(handle.multimesh, handle.mesh->get_rid());
	});
}

void TileVisual::set_instances(const MeshUpload &upload) {
	RenderingServer *server = RenderingServer::get_singleton();
	const auto stride = static_cast<int64_t>(floats_per_instance(data_));
	instance_count_ = upload.buffer.size() / stride;
	if (instance_count_ > capacity_) {
		allocate(instance_count_);
	}
	PackedFloat32Array buffer = upload.buffer;
	try {
		if (instance_count_ < capacity_) {
			// The renderer requires a buffer of the full capacity. The padding is never drawn.
			buffer = resized_copy(buffer, capacity_ * stride);
		}
	} catch (const std::bad_alloc &) {
		// Reallocating is slower, but the drawn instances must match the count.
		allocate(instance_count_);
	}
	for_each_handle([&](Handle &handle) {
		// Set the box before the buffer. Otherwise the renderer computes one from all transforms.
		server->multimesh_set_custom_aabb(handle.multimesh, upload.aabb);
		server->multimesh_set_buffer(handle.multimesh, buffer);
	});
	drawn_count_ = all_instances;
	set_drawn(static_cast<std::size_t>(instance_count_));
}

void TileVisual::free() {
	for_each_handle([](Handle &handle) {
		for (const RID &rid : {handle.instance, handle.multimesh}) {
			if (rid.is_valid()) {
				RenderingServer::get_singleton()->free_rid(rid);
			}
		}
		handle = {};
	});
}

void TileVisual::apply(const LayerDrawing &drawing) {
	// Lists every member, so that adding one fails to compile until it is handled here.
	const auto &[meshes, lod_meshes, surfaces, boxes, mesh_reach, cell_size, material, cast_shadow, gi_mode,
			render_layers, lod_bias, margin] = drawing;
	RenderingServer *server = RenderingServer::get_singleton();
	const bool is_static = gi_mode == gi_static;
	const bool is_dynamic = gi_mode == gi_dynamic;
	const RID material_rid = material.is_valid() ? material->get_rid() : RID();
	for (const RID &instance : {draw_handle_.instance, shadow_handle_.instance}) {
		if (!instance.is_valid()) {
			continue;
		}
		server->instance_set_layer_mask(instance, static_cast<uint32_t>(render_layers));
		server->instance_geometry_set_flag(instance, RenderingServer::INSTANCE_FLAG_USE_BAKED_LIGHT, is_static);
		server->instance_geometry_set_flag(instance, RenderingServer::INSTANCE_FLAG_USE_DYNAMIC_GI, is_dynamic);
		server->instance_geometry_set_lod_bias(instance, static_cast<float>(lod_bias));
		server->instance_set_extra_visibility_margin(instance, static_cast<float>(margin));
		server->instance_geometry_set_material_override(instance, material_rid);
	}
	// Assign last. The previous material must not be freed while the instance uses it.
	material_ = material;
	layer_shadow_ = cast_shadow;
	apply_shadows();
}

/// Applies the shadow settings. If another mesh casts the shadow, that mesh casts shadows only, and
/// the drawn mesh casts none.
void TileVisual::apply_shadows() {
	RenderingServer *server = RenderingServer::get_singleton();
	const std::int64_t setting = MeshShadow{{}, shadow_setting_}.setting_in(layer_shadow_);
	const auto engine_setting = static_cast<RenderingServer::ShadowCastingSetting>(setting);
	server->instance_geometry_set_cast_shadows_setting(
			draw_handle_.instance, has_shadow_mesh_ ? RenderingServer::SHADOW_CASTING_SETTING_OFF : engine_setting);
	if (shadow_handle_.instance.is_valid()) {
		const bool casts = has_shadow_mesh_ && setting != RenderingServer::SHADOW_CASTING_SETTING_OFF;
		server->instance_geometry_set_cast_shadows_setting(
				shadow_handle_.instance, RenderingServer::SHADOW_CASTING_SETTING_SHADOWS_ONLY);
		server->instance_set_visible(shadow_handle_.instance, visible_ && casts);
	}
}

void TileVisual::set_visible(bool visible) {
	visible_ = visible;
	RenderingServer::get_singleton()->instance_set_visible(draw_handle_.instance, visible);
	if (shadow_handle_.instance.is_valid()) {
		apply_shadows();
	}
}

void TileVisual::set_frame(const WorldFrame &frame) {
	if (frame_ == frame) {
		return;
	}
	frame_ = frame;
	move_instances();
}

void TileVisual::move_instances() {
	const Transform3D transform = to_engine(glm::mat3(1.0F), origin_, frame_);
	for_each_handle([&](const Handle &handle) {
		RenderingServer::get_singleton()->instance_set_transform(handle.instance, transform);
	});
}

void TileVisual::set_mesh(const Ref<Mesh> &mesh, Handle &r_handle) {
	if (r_handle.mesh == mesh) {
		return;
	}
	RenderingServer::get_singleton()->multimesh_set_mesh(r_handle.multimesh, mesh->get_rid());
	r_handle.mesh = mesh; // Assign last, as for the material in `apply`.
}

void TileVisual::set_appearance(const MeshAppearance &appearance) {
	set_mesh(appearance.mesh, draw_handle_);
	const bool has_shadow_mesh = appearance.shadow.mesh.is_valid() && shadow_handle_.multimesh.is_valid();
	if (has_shadow_mesh) {
		set_mesh(appearance.shadow.mesh, shadow_handle_);
	}
	apply_lod_appearance(appearance.lod_appearance);
	if (has_shadow_mesh != has_shadow_mesh_ || appearance.shadow.setting != shadow_setting_) {
		has_shadow_mesh_ = has_shadow_mesh;
		shadow_setting_ = appearance.shadow.setting;
		apply_shadows();
	}
}

void TileVisual::apply_lod_appearance(const LodAppearance &lod_appearance) {
	if (lod_appearance == lod_appearance_) {
		return;
	}
	RenderingServer *server = RenderingServer::get_singleton();
	const std::shared_ptr<const ShaderParameters> previous_parameters =
			std::exchange(lod_appearance_, lod_appearance).parameters;
	for_each_handle([&](const Handle &handle) {
		server->instance_geometry_set_transparency(handle.instance, static_cast<float>(lod_appearance.transparency));
		for (const auto &[name, value] :
				previous_parameters != nullptr && previous_parameters != lod_appearance.parameters
						? *previous_parameters
						: ShaderParameters()) {
			server->instance_geometry_set_shader_parameter(handle.instance, name, Variant());
		}
		for (const auto &[name, value] :
				lod_appearance.parameters != nullptr ? *lod_appearance.parameters : ShaderParameters()) {
			server->instance_geometry_set_shader_parameter(handle.instance, name, value);
		}
	});
}

void TileVisual::set_drawn(std::size_t count) {
	if (drawn_count_ == count) {
		return;
	}
	for_each_handle([count](const Handle &handle) {
		RenderingServer::get_singleton()->multimesh_set_visible_instances(
				handle.multimesh, static_cast<int32_t>(count));
	});
	drawn_count_ = count;
}

void TileVisual::set_scale(float scale) {
	if (scale_ == scale) {
		return;
	}
	for_each_handle([scale](const Handle &handle) {
		RenderingServer::get_singleton()->instance_geometry_set_shader_parameter(
				handle.instance, "scatter_scale", scale);
	});
	scale_ = scale;
}

PackedFloat32Array TileVisual::read_back() const {
	const PackedFloat32Array buffer = RenderingServer::get_singleton()->multimesh_get_buffer(draw_handle_.multimesh);
	const int64_t floats = instance_count_ * static_cast<int64_t>(floats_per_instance(data_));
	return buffer.size() > floats ? resized_copy(buffer, floats) : buffer;
}

} // namespace thicket
