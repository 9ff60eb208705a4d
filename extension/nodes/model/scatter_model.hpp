#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/model/part_appearance.hpp"
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
	double distance = 0.0;          ///< The distance in meters at which the LOD begins, ascending; 0 for the first LOD.
	godot::Ref<godot::Mesh> mesh;   ///< The mesh; never null.
	godot::Ref<godot::Mesh> shadow; ///< The mesh that casts the shadow. Null if `mesh` casts it.
	std::int64_t cast_shadow = -1;  ///< A value of ScatterLod::CastShadow.
	LodAppearance lod_appearance;

	friend bool operator==(const DrawnLod &, const DrawnLod &) = default;
};

/// A model to draw at each instance. It consists of LODs, each with one mesh and its materials, and
/// of collision shapes. Both are read from a scene or set by hand. The model emits `changed` when
/// its content changes.
///
/// Any thread may set properties, as the engine's loader does, because setters only store the
/// scene. The main thread reads the scene when the model is first needed. A node reads it in steps
/// (`read_step`), and a getter reads all of it immediately. On other threads, getters return what
/// has been read so far.
class ScatterModel : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterModel, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Sets the scene to read LODs and shapes from. Setting an empty scene prints an error and
	/// leaves the model unchanged.
	///
	/// The main thread reads the scene when the model is first needed. If that fails, it prints an
	/// error, keeps the model's content, and resets the property to the scene of that content. A
	/// model without content keeps the new scene so that saving does not lose it. Setting null
	/// keeps the current content, which can then be edited.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const { return scene_; }

	/// Sets the path of the node in `scene` to read, relative to the root. Use it for scenes that
	/// contain several models. An empty path reads the whole scene.
	void set_scene_part(const godot::String &p_path);
	godot::String get_scene_part() const { return scene_part_; }

	/// Sets materials that replace those of the scene, keyed by the names of the replaced materials
	/// (see material_name). The dictionary is copied, and the copy is read-only. A wrong key or
	/// value prints an error and leaves the materials unchanged.
	void set_replacement_materials(const godot::Dictionary &p_materials);
	godot::Dictionary get_replacement_materials() const { return replacement_materials_; }

	/// Returns the key for a material of the scene in `replacement_materials`.
	godot::String get_material_name(const godot::Ref<godot::Material> &p_material) const {
		return material_name(p_material);
	}

	/// Reads the next part of a scene that has not been read completely. Returns false if there was
	/// nothing to read. Call it only on the main thread. Runs scripts in the scene, which may
	/// change anything, including this model.
	bool read_step();

	/// Sets the LODs, finest first, at most max_model_lods. Null entries are skipped. While the
	/// model has a scene, prints an error and leaves the LODs unchanged.
	void set_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_lods();

	/// Sets LODs in addition to `lods`, at most max_model_lods. They are sorted among `lods` by
	/// distance. Null entries and entries without a mesh are skipped. The scene does not replace
	/// them, so they can add an impostor to a model that has a scene.
	void set_far_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_far_lods() const { return far_lods_; }

	/// Sets the collision shapes (boxes, spheres, capsules, cylinders and convex polygons) and
	/// their transforms in the model's space. A shape without a transform is at the origin. While
	/// the model has a scene, prints an error and leaves the shapes unchanged.
	void set_shapes(const godot::TypedArray<godot::Shape3D> &p_shapes);
	godot::TypedArray<godot::Shape3D> get_shapes();
	void set_shape_transforms(const godot::TypedArray<godot::Transform3D> &p_transforms);
	godot::TypedArray<godot::Transform3D> get_shape_transforms();

	/// Rereads the scene, from its file if it has one. On failure, prints an error, leaves the
	/// model unchanged and returns false.
	bool reload();

	/// Returns the mesh that an LOD is drawn with; null for an invalid index.
	godot::Ref<godot::Mesh> get_mesh(int64_t p_lod);

	/// Returns the bounding box of all LODs.
	godot::AABB get_aabb();

	/// Returns one message for each part of the scene that is drawn differently or omitted.
	godot::PackedStringArray get_problems();

	/// Adds the LODs, which the main thread reads along with the model, to `r_used`.
	void add_used(SceneUse::List &r_used) const;

	/// These methods return the content that has already been read. `drawn_lods` returns the LODs
	/// with their distances, or none if no LOD has a mesh. `problem` returns the reason why the
	/// last scene could not be read, as the end of a sentence that begins with the scene. It
	/// returns an empty string if the scene was read.
	std::vector<DrawnLod> drawn_lods() const;
	std::vector<ModelShape> model_shapes() const;
	const godot::PackedStringArray &remarks() const { return remarks_; }
	const godot::String &problem() const { return problem_; }

	static constexpr int64_t max_model_lods = 16; ///< The maximum number of LODs: max_lods plus the nearest one.
	static constexpr const char *class_name = "ScatterModel";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// For each property, true if it was set by hand after `unread_scene_` was set. Reading that scene
	/// does not replace such properties.
	struct SetByHand {
		bool lods = false;
		bool shapes = false;
		bool shape_transforms = false;
	};

	void schedule_reread();
	void read();
	bool take_content(const SceneReading &reading, const godot::Ref<godot::PackedScene> &p_scene);
	void finish_reading(const SceneReading &reading);
	bool accept_edit(const char *p_property) const;
	void replace_lods(godot::TypedArray<ScatterLod> &r_lods, const godot::TypedArray<ScatterLod> &p_lods);
	void watch_lods(bool p_watch);

	godot::Ref<godot::PackedScene> scene_;
	/// The scene that the LODs were read from; null if they were set by hand.
	godot::Ref<godot::PackedScene> source_scene_;
	/// The scene to read when the model is first needed; null if there is none.
	godot::Ref<godot::PackedScene> unread_scene_;
	godot::String scene_part_;
	godot::String source_part_;               ///< `scene_part_` when `source_scene_` was read.
	godot::Dictionary replacement_materials_; ///< Read-only.
	std::shared_ptr<SceneReader> reader_;     ///< Reads `unread_scene_`; null until its first step.
	/// True during a step, because scripts in the scene may call this model.
	bool is_stepping_ = false;
	SetByHand set_by_hand_;
	godot::String problem_;
	godot::TypedArray<ScatterLod> lods_;
	godot::TypedArray<ScatterLod> far_lods_;
	godot::TypedArray<godot::Shape3D> shapes_;
	godot::TypedArray<godot::Transform3D> shape_transforms_;
	godot::PackedStringArray remarks_;
};

/// Returns the name of a scene for an error message: its path, or a description.
godot::String name_of(const godot::Ref<godot::PackedScene> &p_scene);

} // namespace thicket
