#pragma once

#include "core/base/world_frame.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/workers/mesh_upload.hpp"

#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// The scenario, position and owner of a TileVisual.
struct VisualContext {
	godot::RID scenario;
	glm::dvec3 origin{0.0}; ///< The world position of the tile's origin, in meters.
	WorldFrame frame;
	/// The object ID of the owner. A click on the visual in the editor selects that node.
	std::uint64_t node_id = 0;
};

/// Returns true if any of these has a separate mesh for its shadow.
bool have_shadow_meshes(std::span<const MeshAppearance> appearances);

/// Draws the instances of one mesh in a tile or one of its cells. Owns a multimesh and an instance
/// of the RenderingServer. If another mesh casts the shadow, owns a second pair whose multimesh has
/// the same buffer content.
///
/// Keeps its mesh and material alive even if the layer has released them, because an outdated tile
/// is drawn until its replacement is ready. The instance is positioned at the tile's center,
/// because the engine measures visibility ranges from there. Physics interpolation is off, as for
/// every multimesh without a MultiMesh resource, because visuals never move in the world.
class TileVisual {
public:
	/// Creates a hidden visual that draws the first of `appearances`, which lists all appearances
	/// that the visual may ever have. `data` determines the number of floats per instance in the
	/// buffer.
	TileVisual(const VisualContext &context, const InstanceData &data, std::span<const MeshAppearance> appearances,
			const MeshUpload &upload);
	~TileVisual();
	TileVisual(TileVisual &&other) noexcept;
	TileVisual &operator=(TileVisual &&other) noexcept;

	/// Applies the layer's drawing settings except its meshes.
	void apply(const LayerDrawing &drawing);
	void set_visible(bool visible);

	/// Replaces the instances. The renderer draws all of them until `set_drawn` is called. Does not
	/// throw.
	void set_instances(const MeshUpload &upload);

	// The following methods upload nothing. They have no effect if the value is unchanged.

	/// Sets the world position of the engine's origin, in meters. The visual keeps its position in
	/// the world.
	void set_frame(const WorldFrame &frame);
	void set_appearance(const MeshAppearance &appearance);

	/// Draws the first `count` instances.
	void set_drawn(std::size_t count);

	/// Sets the instance uniform `scatter_scale` of the shaders.
	void set_scale(float scale);

	/// Reads the instance data from the RenderingServer. Slow, because it waits for the renderer.
	godot::PackedFloat32Array read_back() const;

	godot::RID multimesh() const { return draw_handle_.multimesh; }
	std::size_t drawn_count() const { return drawn_count_; }
	const godot::Ref<godot::Mesh> &mesh() const { return draw_handle_.mesh; }

private:
	/// The RenderingServer objects for one mesh.
	struct Handle {
		godot::RID multimesh; ///< The multimesh; invalid if there is none.
		godot::RID instance;
		godot::Ref<godot::Mesh> mesh;
	};

	template <class Work>
	void for_each_handle(const Work &work) {
		for (Handle *handle : {&draw_handle_, &shadow_handle_}) {
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
	void apply_lod_appearance(const LodAppearance &lod_appearance);

	InstanceData data_;
	int64_t instance_count_ = 0;
	int64_t capacity_ = 0; ///< The number of instances that the multimesh has memory for.
	Handle draw_handle_;
	/// Draws the separate shadow mesh, if any of the appearances has one.
	Handle shadow_handle_;
	std::int64_t layer_shadow_ = 1;    ///< The layer's GeometryInstance3D.ShadowCastingSetting.
	std::int64_t shadow_setting_ = -1; ///< The shadow setting of the current appearance, as in MeshShadow.
	LodAppearance lod_appearance_;     ///< The current value in the renderer.
	bool has_shadow_mesh_ = false;     ///< True if the current appearance has a separate shadow mesh.
	bool visible_ = false;
	godot::Ref<godot::Material> material_;
	std::size_t drawn_count_ = 0;
	float scale_ = 1.0F;
	glm::dvec3 origin_{0.0}; ///< In world meters.
	WorldFrame frame_;
};

} // namespace thicket
