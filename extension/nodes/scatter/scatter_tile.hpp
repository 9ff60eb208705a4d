#pragma once

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
#include <vector>

namespace thicket {

/// The instances of a rectangle of the world, by mesh: either of a visible tile, or of a rectangle built for the
/// caller. Given an invalid mesh index, methods print an error and return a default.
class ScatterTile : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(ScatterTile, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// The result of a refused call.
	static godot::Ref<ScatterTile> make_empty() { return memnew(ScatterTile); }

	/// Creates the result for a tile that was built. `offset` is the world position of the engine's origin.
	static godot::Ref<ScatterTile> built(
			CompactTile tile, const std::vector<godot::Ref<godot::Mesh>> &meshes, glm::dvec3 offset);

	/// A tile of a display; empty for a tile that is not visible.
	static godot::Ref<ScatterTile> shown(
			const std::shared_ptr<const TileDisplay> &display, std::uint32_t layer, glm::ivec2 tile, glm::dvec3 offset);

	/// True if there are no instances.
	bool is_empty() const;

	/// The origin of the transforms in the buffers.
	godot::Vector3 get_origin() const { return origin_; }
	int64_t get_mesh_count() const { return static_cast<int64_t>(parts_.size()); }
	godot::Ref<godot::Mesh> get_mesh(int64_t p_index) const;

	/// The instances in the format of MultiMesh.buffer. For a tile that is still visible, reads the data of the
	/// RenderingServer.
	godot::PackedFloat32Array get_buffer(int64_t p_index) const;
	godot::PackedInt64Array get_ids(int64_t p_index) const;

	/// All instances as columns; see instance_rows. Positions are world positions.
	godot::PackedByteArray get_rows() const;

	/// Invalid if nothing is drawn, or if there are several.
	godot::RID get_multimesh(int64_t p_index) const;

	/// The multimeshes of a mesh: one for a tile that is drawn as a whole, otherwise one for each cell that contains
	/// instances. Empty if nothing is drawn.
	godot::TypedArray<godot::RID> get_multimeshes(int64_t p_index) const;

	/// Covers all data, bit for bit; 0 for a tile that was not visible.
	int64_t get_digest() const;

protected:
	static void _bind_methods();

private:
	struct Part {
		godot::Ref<godot::Mesh> mesh;
		std::shared_ptr<const CompactMesh> instances;
		std::vector<godot::RID> multimeshes;
	};

	const Part *find(const char *p_method, int64_t p_index) const;

	std::shared_ptr<const CompactTile> tile_; ///< Null for a tile that was not visible.
	godot::Vector3 origin_;
	std::vector<Part> parts_;

	std::weak_ptr<const TileDisplay> display_;
	std::uint32_t layer_ = 0;
	glm::ivec2 number_{0};
};

} // namespace thicket
