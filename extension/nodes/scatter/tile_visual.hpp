#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/scatter/mesh_upload.hpp"

#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// What a TileVisual is part of.
struct VisualContext {
	godot::RID scenario;
	glm::dvec3 origin{0.0};    ///< The tile's origin in the world, meters.
	glm::dvec3 offset{0.0};    ///< The engine's origin in the world, meters.
	std::uint64_t node_id = 0; ///< Of the node it belongs to: a click in the editor selects that.
};

/// True if one of these looks casts its shadow by another mesh than it draws.
bool casts_by_other_meshes(std::span<const MeshLook> looks);

/// The instances of one mesh in a tile or in a cell of it: a MultiMesh and an instance of the RenderingServer, freed with the object; and two more
/// where another mesh casts the shadow, which share the content of the buffer.
///
/// Holds its mesh and its material: an outdated tile is drawn as it was until its successor is there, whatever the
/// layer has let go of. The instance stands at the tile's center, from where the engine measures visibility ranges.
/// Physics interpolation is off, as it is for every multimesh that no MultiMesh resource owns: nothing here ever moves in
/// the world.
class TileVisual {
public:
	/// Hidden at first, with the first of the looks that it may have. The buffer has as many floats an instance as `data` says.
	TileVisual(const VisualContext &context, const InstanceData &data, std::span<const MeshLook> looks,
			const MeshUpload &upload);
	~TileVisual();
	TileVisual(TileVisual &&other) noexcept;
	TileVisual &operator=(TileVisual &&other) noexcept;

	/// Draws the instances as a layer says, apart from its meshes.
	void apply(const LayerDrawing &drawing);
	void set_visible(bool visible);

	/// Replaces the instances; all of them are drawn until `set_drawn`. Throws nothing.
	void set_instances(const MeshUpload &upload);

	// What may change without another upload. Each does nothing where that is so already.

	/// The engine's origin has moved in the world: the visual stays where it is in the world.
	void set_offset(glm::dvec3 offset);
	void set_look(const MeshLook &look);

	/// Draws the first so many instances.
	void set_drawn(std::size_t count);

	/// The instance uniform `scatter_scale` for the shaders.
	void set_scale(float scale);

	/// What the RenderingServer holds for the instances. Slow: it waits for the renderer.
	godot::PackedFloat32Array read_back() const;

	godot::RID multimesh() const { return drawn_by_.multimesh; }
	std::size_t drawn() const { return drawn_; }
	const godot::Ref<godot::Mesh> &mesh() const { return drawn_by_.mesh; }

private:
	/// What the RenderingServer has of the instances, for one of the meshes.
	struct Handle {
		godot::RID multimesh; ///< Invalid for one that there is not.
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
	Handle shadow_by_;              ///< Of another mesh that casts the shadow, if any of the looks has one.
	std::int64_t layer_shadow_ = 1; ///< GeometryInstance3D.ShadowCastingSetting, of the layer;
	std::int64_t look_shadow_ = -1; ///< of the look, as MeshShadow has it.
	LodLook look_;                  ///< As the renderer knows it.
	bool casts_apart_ = false;      ///< The look that is drawn has a mesh of its own for the shadow.
	bool visible_ = false;
	godot::Ref<godot::Material> material_;
	std::size_t drawn_ = 0;
	float scale_ = 1.0F;
	glm::dvec3 origin_{0.0}; ///< In the world.
	glm::dvec3 offset_{0.0}; ///< Of the engine's origin in the world.
};

} // namespace thicket
