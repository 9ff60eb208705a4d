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

/// A shape of a model, in the model's space.
struct ModelShape {
	godot::Ref<godot::Shape3D> shape;
	godot::Transform3D transform;
};

/// The content of a scene as a model.
struct SceneReading {
	godot::String
			problem; ///< Why there is no model, as the rest of a sentence that names the scene; empty if there is one.
	std::vector<godot::Ref<ScatterLod>> lods; ///< At least one; each has a mesh.
	std::vector<ModelShape> shapes;
	godot::PackedStringArray
			remarks; ///< One sentence for each part of the scene that is drawn differently or left out.
};

inline constexpr std::size_t max_model_parts = 256;

/// The problem of a scene for which PackedScene.can_instantiate is false.
inline constexpr const char *empty_scene = "it is empty, or cannot be instantiated";

/// Reads all visible MeshInstance3Ds and all CollisionShape3Ds of a scene, relative to its root, whose own transform is
/// ignored. With a path, reads only that node and the nodes below it, moved to the origin: their rotation, scale and
/// height stay. If the origin is not below their box then, because an artist moved the vertices and not the node, the
/// middle of the box is moved there. Works in steps, which a caller may spread over frames. Main thread only, because reading a mesh waits for
/// the renderer.
class SceneReader {
public:
	/// `p_materials` has the materials to draw with in place of the scene's, by the names of these; see material_name.
	explicit SceneReader(const godot::Ref<godot::PackedScene> &p_scene, const godot::String &p_part = {},
			const godot::Dictionary &p_materials = {});
	~SceneReader();
	SceneReader(const SceneReader &) = delete;
	SceneReader &operator=(const SceneReader &) = delete;

	/// Reads the next part: first the nodes, then the meshes of one LOD. The first step instantiates the scene, and
	/// frees it without adding it to the tree. So scripts in the scene run only during instantiation. Returns false if
	/// everything was already read.
	bool step();

	/// The result, once `step` has returned false.
	SceneReading take();

private:
	struct Progress;
	std::unique_ptr<Progress> progress_;
};

} // namespace thicket
