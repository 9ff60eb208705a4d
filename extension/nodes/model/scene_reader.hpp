#pragma once

#include "nodes/model/scatter_lod.hpp"

#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace thicket {

/// A collision shape of a model, and its transform to the model's space.
struct ModelShape {
	godot::Ref<godot::Shape3D> shape;
	godot::Transform3D transform;
};

/// The content of a scene, as read by a SceneReader.
struct SceneReading {
	/// The reason why there is no model, as the end of a sentence that begins with the scene. Empty
	/// if there is one.
	godot::String problem;
	std::vector<godot::Ref<ScatterLod>> lods; ///< At least one. Each has a mesh.
	std::vector<ModelShape> shapes;
	/// One message for each part of the scene that is drawn differently or omitted.
	godot::PackedStringArray remarks;
};

inline constexpr std::size_t max_model_parts = 256;

/// The `problem` of a scene for which PackedScene.can_instantiate returns false.
inline constexpr const char *empty_scene = "it is empty, or cannot be instantiated";

/// Reads all visible MeshInstance3Ds and all CollisionShape3Ds of a scene as a model. Positions are
/// relative to the root, whose transform is ignored.
///
/// If a path is given, reads only that node and its descendants, and moves them horizontally to the
/// origin. Their rotation, scale and height stay. If an artist moved the vertices instead of the
/// node, their bounding box may not contain the origin. The reader then moves the center of the box
/// to the origin.
///
/// Works in steps that a caller may spread over frames. Use it only on the main thread, because
/// reading a mesh waits for the renderer.
class SceneReader {
public:
	/// Creates a reader. `p_part` is the path of the node to read; empty for the whole scene.
	/// `p_materials` has materials that replace those of the scene, keyed by the names of the
	/// replaced materials (see material_name).
	explicit SceneReader(const godot::Ref<godot::PackedScene> &p_scene, const godot::String &p_part = {},
			const godot::Dictionary &p_materials = {});
	~SceneReader();
	SceneReader(const SceneReader &) = delete;
	SceneReader &operator=(const SceneReader &) = delete;

	/// Reads the next part. The first step reads the nodes, and each following step reads the
	/// meshes of one LOD. The first step instantiates the scene and frees it without adding it to
	/// the tree, so scripts in the scene run only during instantiation. Returns false if everything
	/// has been read.
	bool step();

	/// Returns what was read. Call it only after `step` has returned false.
	SceneReading take();

private:
	struct Progress;
	std::unique_ptr<Progress> progress_;
};

} // namespace thicket
