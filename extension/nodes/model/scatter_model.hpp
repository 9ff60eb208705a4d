#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/model/part_look.hpp"
#include "nodes/model/scatter_lod.hpp"
#include "nodes/model/scene_reader.hpp"

#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// An LOD as it is drawn, with all defaults resolved.
struct DrawnLod {
	double distance = 0.0;          ///< Meters; 0 for the first, ascending.
	godot::Ref<godot::Mesh> mesh;   ///< Never null.
	godot::Ref<godot::Mesh> shadow; ///< Null if the mesh casts its own shadow.
	std::int64_t cast_shadow = -1;  ///< ScatterLod::CastShadow.
	LodLook look;

	friend bool operator==(const DrawnLod &, const DrawnLod &) = default;
};

/// A model as an artist made it, drawn at each instance: LODs, each of one mesh with all its materials, and collision
/// shapes. These are read from a scene or put together by hand. Emits `changed` whenever its appearance changes.
///
/// Any thread may set properties, as the engine's loader does: a setter stores the scene and reads nothing of it. The main thread reads the
/// scene when the model is first needed: a node reads it in steps (`read_step`), a getter reads all of it immediately. On other threads,
/// getters return the parts that are already read.
class ScatterModel : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterModel, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// The scene to read LODs and shapes from. They follow the scene's changes. Setting an empty scene prints an error
	/// and changes nothing.
	///
	/// The main thread reads the scene when the model is first needed. If reading fails, an error is printed, the model
	/// keeps its content, and the property returns to the scene that the content was read from. A model without content
	/// keeps the new scene, so that saving does not lose it. Null keeps the current content, which can be edited by
	/// hand from then on.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const { return scene_; }

	/// The path of the node in `scene` to read, relative to the root; empty reads the whole scene. For scenes with several
	/// models side by side.
	void set_scene_part(const godot::String &p_path);
	godot::String get_scene_part() const { return scene_part_; }

	/// The materials to draw with in place of those of the scene, by the names of these (see material_name). Copied and
	/// returned read-only. A wrong key or value is refused with an error.
	void set_replacement_materials(const godot::Dictionary &p_materials);
	godot::Dictionary get_replacement_materials() const { return replacement_materials_; }

	/// The key of a material of the scene in `replacement_materials`.
	godot::String get_material_name(const godot::Ref<godot::Material> &p_material) const {
		return material_name(p_material);
	}

	/// Reads the next part of a scene that was set but is not fully read. Returns false if there was nothing to read.
	/// Main thread only. Runs scripts in the scene, which may do anything, also with this model.
	bool read_step();

	/// The finest first; at most max_model_lods. Null entries are left out. Refused while the model has a scene.
	void set_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_lods();

	/// LODs in addition to `lods`, sorted among them by distance; at most max_model_lods. Null entries, and entries
	/// without a mesh, are left out. They are not read from the scene, so a model that follows a scene can end in an
	/// impostor.
	void set_far_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_far_lods() const { return far_lods_; }

	/// The collision shapes: boxes, spheres, capsules, cylinders and convex polygons, with their transforms in the
	/// model's space. A shape without a transform is at the origin. Refused while the model has a scene.
	void set_shapes(const godot::TypedArray<godot::Shape3D> &p_shapes);
	godot::TypedArray<godot::Shape3D> get_shapes();
	void set_shape_transforms(const godot::TypedArray<godot::Transform3D> &p_transforms);
	godot::TypedArray<godot::Transform3D> get_shape_transforms();

	/// Rereads the scene, from its file if it has one. On failure, returns false, with an error, and leaves the model
	/// unchanged.
	bool reload();

	/// The mesh of an LOD as it is drawn; null for an invalid index.
	godot::Ref<godot::Mesh> get_mesh(int64_t p_lod);

	/// The box around all LODs.
	godot::AABB get_aabb();

	/// One sentence for each part of the scene that is drawn differently or left out.
	godot::PackedStringArray get_problems();

	/// Adds the resources that the main thread reads along with the model.
	void add_used(SceneUse::List &r_used) const;

	/// The parts that are already read. `drawn_lods` returns the LODs with their distances; it is empty if no LOD has a
	/// mesh. `problem` returns the reason why the last scene could not be read, as the end of a sentence that begins
	/// with the scene. It is empty if the scene could be read.
	std::vector<DrawnLod> drawn_lods() const;
	std::vector<ModelShape> model_shapes() const;
	const godot::PackedStringArray &remarks() const { return remarks_; }
	const godot::String &problem() const { return problem_; }

	static constexpr int64_t max_model_lods = 16; ///< max_lods, and the nearest one.
	static constexpr const char *class_name = "ScatterModel";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// The properties that were set by hand after `unread_`. Reading that scene leaves them unchanged.
	struct HandSet {
		bool lods = false;
		bool shapes = false;
		bool shape_transforms = false;
	};

	void read_again();
	void read();
	bool take_over(const SceneReading &reading, const godot::Ref<godot::PackedScene> &p_scene);
	void finish_reading(const SceneReading &reading);
	bool accept_edit(const char *p_property) const;
	void replace_lods(godot::TypedArray<ScatterLod> &r_lods, const godot::TypedArray<ScatterLod> &p_lods);
	void watch_lods(bool p_watch);

	godot::Ref<godot::PackedScene> scene_;
	godot::Ref<godot::PackedScene> source_; ///< The scene that the LODs were read from; null for LODs made by hand.
	godot::Ref<godot::PackedScene> unread_; ///< The scene to read when the model is needed; null if there is none.
	godot::String scene_part_;
	godot::String source_part_;               ///< `scene_part_` when `source_` was read.
	godot::Dictionary replacement_materials_; ///< Read-only.
	std::shared_ptr<SceneReader> reader_;     ///< Reads `unread_`; null until its first step.
	bool stepping_ = false;                   ///< Set because a script in the scene may request this model.
	HandSet hand_set_;
	godot::String problem_;
	godot::TypedArray<ScatterLod> lods_;
	godot::TypedArray<ScatterLod> far_lods_;
	godot::TypedArray<godot::Shape3D> shapes_;
	godot::TypedArray<godot::Transform3D> shape_transforms_;
	godot::PackedStringArray remarks_;
};

/// A name for a scene in an error: its path, or a description.
godot::String name_of(const godot::Ref<godot::PackedScene> &p_scene);

} // namespace thicket
