#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/workers/mesh_upload.hpp"

#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// The context that a TileVisual belongs to.
struct VisualContext {
	godot::RID scenario;
	glm::dvec3 origin{0.0};    ///< The tile's origin in the world, in meters.
	glm::dvec3 offset{0.0};    ///< The engine's origin in the world, in meters.
	std::uint64_t node_id = 0; ///< The node it belongs to: a click in the editor selects that node.
};

/// True if one of these looks casts its shadow with a different mesh than it draws.
bool casts_by_other_meshes(std::span<const MeshLook> looks);

/// The instances of one mesh in a tile or in a cell of it: a MultiMesh and an instance of the RenderingServer, freed with the object. If a
/// different mesh casts the shadow, there are two more, which share the content of the buffer.
///
/// Keeps its mesh and its material alive, even if the layer has released them: an outdated tile is drawn unchanged
/// until its successor is ready. The instance is positioned at the tile's center, because the engine measures
/// visibility ranges from there. Physics interpolation is off, because nothing here ever moves in the world. It is off
/// for every multimesh without a MultiMesh resource.
class TileVisual {
public:
	/// Creates a hidden visual with the first of its possible looks. `data` determines the number of floats per
	/// instance in the buffer.
	TileVisual(const VisualContext &context, const InstanceData &data, std::span<const MeshLook> looks,
			const MeshUpload &upload);
	~TileVisual();
	TileVisual(TileVisual &&other) noexcept;
	TileVisual &operator=(TileVisual &&other) noexcept;

	/// Applies the layer's drawing settings, apart from its meshes.
	void apply(const LayerDrawing &drawing);
	void set_visible(bool visible);

	/// Replaces the instances; all of them are drawn until `set_drawn`. Throws nothing.
	void set_instances(const MeshUpload &upload);

	// These need no upload. Each does nothing if the value is unchanged.

	/// Notifies the visual that the engine's origin has moved in the world. The visual keeps its position in the world.
	void set_offset(glm::dvec3 offset);
	void set_look(const MeshLook &look);

	/// Draws the first `count` instances.
	void set_drawn(std::size_t count);

	/// The instance uniform `scatter_scale` for the shaders.
	void set_scale(float scale);

	/// Reads the data of the instances from the RenderingServer. Slow, because it waits for the renderer.
	godot::PackedFloat32Array read_back() const;

	godot::RID multimesh() const { return drawn_by_.multimesh; }
	std::size_t drawn() const { return drawn_; }
	const godot::Ref<godot::Mesh> &mesh() const { return drawn_by_.mesh; }

private:
	/// The objects of the RenderingServer for one of the meshes.
	struct Handle {
		godot::RID multimesh; ///< Invalid if there is none.
		godot::RID instance;
		godot::Ref<godot::Mesh> mesh;
	};

	template <class Work>
	void for_each_handle(const Work &work) {
		for (Handle *handle : {&drawn_by_, &shadow_by_}) {
			if (handle->multimesh.is_valid()) {
				work(*handle);
			}
		}
	}

	void free();
	void move_instances();
	void allocate(int64_t instances);
	void set_mesh(const godot::Ref<godot::Mesh> &mesh, Handle &r_handle);
	void apply_shadows();
	void apply_look(const LodLook &look);

	InstanceData data_;
	int64_t instances_ = 0;
	int64_t capacity_ = 0; ///< Instances that the multimesh has memory for.
	Handle drawn_by_;
	Handle shadow_by_;              ///< For a different mesh that casts the shadow, if any of the looks has one.
	std::int64_t layer_shadow_ = 1; ///< The layer's GeometryInstance3D.ShadowCastingSetting.
	std::int64_t look_shadow_ = -1; ///< The look's setting, as in MeshShadow.
	LodLook look_;                  ///< The look that the renderer currently has.
	bool casts_apart_ = false;      ///< True if the look that is drawn has its own mesh for the shadow.
	bool visible_ = false;
	godot::Ref<godot::Material> material_;
	std::size_t drawn_ = 0;
	float scale_ = 1.0F;
	glm::dvec3 origin_{0.0}; ///< In the world.
	glm::dvec3 offset_{0.0}; ///< The engine's origin in the world.
};

} // namespace thicket
