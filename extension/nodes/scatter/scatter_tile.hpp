#pragma once

#include "core/placement/kept_tile.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/scatter/tile_display.hpp"

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

/// The instances of a rectangle of the world, by mesh: of a tile on show, or built for whoever asked. An index of a mesh that is not
/// there prints an error and gives a default.
class ScatterTile : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(ScatterTile, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// The result of a call that was refused.
	static godot::Ref<ScatterTile> make_empty() { return memnew(ScatterTile); }

	/// One that was built. `offset` is where the engine's origin is in the world.
	static godot::Ref<ScatterTile> built(
			KeptTile tile, const std::vector<godot::Ref<godot::Mesh>> &meshes, glm::dvec3 offset);

	/// One that a display shows; null for a tile that it does not show.
	static godot::Ref<ScatterTile> shown(
			const std::shared_ptr<const TileDisplay> &display, std::uint32_t layer, glm::ivec2 tile, glm::dvec3 offset);

	/// True if there are no instances.
	bool is_empty() const;

	/// Where the transforms in the buffers start from.
	godot::Vector3 get_origin() const { return origin_; }
	int64_t get_mesh_count() const { return static_cast<int64_t>(parts_.size()); }
	godot::Ref<godot::Mesh> get_mesh(int64_t p_index) const;

	/// As in MultiMesh.buffer. Of a tile that is still on show, what the RenderingServer holds.
	godot::PackedFloat32Array get_buffer(int64_t p_index) const;
	godot::PackedInt64Array get_ids(int64_t p_index) const;

	/// All instances as columns; see instance_rows. Positions are the world's.
	godot::PackedByteArray get_rows() const;

	/// Invalid where nothing is drawn, and where there are several.
	godot::RID get_multimesh(int64_t p_index) const;

	/// One of a tile that is drawn as a whole, else one for each cell in which instances stand. None where nothing is drawn.
	godot::TypedArray<godot::RID> get_multimeshes(int64_t p_index) const;

	/// Of all of it, to the last bit; 0 for a tile that was not shown.
	int64_t get_digest() const;

protected:
	static void _bind_methods();

private:
	struct Part {
		godot::Ref<godot::Mesh> mesh;
		std::shared_ptr<const KeptMesh> instances;
		std::vector<godot::RID> multimeshes;
	};

	const Part *find(const char *p_method, int64_t p_index) const;

	std::shared_ptr<const KeptTile> tile_; ///< Null for one that was not shown.
	godot::Vector3 origin_;
	std::vector<Part> parts_;

	std::weak_ptr<const TileDisplay> display_;
	std::uint32_t layer_ = 0;
	glm::ivec2 number_{0};
};

} // namespace thicket
