#pragma once

#include "core/placement/host_layer.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Reads and caches the triangles of a layer's meshes, for other layers that grow on its models.
/// Reads the finest LODs from the renderer. Use it only on the main thread.
class HostReader {
public:
	/// Returns the triangles. Reads them only if the meshes, their boxes or `version`
	/// (ScatterLayer::mesh_version) have changed since the last call. If the triangles are the same as
	/// before, returns the same object.
	std::shared_ptr<const HostModels> read(const LayerDrawing &drawing, std::uint64_t version);

	/// Returns a message for each mesh on which nothing can grow, or one message if no mesh has
	/// triangles.
	const godot::PackedStringArray &problems() const { return problems_; }

	/// The maximum number of triangles of a mesh. Nothing grows on meshes with more triangles.
	static constexpr std::size_t max_triangles = 100'000;

private:
	std::shared_ptr<const Surface> read_mesh(const godot::Ref<godot::Mesh> &p_mesh, std::size_t index);

	std::vector<godot::Ref<godot::Mesh>> meshes_;
	std::vector<godot::AABB> boxes_;
	std::uint64_t version_ = 0;
	std::shared_ptr<const HostModels> models_; ///< Null before the first call.
	godot::PackedStringArray problems_;
};

} // namespace thicket
