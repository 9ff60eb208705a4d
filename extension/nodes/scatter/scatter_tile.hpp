#pragma once

#include "core/base/world_frame.hpp"
#include "core/placement/compact_tile.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/drawing/tile_display.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/rid.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The instances in a rectangle of the world, grouped by mesh. The rectangle is a visible tile or
/// was built for the caller. For an invalid mesh index, methods print an error and return a default
/// value.
class ScatterTile : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(ScatterTile, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// Creates the result of a rejected call: no meshes and no instances.
	static godot::Ref<ScatterTile> make_empty() { return memnew(ScatterTile); }

	/// Creates the result for a built tile. `frame` is the world position of the engine's origin
	/// in meters.
	static godot::Ref<ScatterTile> from_tile(
			CompactTile tile, const std::vector<godot::Ref<godot::Mesh>> &meshes, const WorldFrame &frame);

	/// Creates the result for a tile of a display; empty if the tile is not visible.
	static godot::Ref<ScatterTile> from_display(const std::shared_ptr<const TileDisplay> &display, std::uint32_t layer,
			glm::ivec2 tile, const WorldFrame &frame);

	/// Returns true if there are no instances.
	bool is_empty() const;

	/// Returns the origin of the transforms in the buffers, in the engine's space.
	godot::Vector3 get_origin() const { return origin_; }
	int64_t get_mesh_count() const { return static_cast<int64_t>(parts_.size()); }
	godot::Ref<godot::Mesh> get_mesh(int64_t p_index) const;

	/// Returns the instances of a mesh in the format of MultiMesh.buffer. For a tile that is still
	/// visible and unchanged, reads them back from the RenderingServer.
	godot::PackedFloat32Array get_buffer(int64_t p_index) const;
	godot::PackedInt64Array get_ids(int64_t p_index) const;

	/// Returns all instances in the format of instance_rows, with positions in world space.
	godot::PackedByteArray get_rows() const;

	/// Returns the only multimesh of a mesh; invalid if there is none or more than one.
	godot::RID get_multimesh(int64_t p_index) const;

	/// Returns the multimeshes of a mesh: one for a tile that is drawn as a whole, otherwise one
	/// per cell that contains instances. Returns an empty array if nothing is drawn.
	godot::TypedArray<godot::RID> get_multimeshes(int64_t p_index) const;

	/// Returns a hash of all data, bit for bit; 0 for a tile that was not visible.
	int64_t get_digest() const;

protected:
	static void _bind_methods();

private:
	void merge(std::span<const DisplayedTile *const> column);

	struct Part {
		godot::Ref<godot::Mesh> mesh;
		std::shared_ptr<const CompactMesh> instances;
		std::vector<godot::RID> multimeshes;
	};

	const Part *find(const char *p_method, int64_t p_index) const;

	std::shared_ptr<const CompactTile> tile_; ///< The instances; null if the tile was not visible.
	godot::Vector3 origin_;
	std::vector<Part> parts_;

	std::weak_ptr<const TileDisplay> display_;
	std::uint32_t layer_ = 0;
	glm::ivec2 coordinates_{0};
};

} // namespace thicket
