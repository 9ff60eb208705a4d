#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/scatter/mesh_upload.hpp"

#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>

namespace thicket {

/// What a TileVisual is part of.
struct VisualContext {
	godot::RID scenario;
	glm::dvec3 origin{0.0};    ///< The tile's origin in the world, meters.
	glm::dvec3 offset{0.0};    ///< The engine's origin in the world, meters.
	std::uint64_t node_id = 0; ///< Of the node it belongs to: a click in the editor selects that.
};

/// The instances of one mesh in a tile or in a cell of it: a MultiMesh and an instance of the RenderingServer, freed with the object.
///
/// Holds its mesh and its material: an outdated tile is drawn as it was until its successor is there, whatever the
/// layer has let go of. The instance stands at the tile's center, from where the engine measures visibility ranges.
/// Physics interpolation is off, as it is for every multimesh that no MultiMesh resource owns: nothing here ever moves in
/// the world.
class TileVisual {
public:
	/// Hidden at first. The buffer has as many floats an instance as `data` says.
	TileVisual(const VisualContext &context, const InstanceData &data, const godot::Ref<godot::Mesh> &mesh,
			const MeshUpload &upload);
	~TileVisual();
	TileVisual(TileVisual &&other) noexcept;
	TileVisual &operator=(TileVisual &&other) noexcept;

	/// Draws the instances as a layer says, apart from its meshes.
	void apply(const LayerDrawing &drawing);
	void set_visible(bool visible);

	/// Replaces the instances; all of them are drawn until `set_drawn`.
	void set_instances(const MeshUpload &upload);

	// What may change without another upload. Each does nothing where that is so already.

	/// The engine's origin has moved in the world: the visual stays where it is in the world.
	void set_offset(glm::dvec3 offset);
	void set_mesh(const godot::Ref<godot::Mesh> &mesh);

	/// Draws the first so many instances.
	void set_drawn(std::size_t count);

	/// The instance uniform `scatter_scale` for the shaders.
	void set_scale(float scale);

	/// What the RenderingServer holds for the instances. Slow: it waits for the renderer.
	godot::PackedFloat32Array read_back() const;

	godot::RID multimesh() const { return multimesh_; }

private:
	void free();
	void move_instance();
	void allocate(int64_t instances);

	InstanceData data_;
	int64_t instances_ = 0;
	int64_t capacity_ = 0; ///< Instances that the multimesh has memory for.
	godot::RID multimesh_;
	godot::RID instance_;
	godot::Ref<godot::Mesh> mesh_;
	godot::Ref<godot::Material> material_;
	std::size_t drawn_ = 0;
	float scale_ = 1.0F;
	glm::dvec3 origin_{0.0}; ///< In the world.
	glm::dvec3 offset_{0.0}; ///< Of the engine's origin in the world.
};

} // namespace thicket
