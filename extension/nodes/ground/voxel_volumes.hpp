#pragma once

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>

#include <vector>

namespace thicket {

/// The nodes of a scene that have the methods of the terrains in godot_voxel
/// (github.com/Zylann/godot_voxel). The blocks of these terrains have physics bodies but no nodes,
/// and exist only near a VoxelViewer. If a ray hits no body, the ground may therefore simply not
/// have been loaded yet. All positions are in the engine's space.
class VoxelVolumes {
public:
	/// Returns true if a node has these methods, regardless of its class.
	static bool is_volume(const godot::Node *p_node);

	/// Adds a node for which `is_volume` is true.
	void add(godot::Node *p_node);
	void clear() { volumes_.clear(); }

	/// Checks the column at a position in x and z, from y `bottom` to `top`. Returns false if any
	/// volume has not meshed the part of the column inside its bounds. Runs scripts.
	bool is_loaded(glm::dvec2 position, double bottom, double top) const;

private:
	std::vector<godot::Variant> volumes_;
};

} // namespace thicket
