#pragma once

#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/mesh_upload.hpp"

#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>

namespace thicket {

/// How the instances of a layer are drawn.
struct DrawSettings {
	LayerNumbers numbers;
	LayerIntegers integers;
	godot::Ref<godot::Material> material; ///< Null for the meshes' own.

	/// True if both draw the same: what places instances does not count.
	bool draws_as(const DrawSettings &other) const;
};

/// Where a TileVisual stands.
struct VisualPlace {
	godot::RID scenario;
	glm::dvec3 origin{0.0};    ///< The tile's origin in the world, meters.
	glm::dvec3 offset{0.0};    ///< The engine's origin in the world, meters.
	std::uint64_t node_id = 0; ///< Of the node it belongs to: a click in the editor selects that.
};

/// One mesh's instances in one tile on show: a MultiMesh and an instance of the RenderingServer, freed with the object.
///
/// Holds its mesh and its material: an outdated tile is drawn as it was until its successor is there, whatever the
/// layer has let go of. The instance stands at the tile's center, from where the engine measures visibility ranges.
/// Physics interpolation is off, as it is for every multimesh that no MultiMesh resource owns: nothing here ever moves in
/// the world.
class TileVisual {
public:
	/// Hidden at first. The buffer has as many floats an instance as `look` says.
	TileVisual(
			const VisualPlace &place, const InstanceData &look, const godot::Ref<godot::Mesh> &mesh,
			const MeshUpload &upload);
	~TileVisual();
	TileVisual(TileVisual &&other) noexcept;
	TileVisual &operator=(TileVisual &&other) noexcept;

	void apply(const DrawSettings &settings);
	void set_visible(bool visible);

	/// The engine's origin has moved in the world: the visual stays where it is in the world.
	void set_offset(glm::dvec3 offset);

	/// Other instances in place of those there; all are drawn until `set_drawn`.
	void set_instances(const MeshUpload &upload);

	// What depends on the distance, without another upload. Each does nothing where that is so already.
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
	void allocate(int64_t instances);

	InstanceData look_;
	int64_t instances_ = 0;
	int64_t room_ = 0; ///< Instances that the multimesh has memory for.
	godot::RID multimesh_;
	godot::RID instance_;
	godot::Ref<godot::Mesh> mesh_;
	godot::Ref<godot::Material> material_;
	std::size_t drawn_ = 0;
	float scale_ = 1.0F;
	glm::dvec3 origin_{0.0}; ///< In the world.
};

} // namespace thicket
